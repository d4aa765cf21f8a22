#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "resilin/contact/ball_facets.hpp"
#include "resilin/contact/barrier.hpp"
#include "resilin/contact/collider_motion.hpp"
#include "resilin/contact/collider_shape.hpp"
#include "resilin/contact/contact_node.hpp"
#include "resilin/contact/friction_contact.hpp"
#include "resilin/energy/energy.hpp"

namespace resilin {

/// Keeps points of the bodies' surfaces out of a collider: E = sum_i kappa A_i b(d(x_i)). `Friction` adds
/// friction. A ball also keeps out facets that are large beside it (ball_facets.hpp).
///
/// Only positions with d > 0 are in its domain, and `max_step` never lets a point lose more than nine
/// tenths of its distance: nothing passes through. Between the steps of a simulation the caller may move the
/// collider or give it another shape; `largest_motion` says how far it may go. Theory: docs/contact.md.
class ColliderBarrier final : public BasicEnergy, public FrictionSource {
 public:
  ColliderBarrier(std::string name, int dim, std::shared_ptr<const ColliderShape> shape, ContactPoints points,
                  double activation_distance, ColliderMotion motion = {}, double friction = 0);

  /// Facets that it meets besides the points: for a ball, with its activation distance.
  void meet_facets(std::shared_ptr<const BallFacets> facets) { facets_ = std::move(facets); }
  /// None: it meets points alone.
  const BallFacets* facets() const { return facets_.get(); }

  std::string_view name() const override { return name_; }
  EnergyProperties properties() const override { return {.category = EnergyCategory::contact}; }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override;
  double max_step(const VectorX& x, const VectorX& p, const Conditions& c) const override;

  /// "barrier_stiffness": kappa A of each point [N], in 2D [N/m], then kappa of each surface of its facets
  /// [Pa]; and those of its motion.
  std::vector<EnergyParameter> parameters() const override;
  void add_parameter_slopes(std::string_view name, const VectorX& x, const VectorX& w, const Conditions& c,
                            VectorX& slopes) const override;
  void add_parameter_forces(std::string_view name, const VectorX& x, const VectorX& change,
                            const Conditions& c, VectorX& gradient) const override;

  /// Resultant force of the collider on the bodies.
  std::optional<Reaction> reaction(const VectorX& x, const Conditions& c) const override;

  const FrictionSource* friction_source() const override { return this; }
  std::string_view name_in_reports() const override { return name_; }
  /// Each point and feature within the activation distance.
  void add_friction_contacts(const VectorX& x, const VectorX& start, const Conditions& c,
                             FrictionContacts& contacts) const override;
  void add_friction_slopes(const VectorX& x, const VectorX& start, const Conditions& c,
                           std::vector<FrictionContactSlopes>& slopes) const override;
  Eigen::Index num_stiffnesses() const override {
    return points_.size() + (facets_ ? static_cast<Eigen::Index>(facets_->surface().stiffness.size()) : 0);
  }
  const ColliderMotion* motion_of_its_own() const override { return &motion_; }
  double friction() const { return friction_; }

  /// Constraints normal to its surface at the points within the activation distance.
  void add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const override;

  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  ///< [m]; negative inside the collider
    Index point = -1;
  };
  Nearest nearest(const VectorX& x, const Conditions& c) const;
  /// The smallest distance from points and facets [m].
  double gap(const VectorX& x, const Conditions& c) const;
  double relative_gap(const VectorX& x, const Conditions& c) const override {
    return is_active_ ? gap(x, c) / activation_distance() : std::numeric_limits<double>::infinity();
  }
  /// Distance of a point from the collider [m].
  double distance(const Vector3& point, const Conditions& c) const {
    return shape_->distance(rigid_place(c).inverse(point));
  }

  /// How much of `motion` [m], from 0 to 1, the collider may be moved by at once: until some point that it
  /// comes nearer to is left with `share` of the activation distance, or with half its distance where that is
  /// less. Even where the bodies are pressed hard this is never zero, and the bodies stay in the domain.
  double largest_motion(const VectorX& x, const Vector3& motion, const Conditions& c,
                        double share = share_left) const;

  /// The least delay, from 0 to `c.delay`, with which the collider's own motion has gone on from
  /// there no further than `largest_motion` allows [s].
  double least_delay(const VectorX& x, const Conditions& c) const override;

  /// Force times way, with the forces at the one end or the other, or the change where bodies stand at last.
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override;

  /// Ball at some time, for one that is a ball.
  Ball ball(const Conditions& c) const { return {place(c), shape_->radius()}; }
  /// Reference point of the shape [m].
  Vector3 place(const Conditions& c) const { return rigid_place(c)(shape_->reference_point()); }
  void move_to(const Vector3& point) { offset_ = point - shape_->reference_point(); }
  void move_by(const Vector3& motion) { offset_ += motion; }
  /// Takes the place of the old shape, where its own reference point is.
  void set_shape(std::shared_ptr<const ColliderShape> shape);
  const ColliderShape& shape() const { return *shape_; }
  /// A collider that is switched off is not there.
  void set_active(bool is_active) { is_active_ = is_active; }
  bool is_active() const { return is_active_; }

  double activation_distance() const { return barrier_.activation_distance; }
  const ContactPoints& points() const { return points_; }
  const ColliderMotion& motion() const { return motion_; }

 private:
  static constexpr double share_left = 0.1;  ///< share left of the activation distance

  double stiffness(Index point) const { return points_.stiffness[static_cast<std::size_t>(point)]; }
  /// Place of a point, at positions or of displacements of nodes.
  Vector3 at(Index point, const VectorX& x) const { return points_.places.at(dim_, point, x); }

  /// Motion of the shape from where it was made.
  RigidPlace rigid_place(const Conditions& c) const;
  /// Whether the bodies let it go from where it is at one time to where it is at another.
  bool may_go(const VectorX& x, double from, double to) const;
  /// Remaining share of the distance after an approach.
  double distance_left(double distance, double share) const;
  /// Calls `visit(point, y, d)` for points nearer than the activation distance; y is relative to the shape.
  template <class Visit>
  void for_each_near(const VectorX& x, const Conditions& c, const Visit& visit) const;
  /// Calls `visit(contact, set)` where facets are within the activation distance.
  template <class Visit>
  void for_near_facets(const VectorX& x, const Conditions& c, const Visit& visit) const;
  /// Facets leave the ball's own motion as much as points do.
  double free_share_of_facets(const VectorX& x, const Vector3& motion, const Conditions& c,
                              double share) const;
  void add_facet_friction(const VectorX& x, const Conditions& c, FrictionContacts& contacts) const;
  void add_facet_friction_slopes(const VectorX& x, const Conditions& c,
                                 std::vector<FrictionContactSlopes>& slopes) const;
  /// d2/dx2 of a point's energy that is as far away, y being relative to the shape.
  Eigen::Matrix3d curvature_at(Index point, const Vector3& y, double d, const RigidPlace& place,
                               Projection projection) const;

  std::string name_;
  int dim_;
  std::shared_ptr<const ColliderShape> shape_;
  ContactPoints points_;
  ClampedLogBarrier barrier_;
  ColliderMotion motion_;
  double friction_;  ///< its coefficient
  std::shared_ptr<const BallFacets> facets_;
  Vector3 offset_ = Vector3::Zero();
  bool is_active_ = true;
};

}  // namespace resilin
