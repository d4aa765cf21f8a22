#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/scene/mesh_cache.hpp"
#include "resilin/scene/scene.hpp"
#include "resilin/sweep/parameter.hpp"
#include "resilin/sweep/quantity.hpp"
#include "resilin/sweep/scene_hash.hpp"
#include "resilin/world/fingerprint.hpp"

namespace resilin {

/// Combination of the parameter values.
enum class SweepMethod { grid, list, latin_hypercube, sobol };
constexpr std::array<std::string_view, 4> spellings(SweepMethod) {
  return {"grid", "list", "latin_hypercube", "sobol"};
}

/// Scenes of which the folder of results is kept, beside their row in the table.
struct KeptScenes {
  enum class Kind { none, all, failed, listed };
  Kind kind = Kind::none;
  std::vector<std::int64_t> numbers;  ///< listed; rising

  bool has(std::uint64_t scene, bool is_done) const;
  bool may_have(std::uint64_t scene) const { return has(scene, true) || has(scene, false); }
};

/// Definition of a sweep.
struct SweepDescription {
  std::string place = "sweep";
  SceneValue base;
  std::string base_name;         ///< for messages
  std::filesystem::path folder;  ///< base of the relative paths in the scene
  std::vector<SweepParameter> parameters;
  SweepMethod method = SweepMethod::grid;
  std::int64_t samples = 0;  ///< samples of latin_hypercube and sobol
  std::int64_t seed = 0;     ///< seed of the same
  std::vector<Quantity> quantities;
  KeptScenes keep;
};

/// Many scenes: a base and what varies. Scenes are made one by one when they are asked for, so that a million
/// of them take no more memory than one. Several threads may ask at once.
class Sweep {
 public:
  /// Throws InputError when parameters do not go together, or when a key of theirs is none of the scene.
  explicit Sweep(SweepDescription description);

  std::uint64_t size() const { return size_; }
  const std::string& place() const { return description_.place; }
  const std::vector<SweepParameter>& parameters() const { return description_.parameters; }
  const std::vector<Quantity>& quantities() const { return description_.quantities; }
  const KeptScenes& kept() const { return description_.keep; }

  /// The value of each parameter in scene `i`.
  std::vector<SceneValue> values(std::uint64_t i) const;
  std::vector<std::string> shown_values(std::uint64_t i) const;

  /// Input that determines the results: values of the scene, content of its files, quantities, version of the
  /// program.
  /// @throws InputError  when a value cannot even be put into the scene
  SceneHash hash(std::uint64_t i) const;

  /// @throws InputError  for a scene that is wrong, which is no fault of the others
  Scene scene(std::uint64_t i) const;

  /// Data shared by the simulations of its scenes.
  const std::shared_ptr<AnalysisCache>& analyses() const { return analyses_; }

  /// "scene 12 (body.beam.scale = 2)", for messages.
  std::string name_of(std::uint64_t i) const;

  /// Identity of a sweep: version, base scene, parameters, quantities.
  Fingerprint identity() const;

 private:
  SceneValue scene_values(std::uint64_t i) const;
  std::uint64_t counted() const;
  void check_columns() const;
  void check_targets() const;
  std::optional<Description> readable_scene() const;
  bool is_known(std::size_t parameter, std::string& message) const;

  SweepDescription description_;
  std::uint64_t size_ = 0;
  std::unique_ptr<FileHashes> files_;
  std::unique_ptr<MeshCache> meshes_;
  std::shared_ptr<AnalysisCache> analyses_;
};

/// Reads a file SWEEP.toml and its base scene. @throws InputError
Sweep read_sweep(const std::filesystem::path& path);

/// The same from values that came from elsewhere; `base` may be the scene itself.
Sweep read_sweep_from_values(SceneValue values, const std::string& name, const std::filesystem::path& folder);

}  // namespace resilin
