#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "resilin/live/live_scene.hpp"
#include "resilin/scene/scene.hpp"
#include "resilin/view/face_patch.hpp"
#include "resilin/view/shown_surface.hpp"
#include "resilin/view/surface_fields.hpp"
#include "resilin/world/shown_colliders.hpp"
#include "served_scene.hpp"

namespace resilin::viewer {

/// Changes that a user has made to a scene on its page.
struct SceneChanges {
  const Description* before = nullptr;                   ///< as it was read
  Vector3 up = Vector3::UnitZ();                         ///< normal of the ground
  LiveControls first, now;                               ///< controls at the start, and now
  std::vector<BodyControls> first_materials, materials;  ///< likewise, of each body
  ContactDescription contact{};                          ///< settings of contact that were chosen
  std::vector<HeldFace> held;
  std::vector<FaceLoad> loads;
  std::vector<Drive> drives;  ///< motors and cables
};

/// Writes a scene with its changes into a new file; one line that says where. Throws InputError.
using SaveChanges = std::function<std::string(const SceneChanges&)>;

/// A scene that is played with: of a file, or of a program that plays with it as well.
class ServedLiveScene : public ServedScene {
 public:
  /// @param read  reads the scene, now and at each reload
  /// @param save   null: the scene cannot be saved
  /// @param start  of a run of this scene, which goes on from there; none: the scene's own
  /// @throws InputError
  explicit ServedLiveScene(std::function<Scene()> read, SaveChanges save = {},
                           std::optional<State> start = {});
  /// @param live  somebody else's, too, though not at the same time; a reload is a reset with the controls
  /// that
  ///              it has now
  ServedLiveScene(std::shared_ptr<LiveScene> live, std::vector<std::string> warnings);

  const World& world() const { return loaded_->live->world(); }
  const std::vector<std::string>& warnings() const { return loaded_->warnings; }
  Index num_vertices() const { return loaded_->surface.num_vertices(); }

  nlohmann::json header() const override;
  std::string topology() const override;
  std::vector<std::string> field_names() const override;
  nlohmann::json state() const override;
  nlohmann::json status() const override;
  void apply(const SceneMessage& message) override;
  std::string save() override;
  bool is_grabbed() const override { return loaded_->live->is_grabbed(); }
  bool is_poking() const override { return loaded_->live->ball().has_value(); }
  double time() const override { return loaded_->live->state().time; }
  double time_step() const override { return loaded_->live->controls().time_step; }
  double speed() const override { return loaded_->live->controls().speed; }
  bool is_at_rest() const override { return loaded_->live->report().at_rest; }
  void step(double seconds) override;
  std::string frame(std::uint32_t number, std::uint32_t answered_drag, const FieldChoice& shown,
                    double blend) override;

 private:
  /// A face of the surface that is held, as the page sees it.
  struct ShownFace {
    int number = 0;  ///< number of the HeldFace
    FacePatch patch;
  };
  /// Likewise one with a load.
  struct LoadedFace {
    int number = 0;  ///< number of the FaceLoad
    FacePatch patch;
    std::vector<Index> vertices{};      ///< where arrows are drawn ...
    std::vector<Vector3> directions{};  ///< ... and along which, the longest of length 1
  };
  /// All that a reload replaces.
  struct Loaded {
    Loaded(Scene scene, const std::optional<State>& start);
    Loaded(std::shared_ptr<LiveScene> played, std::vector<std::string> words);

    std::shared_ptr<LiveScene> live;
    Description description{};  ///< as it was read
    std::vector<std::string> warnings;
    LiveControls first_controls;
    std::vector<BodyControls> first_materials;
    std::vector<ShownFace> faces;
    std::vector<LoadedFace> loads;
    ShownSurface surface;
    std::vector<ShownCollider> colliders;
    SurfaceFields fields;
    FieldEvaluator evaluator;                ///< keeps the projection of smooth fields between frames
    std::vector<ScalarField> field_choices;  ///< fields that pages choose from, in the order of the header
    Vector3 grab_offset = Vector3::Zero();   ///< from the pointer to the place that is held [m]
    std::map<Index, std::uint32_t> vertex_of_node;  ///< vertex of the page for each pinned node
    VectorX previous_positions;                     ///< one step before [m]
    double previous_time = 0;                       ///< [s]
    Conditions previous_conditions{};
    std::uint32_t shown_frame = 0;  ///< frame whose places and normals the buffers hold
    std::vector<float> positions, normals, field, arrows;
  };

  std::optional<std::uint32_t> shown_vertex(Index node) const;
  /// Writes the vectors of a field into `Loaded::arrows`, three numbers for each vertex.
  void evaluate_arrows(const ScalarField& length);
  void forget_previous_state();
  void grab(const Grab& grab);
  void hold(const HoldFace& hold);
  void free_faces();
  void load(const LoadFace& load);
  void remove_loads();
  void set(const SetControl& set);
  void drive(const SetControl& set);
  FacePatch patch_at(const HoldFace& hold, const char* what);
  /// Vertices of the body's mesh that carry a patch.
  std::vector<Index> mesh_vertices(const FacePatch& patch) const;
  std::size_t body_of(const FacePatch& patch) const { return loaded_->surface.parts()[patch.part].body; }
  void reload();
  Index checked_vertex(std::uint32_t vertex, const char* what) const;
  Vector3 checked_place(const Vector3& place, const char* what) const;

  std::function<Scene()> read_;  ///< null: the scene is somebody else's
  std::optional<State> start_;
  SaveChanges save_;
  std::unique_ptr<Loaded> loaded_;
};

}  // namespace resilin::viewer
