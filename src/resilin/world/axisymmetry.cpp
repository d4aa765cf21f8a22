#include "resilin/world/axisymmetry.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/element/axisymmetric.hpp"

namespace resilin {
namespace {

/// Share of the largest radius below which a node is on the axis.
constexpr double axis_tolerance = 1e-12;

double largest_radius(const VectorX& positions) {
  double largest = 0;
  for (Eigen::Index i = 0; i < positions.size(); i += 2) largest = std::max(largest, std::abs(positions[i]));
  return largest;
}

[[noreturn]] void refuse(const std::string& place, const std::string& got, const std::string& cure) {
  throw InputError(place, "nothing that axisymmetric scenes do not have", got, cure);
}

}  // namespace

bool is_axisymmetric(const Description& description) {
  return description.dimension == 2 && std::ranges::any_of(description.bodies, [](const auto& body) {
           return has_axisymmetric_name(body.element);
         });
}

bool is_axisymmetric(const World& world) {
  return std::ranges::any_of(world.bodies,
                             [](const Body& body) { return has_axisymmetric_name(body.element); });
}

Depth depth_of(const World& world) {
  if (!is_axisymmetric(world)) return {.thickness = world.thickness};
  return {.is_turned = true, .axis = axis_tolerance * largest_radius(world.rest_positions)};
}

void check_axisymmetry(const Description& d) {
  if (!is_axisymmetric(d)) return;
  if (d.gravity.x() != 0)
    throw InputError(d.place + ": simulation.gravity", "gravity along the axis (y) in an axisymmetric scene",
                     "a radial component of " + format_number(d.gravity.x()) + " m/s^2",
                     "use gravity = [0, -9.81]");
  if (d.thickness != 1)
    refuse(d.place + ": simulation.thickness", format_number(d.thickness) + " m",
           "leave it out: forces are those of the full turn");
  for (const BodyDescription& body : d.bodies) {
    if (body.rigid) refuse(body.rigid->place, "a rigid body", "hold or move a boundary with [[fix]]");
    if (body.skin) refuse(body.skin->place, "a skin", "leave the skin out");
    if (body.damping.stiffness != 0 || body.damping.shear_viscosity != 0 || body.damping.bulk_viscosity != 0)
      refuse(body.place + ".damping", "stiffness-proportional or viscous damping", "use damping.mass");
  }
  for (const ColliderDescription& collider : d.colliders)
    if (collider.rotate)
      refuse(collider.place + ".rotate", "a rotation", "a collider is turned about the axis: take 3D");
  if (!d.ties.empty()) refuse(d.ties.front().place, "a tie", "mesh the bodies as one, with regions");
  if (!d.sections.empty()) refuse(d.sections.front().place, "a section", "take the reaction of a [[fix]]");
  for (const FixDescription& fix : d.fixes)
    if (fix.rotate) refuse(fix.place + ".rotate", "a rotation", "torsion is not part of the model: take 3D");
  for (const LoadDescription& load : d.loads) {
    if (load.kind == "moment") refuse(load.place, "a moment", "take 3D");
    if (load.kind == "force" && load.value.x() != 0)
      throw InputError(load.place + ".value", "a force along the axis (y) in an axisymmetric scene",
                       "a radial component", "give a traction or a pressure");
  }
}

void check_radii(const BodyDescription& description, const VectorX& rest_positions, Index first_node) {
  const double slack = axis_tolerance * largest_radius(rest_positions);
  for (Eigen::Index node = first_node; node < rest_positions.size() / 2; ++node) {
    const double r = rest_positions[2 * node];
    if (r >= -slack) continue;
    const std::string name = description.mesh_name.empty() ? "" : " (" + description.mesh_name + ")";
    throw InputError(description.place + ".mesh" + name + ": vertex " + std::to_string(node - first_node),
                     "a radius r >= 0: the mesh crosses the axis", format_number(r),
                     "x is the radius: move the body with translate, or mesh the half section alone");
  }
}

void fix_axis(World& world) {
  if (!is_axisymmetric(world)) return;
  const double slack = axis_tolerance * largest_radius(world.rest_positions);
  Index count = 0;
  for (Index node = 0; node < world.num_nodes(); ++node) {
    const Eigen::Index i = 2 * Eigen::Index{node};
    if (world.rest_positions[i] > slack) continue;
    ++count;
    world.is_fixed[static_cast<std::size_t>(i)] = 1;
  }
  if (count > 0)
    world.notes.push_back(world.place + ": u_r = 0 at " + std::to_string(count) + " nodes on the axis");
}

}  // namespace resilin
