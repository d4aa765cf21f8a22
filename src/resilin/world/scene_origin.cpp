#include "resilin/world/scene_origin.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/body_mesh.hpp"

namespace resilin {
namespace {

/// In parts of the extent: at most two of the sixteen digits of a position say where the scene is.
constexpr double far_away = 100;

Eigen::AlignedBox3d bounds_of(const Description& description) {
  Eigen::AlignedBox3d bounds;
  for (const BodyDescription& body : description.bodies) {
    const Placement placement(body);
    for (const Vector3& X : body.mesh.vertices) bounds.extend(placement(X));
  }
  return bounds;
}

/// Zero for an axis that is none, which is refused later.
double along(int axis, const Vector3& by) { return axis >= 0 && axis < 3 ? by[axis] : 0; }

void move(Where& where, const Vector3& by) {
  switch (where.kind) {
    case Where::Kind::box:
      where.min += by;
      where.max += by;
      break;
    case Where::Kind::plane:
      where.at += along(where.axis, by);
      break;
    case Where::Kind::sphere:
      where.center += by;
      break;
    case Where::Kind::face:
      where.face_at += by;
      break;
    case Where::Kind::all:
    case Where::Kind::group:
    case Where::Kind::vertices:
      break;
  }
}

/// A body's fields over its places X stay what they are: G (X - o) + (v + G o).
void move(BodyDescription& body, int dim, const Vector3& by) {
  body.translate += by;
  body.velocity -= body.velocity_gradient * by;
  for (RegionDescription& region : body.regions) move(region.where, by);
  for (std::vector<double>* places : {&body.initial_positions, &body.contact_shape})
    for (std::size_t i = 0; i < places->size(); ++i) (*places)[i] += by[static_cast<int>(i) % dim];
}

void move(FixDescription& fix, const Vector3& by) {
  move(fix.where, by);
  fix.displacement -= fix.gradient * by;
  if (fix.rotate) fix.rotate->center += by;
}

}  // namespace

Vector3 find_scene_origin(const Description& description) {
  Vector3 middle = Vector3::Zero(), first = Vector3::Zero();
  if (description.dimension != 2 && description.dimension != 3) return middle;  // refused later
  if (is_axisymmetric(description)) return middle;                              // the axis stays
  const Eigen::AlignedBox3d bounds = bounds_of(description);
  if (bounds.isEmpty() || !bounds.sizes().allFinite()) return middle;
  double extent = 0;
  for (int k = 0; k < description.dimension; ++k) {
    middle[k] = bounds.center()[k];
    first[k] = description.bodies.front().translate[k];
    extent = std::max(extent, bounds.sizes()[k]);
  }
  const double reach = far_away * extent;
  if (middle.norm() <= reach) return Vector3::Zero();
  return (middle - first).norm() <= reach ? first : middle;
}

Description with_origin(const Description& description, const Vector3& origin) {
  const Vector3 by = -origin;
  Description moved = description;
  for (BodyDescription& body : moved.bodies) move(body, description.dimension, by);
  for (FixDescription& fix : moved.fixes) move(fix, by);
  for (TieDescription& tie : moved.ties)
    for (TiedSurface& surface : tie.surfaces) move(surface.where, by);
  for (ConstraintDescription& constraint : moved.constraints) {
    move(constraint.where, by);
    for (ConstraintTerm& term : constraint.terms) move(term.where, by);
  }
  for (JointDescription& joint : moved.joints) {
    joint.at += by;
    if (joint.to) *joint.to += by;
  }
  for (std::vector<CableDescription>* list : {&moved.springs, &moved.cables})
    for (CableDescription& cable : *list)
      for (AnchorDescription& point : cable.points) point.at += by;
  for (LoadDescription& load : moved.loads) {
    move(load.where, by);
    if (load.point) *load.point += by;
  }
  for (ColliderDescription& collider : moved.colliders) {
    ShapeDescription& shape = collider.shape;
    for (Vector3* place : {&shape.point, &shape.center, &shape.start, &shape.end, &shape.translate})
      *place += by;
    if (collider.rotate) collider.rotate->center += by;
  }
  for (ProbeDescription& probe : moved.probes) probe.at += by;
  for (SectionDescription& section : moved.sections) section.at += along(section.axis, by);
  return moved;
}

}  // namespace resilin
