#pragma once

#include <memory>
#include <optional>

#include "resilin/contact/collider_barrier.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Contact of bodies with an obstacle that is added while the scene runs.
struct ObstacleOptions {
  double friction = 0;
  std::optional<double> activation_distance{};  ///< [m]; default: see default_activation_distance
  std::optional<double> stiffness{};  ///< stiffness of its barrier [Pa]; default: see contact_points
  double least_gap = 0.1;             ///< to the bodies where it starts, in activation distances
};

/// A floor or a ball that goes to its goal as fast as the bodies let it, so that no step begins with a body
/// inside.
class Obstacle {
 public:
  /// @param shape  where it starts; moved along `way_out` until it has its gap to all nodes
  Obstacle(const std::string& name, const World& world, const VectorX& positions,
           const std::shared_ptr<const ColliderShape>& shape, const Vector3& way_out,
           const ObstacleOptions& options = {});

  /// Where its reference point shall be [m].
  void set_goal(const Vector3& goal) { goal_ = goal; }
  /// Goes nearer to the goal. @return whether it moved to speak of
  bool advance(const VectorX& positions);
  const std::shared_ptr<ColliderBarrier>& barrier() const { return barrier_; }

 private:
  std::shared_ptr<ColliderBarrier> barrier_;
  Vector3 goal_;
};

}  // namespace resilin
