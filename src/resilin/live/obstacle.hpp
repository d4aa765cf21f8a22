#pragma once

#include <memory>

#include "resilin/contact/collider_barrier.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// A floor or a ball that goes to its goal as fast as the bodies let it, so that no step begins with a body
/// inside.
class Obstacle {
 public:
  /// @param shape  where it starts; moved along `way_out` until all nodes are outside
  Obstacle(const std::string& name, const World& world, const VectorX& positions,
           const std::shared_ptr<const ColliderShape>& shape, const Vector3& way_out, double friction = 0);

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
