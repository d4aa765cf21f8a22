#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "resilin/contact/barrier.hpp"
#include "resilin/contact/collider_shape.hpp"
#include "resilin/contact/contact_node.hpp"
#include "resilin/energy/energy.hpp"

namespace resilin {

/// How a collider moves as time passes: at a velocity until a time, then it stays.
struct ColliderMotion {
  Vector3 velocity = Vector3::Zero();                      ///< [m/s]
  double until = std::numeric_limits<double>::infinity();  ///< [s]
};

/// Keeps nodes of the bodies' surfaces out of a collider, without friction: E = sum_i kappa A_i b(d(x_i)).
///
/// Only positions with d > 0 are in its domain, and `max_step` never lets a node lose more than nine tenths
/// of its distance: nothing passes through. Between the steps of a simulation the caller may move the
/// collider or give it another shape; `largest_motion` says how far it may go. Theory: docs/contact.md.
class ColliderBarrier final : public Energy {
 public:
  ColliderBarrier(std::string name, int dim, std::shared_ptr<const ColliderShape> shape,
                  std::vector<ContactNode> nodes, double activation_distance, ColliderMotion motion = {});

  std::string_view name() const override { return name_; }
  EnergyProperties properties() const override { return {.category = EnergyCategory::contact}; }
  double value(const VectorX& x, const Conditions& c) const override;
  double difference(const VectorX& from, const VectorX& to, const Conditions& c) const override;
  void add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const override;
  void add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const override;
  void add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                   BlockMatrix& hessian) const override;
  double max_step(const VectorX& x, const VectorX& p, const Conditions& c) const override;

  /// What the collider does to the bodies.
  std::optional<Reaction> reaction(const VectorX& x, const Conditions& c) const override;

  /// Across its surface, the nodes that are near enough to feel it.
  void add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const override;

  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  ///< [m]; negative inside the collider
    Index node = -1;
  };
  Nearest nearest(const VectorX& x, const Conditions& c) const;

  /// How much of `motion` [m], from 0 to 1, the collider may be moved by at once: until some node that it
  /// comes nearer to is left with `share` of the activation distance, or with half its distance where that is
  /// less. Even where the bodies are pressed hard this is never zero, and the bodies stay in the domain.
  double largest_motion(const VectorX& x, const Vector3& motion, const Conditions& c,
                        double share = 0.1) const;

  /// The least delay, from 0 to `c.collider_delay`, with which the collider's own motion has gone on from
  /// there no further than `largest_motion` allows [s].
  double least_delay(const VectorX& x, const Conditions& c) const override;

  /// Force times way, with the forces at the one end or the other, or the change where bodies stand at last.
  std::optional<double> driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                    const Conditions& after) const override;

  /// Where the shape's reference point is [m].
  Vector3 place(const Conditions& c) const { return shape_->reference_point() + displacement(c); }
  void move_to(const Vector3& point) { offset_ = point - shape_->reference_point(); }
  void move_by(const Vector3& motion) { offset_ += motion; }
  /// Takes the place of the old shape, where its own reference point is.
  void set_shape(std::shared_ptr<const ColliderShape> shape);
  const ColliderShape& shape() const { return *shape_; }
  /// A collider that is switched off is not there.
  void set_active(bool is_active) { is_active_ = is_active; }
  bool is_active() const { return is_active_; }

  double activation_distance() const { return barrier_.activation_distance; }
  const std::vector<ContactNode>& nodes() const { return nodes_; }
  const ColliderMotion& motion() const { return motion_; }

 private:
  double time_moved(const Conditions& c) const { return std::min(c.time - c.collider_delay, motion_.until); }
  /// From where the shape was made.
  Vector3 displacement(const Conditions& c) const { return offset_ + time_moved(c) * motion_.velocity; }
  /// Calls `visit(node, y, d)` for nodes nearer than the activation distance; y is relative to the shape.
  template <class Visit>
  void for_each_near(const VectorX& x, const Conditions& c, const Visit& visit) const;

  std::string name_;
  int dim_;
  std::shared_ptr<const ColliderShape> shape_;
  std::vector<ContactNode> nodes_;
  ClampedLogBarrier barrier_;
  ColliderMotion motion_;
  Vector3 offset_ = Vector3::Zero();
  bool is_active_ = true;
};

}  // namespace resilin
