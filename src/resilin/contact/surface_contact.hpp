#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "resilin/contact/barrier.hpp"
#include "resilin/contact/contact_search.hpp"
#include "resilin/contact/contact_terms.hpp"
#include "resilin/contact/friction_contact.hpp"
#include "resilin/contact/sliding_normals.hpp"
#include "resilin/contact/term_sums.hpp"
#include "resilin/energy/energy.hpp"

namespace resilin {

/// Contact between bodies, self-contact and contact with an obstacle: the sum of stiffness m b(d) over active
/// pairs (contact_terms.hpp). `Friction` adds friction.
///
/// `max_step` follows every candidate on its way (collision_time.hpp), so that no step that it bounds leads
/// through a surface. Between two positions that are far apart `difference` alone does not see that.
///
/// The copy of a stage remembers its candidates and what it found out about the last two states. What it
/// remembers changes no bit of a result, but it serves one thread at a time.
class SurfaceContact : public BasicEnergy, public FrictionSource {
 public:
  SurfaceContact(std::string name, ContactSurface surface, BodyMeetings meetings, double activation_distance,
                 const VectorX& positions);

  std::string_view name() const override { return name_; }
  EnergyProperties properties() const override { return {.category = EnergyCategory::contact}; }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override;
  double max_step(const VectorX& x, const VectorX& p, const Conditions& c) const override;
  bool add_second_order_forces(const VectorX& x, const VectorX& p, const Conditions& c,
                               VectorX& forces) const override;

  /// "barrier_stiffness": kappa of each body's layer [Pa], that of an obstacle included, which counts
  /// nowhere.
  std::vector<EnergyParameter> parameters() const override {
    return {{"barrier_stiffness", static_cast<Eigen::Index>(surface_->stiffness.size())}};
  }
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override;
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override;

  std::unique_ptr<Energy> begin_stage(const Stage& stage) const override;
  void prepare(const VectorX& x, const VectorX& p, const Conditions& c) override;

  /// Contact of two bodies, or of one with itself.
  struct BodyContact {
    Index body, other;                                     ///< numbers of the bodies
    Vector3 force = Vector3::Zero();                       ///< on `other` [N]; the body feels the opposite
    double gap = std::numeric_limits<double>::infinity();  ///< the smallest [m]
    Index num_pairs = 0;                                   ///< active contact pairs
  };
  /// In the order of the bodies.
  std::vector<BodyContact> body_contacts(const VectorX& x, const Conditions& c) const;

  /// Constraints normal to the gap at the nodes of active pairs.
  void add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const override;

  /// One contact for each feature that pushes, its slip that of the closest points.
  void add_friction_contacts(const VectorX& x, const VectorX& start, const Conditions& c,
                             FrictionContacts& contacts) const override;
  const FrictionSource* friction_source() const override { return this; }
  bool is_copy_of(const FrictionSource& other) const override {
    const auto* contact = dynamic_cast<const SurfaceContact*>(&other);
    return contact != nullptr && contact->surface_ == surface_;
  }
  void add_friction_slopes(const VectorX& x, const VectorX& start, const Conditions& c,
                           std::vector<FrictionContactSlopes>& slopes) const override;
  /// Coefficients of each body with each, row by row: two bodies' follow the one of them that stands first.
  Eigen::Index num_coefficients() const override {
    return Eigen::Index{meetings().num_bodies()} * meetings().num_bodies();
  }
  Eigen::Index num_stiffnesses() const override {
    return static_cast<Eigen::Index>(surface_->stiffness.size());
  }
  /// @param coefficients  of each body with each, row by row; without them there is no friction
  void set_friction(std::vector<double> coefficients) {
    friction_ = std::move(coefficients);
    sliding_normals_ = std::make_shared<const SlidingNormals>(surface_->parts);
  }
  bool has_friction() const { return !friction_.empty(); }
  const std::vector<double>& friction() const { return friction_; }

  double activation_distance() const { return barrier_.activation_distance; }
  const ContactSurface& surface() const { return *surface_; }
  const BodyMeetings& meetings() const { return trees_->meetings(); }

  /// The forces of all terms [N], `Conditions::weight` left out.
  std::vector<PartForce> part_forces(const VectorX& x, const Conditions& c = {}) const;

  /// Wall time since the term was made, that of its stages among it [s].
  struct Timing {
    double search = 0;     ///< candidates
    double detection = 0;  ///< largest steps
    double barrier = 0;    ///< terms and their sums
  };
  const Timing& timing() const { return *timing_; }

  /// The two parts that meet and are nearest to each other.
  struct Gap {
    double distance = std::numeric_limits<double>::infinity();  ///< [m]
    PairKind kind = PairKind::point_point;
    std::array<Index, most_pair_vertices> vertices{-1, -1, -1, -1};  ///< vertices of the surface
  };
  /// The smallest gap below the activation distance, the first of several; infinite where none is.
  Gap smallest_gap(const VectorX& x, const Conditions& c = {}) const;
  double relative_gap(const VectorX& x, const Conditions& c) const override {
    return smallest_gap(x, c).distance / activation_distance();
  }
  /// Whether that is less than 1e-6 of the activation distance.
  bool touches(const VectorX& x, const Conditions& c = {}) const;

 protected:
  /// dE/dy [N] of the vertices, the obstacle's included.
  VectorX vertex_gradient(const VectorX& x, const Conditions& c) const;
  /// d2E/dy2 times displacements of the vertices [N].
  VectorX vertex_hessian_times(const VectorX& x, const Conditions& c, const VectorX& displacements) const;
  /// Collision-free share of a vertex motion, from 0 to 1; all pairs keep a share of their distance.
  double free_share(const VectorX& places, const VectorX& displacements, double share_left) const;
  /// For the copy of a stage.
  void begin_memory() { memory_ = Memory{.search = {trees_, barrier_.activation_distance}}; }

 private:
  /// Cached data of the vertices in one state.
  struct State {
    VectorX x, places;
    double time = 0, delay = 0;  ///< time and delay of the conditions
    NearCandidates near;         ///< near pairs among the present candidates
    ContactTerms all, merged;
    VectorX gradient;  ///< gradient of the vertices; empty: not asked for yet

    bool is_of(const VectorX& positions, const Conditions& c) const;
  };
  struct Memory {
    ContactSearch search;
    std::array<State, 2> states{};  ///< the newer one first
  };

  /// Calls `use(memory)` with that of the stage, or one for this call.
  template <class Use>
  auto with_memory(const Use& use) const;
  TermSet set_of(const State& state) const { return {*surface_, state.merged.terms}; }
  /// Each once, with its part in the distance.
  void set_nodes_of(const PartForce& force, std::vector<WeightedNode>& nodes) const;
  void cover(Memory& memory, const VectorX& from, const VectorX& to) const;
  void find_terms(Memory& memory, State& state) const;
  std::vector<ContactTerm> terms_at(const VectorX& x, const Conditions& c) const;  ///< merged
  State& state_at(Memory& memory, const VectorX& x, const Conditions& c) const;
  const VectorX& gradient_at(Memory& memory, const VectorX& x, const Conditions& c) const;
  double free_share(Memory& memory, const VectorX& places, const VectorX& displacements,
                    double share_left) const;
  double difference(Memory& memory, const VectorX& from, const VectorX& to, const Conditions& c) const;

  std::string name_;
  std::shared_ptr<const ContactSurface> surface_;
  ClampedLogBarrier barrier_;
  std::vector<double> friction_{};
  std::shared_ptr<const SlidingNormals> sliding_normals_{};  ///< where there is friction
  std::shared_ptr<const BroadPhase> trees_;
  std::shared_ptr<Timing> timing_ = std::make_shared<Timing>();
  mutable std::optional<Memory> memory_;  ///< memory of a stage
};

}  // namespace resilin
