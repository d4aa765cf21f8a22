#include "resilin/live/obstacle.hpp"

#include "resilin/world/colliders.hpp"
#include "resilin/world/meeting_surface.hpp"

namespace resilin {
namespace {

constexpr double least_motion = 1e-3;  ///< least motion worth a word, relative to the activation distance

}  // namespace

Obstacle::Obstacle(const std::string& name, const World& world, const VectorX& positions,
                   const std::shared_ptr<const ColliderShape>& shape, const Vector3& way_out,
                   const ObstacleOptions& options) {
  const double reach = options.activation_distance.value_or(default_activation_distance(world));
  barrier_ = std::make_shared<ColliderBarrier>(name, world.dimension, shape,
                                               contact_points(world, options.stiffness), reach,
                                               ColliderMotion{}, options.friction);
  if (shape->radius() > 0)  // the radius may change
    barrier_->meet_facets(ball_facets(world, 0, options.stiffness, reach));
  goal_ = shape->reference_point();
  // A node that is d inside comes out by moving at least -d along the way.
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const double distance = barrier_->gap(positions, {});
    if (distance > options.least_gap * reach) break;
    barrier_->move_by((reach - distance + 1e-3 * reach) * way_out);
  }
}

bool Obstacle::advance(const VectorX& positions) {
  const Vector3 motion = goal_ - barrier_->place({});
  if (motion.norm() <= 1e-9 * barrier_->activation_distance()) return false;
  const double share = barrier_->largest_motion(positions, motion, {});
  barrier_->move_by(share * motion);
  return (share * motion).norm() > least_motion * barrier_->activation_distance();
}

}  // namespace resilin
