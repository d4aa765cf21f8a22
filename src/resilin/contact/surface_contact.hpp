#pragma once

#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "resilin/collision/broad_phase.hpp"
#include "resilin/contact/barrier.hpp"
#include "resilin/contact/contact_terms.hpp"
#include "resilin/energy/energy.hpp"

namespace resilin {

/// Keeps the surfaces of bodies apart from each other, and from themselves, without friction: the sum over
/// the pairs that are near of stiffness m b(d) (contact_terms.hpp).
///
/// `max_step` follows every candidate on its way (collision_time.hpp), so that no step that it bounds leads
/// through a surface. Between two positions that are far apart `difference` alone does not see that.
class SurfaceContact final : public Energy {
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

  /// Keeps the candidates of an iteration.
  std::unique_ptr<Energy> begin_stage(const Stage& stage) const override;
  void prepare(const VectorX& x, const VectorX& p, const Conditions& c) override;

  /// What two bodies that touch do to each other, or one to itself.
  struct BodyContact {
    Index body, other;                                     ///< numbers of the bodies
    Vector3 force = Vector3::Zero();                       ///< on `other` [N]; the body feels the opposite
    double gap = std::numeric_limits<double>::infinity();  ///< the smallest [m]
    Index num_pairs = 0;                                   ///< of parts that feel each other
  };
  /// In the order of the bodies.
  std::vector<BodyContact> body_contacts(const VectorX& x, const Conditions& c) const;

  /// Across the gap, the nodes of parts that are near enough to feel each other.
  void add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const override;

  double activation_distance() const { return barrier_.activation_distance; }
  const ContactSurface& surface() const { return *surface_; }
  const BodyMeetings& meetings() const { return broad_phase_.meetings(); }

  /// The two parts that meet and are nearest to each other.
  struct Gap {
    double distance = std::numeric_limits<double>::infinity();  ///< [m]
    PairKind kind = PairKind::point_point;
    std::array<Index, most_pair_vertices> vertices{-1, -1, -1, -1};  ///< of the surface
  };
  /// Of those nearer than the activation distance, the first of several; infinite where none are.
  Gap smallest_gap(const VectorX& x) const;
  /// Whether that is less than 1e-6 of the activation distance.
  bool touches(const VectorX& x) const;

 private:
  /// Candidates, which are all while each vertex is in the box around its way, or a little outside.
  struct Found {
    SurfaceCandidates candidates;
    std::vector<MovingPoint> ways;
    bool covers(const VectorX& places, int dim, double slack) const;
  };

  Found find(BroadPhase& broad_phase, const VectorX& places, const VectorX& displacements) const;
  /// The terms of vertices in these places, of which there is one set or two.
  std::vector<ContactTerm> terms_at(std::initializer_list<const VectorX*> states) const;
  double slack() const;  ///< [m]
  template <class Change>
  void add_gradients(const VectorX& x, const Change& change, VectorX& sum) const;
  template <int dim>
  void add_hessian_of(const VectorX& places, double weight, Projection projection,
                      BlockMatrix& hessian) const;

  std::string name_;
  std::shared_ptr<const ContactSurface> surface_;
  ClampedLogBarrier barrier_;
  BroadPhase broad_phase_;
  std::optional<Found> found_;  ///< of a stage: by `begin_stage`, then by `prepare`
};

}  // namespace resilin
