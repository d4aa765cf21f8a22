#include "resilin/live/live_controls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/material/law_sum.hpp"
#include "resilin/material/plane_stress.hpp"
#include "resilin/material/rest_tangents.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/cell_material.hpp"
#include "resilin/world/colliders.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin {
namespace {

constexpr double anchor_over_hand =
    100;  ///< stiffness of what holds a deformable body, over that of the hand
// The hand moves a rigid body by its extent in a quarter of a second, or lifts it.
constexpr double hand_acceleration = 30;  ///< by the mass, in extents [1/s^2]
constexpr double hand_over_weight = 2;
constexpr double stretch_of_hand = 0.05;  ///< stretch of a hand that pulls with all its force, in extents

bool all_are_rigid(const World& world) {
  return std::ranges::all_of(world.bodies, [](const Body& body) { return body.rigid != nullptr; });
}

/// Mean volume of a deformable cell to the power 1 / dim [m].
double cell_size(const World& world) {
  double volume = 0, cells = 0;
  for (const Body& body : world.bodies) {
    if (body.rigid && !all_are_rigid(world)) continue;
    volume += body.domains.total_rest_volume();
    cells += static_cast<double>(body.num_cells());
  }
  return std::pow(volume / cells, 1.0 / world.dimension);
}

/// A height of two digits at or just under the lowest node at rest, along `up` [m].
double height_under(const World& world, const Vector3& up) {
  double lowest = std::numeric_limits<double>::infinity();
  const auto look_at = [&](const VectorX& positions, Index first, Index count) {
    for (Index node = first; node < first + count; ++node)
      lowest = std::min(lowest, node_position(world.dimension, node, positions).dot(up));
  };
  for (const Body& body : world.bodies) {
    if (body.rigid)
      look_at(body.rigid->rest_positions, 0, body.rigid->body.num_nodes);
    else
      look_at(world.rest_positions, body.first_node, body.num_nodes);
  }
  const double digits = std::pow(10, 2 - std::floor(std::log10(world.largest_extent())));
  return std::floor(lowest * digits + 1e-6) / digits;
}

}  // namespace

bool is_floor(const ColliderDescription& collider, const Vector3& up) {
  return collider.kind == "half_space" && !collider.rotate && motion_of(collider, 1).is_at_rest() &&
         collider.shape.normal.normalized().dot(up) > 1 - 1e-12;
}

BodyControls starting_material(const BodyDescription& description, const Body& body) {
  const MaterialDescription& material = description.material;
  BodyControls controls;
  controls.law = material.law;
  if (body.rigid) {
    constexpr double least = 1, greatest = 1e12;  // [Pa], as the table of controls has it
    controls.youngs_modulus = std::clamp(body.rigid->contact_modulus, least, greatest);
    controls.poissons_ratio = 0;
    return controls;
  }
  const LawInfo& law = require_law(material.law, material.place + ".law");
  const std::vector<double> constants = constants_of_cells(law, material, body.num_cells());
  double mu = 0, lambda = 0, count = 0;
  for_each_rest_tangent(law, constants, [&](std::size_t, const double* A) {
    lambda += A[4];  // dP_00/dF_11
    mu += A[9 + 1];  // dP_01/dF_01
    ++count;
  });
  const Hooke hooke{mu / count, lambda / count};
  controls.youngs_modulus = hooke.youngs_modulus();
  controls.poissons_ratio = hooke.poissons_ratio();
  if (material.constants.contains("youngs_modulus")) {  // as written, without rounding
    controls.youngs_modulus = material.constants.at("youngs_modulus");
    controls.poissons_ratio = material.constants.at("poissons_ratio");
  }
  return controls;
}

LiveControls with_material(LiveControls controls, const BodyControls& material) {
  controls.law = material.law;
  controls.youngs_modulus = material.youngs_modulus;
  controls.poissons_ratio = material.poissons_ratio;
  return controls;
}

namespace {

[[noreturn]] void refuse_to_play(const Description& description, const std::string& dimension) {
  throw InputError(description.place + ": simulation.dimension",
                   "the live page has no \"" + dimension +
                       "\" scenes, it moves solids and plane strain; `resilin run` computes this scene, and "
                       "`resilin view` shows the folder of its results");
}

}  // namespace

LiveControls starting_controls(const Description& description, const World& world, const Vector3& up) {
  const std::size_t first = first_deformable(world);
  if (is_plane_stress(world.bodies.front().domains.front().law_info()))
    refuse_to_play(description, "plane_stress");
  if (is_axisymmetric(world)) refuse_to_play(description, "axisymmetric");
  if (world.thickness != 1)
    throw InputError(description.place + ": simulation.thickness", "1 m for a scene to play with",
                     format_number(world.thickness), "compute it with resilin run and look at its pictures");
  LiveControls controls =
      with_material({}, starting_material(description.bodies[first], world.bodies[first]));
  controls.damping = description.bodies.front().damping.mass;
  controls.gravity = description.gravity;
  controls.time_step = description.is_dynamic ? description.time_step : LiveControls{}.time_step;
  double volume = 0;
  for (const Body& body : world.bodies)
    if (!body.rigid) volume += body.domains.total_rest_volume();
  // A fiftieth of what doubles a cube of this volume, and no less than half the weight: enough to tilt and
  // stretch a body, too little to turn the cells at the hand inside out where they are not very fine.
  const double area = std::pow(volume, (world.dimension - 1.0) / world.dimension);
  double weight = 0;
  for (const Body& body : world.bodies) weight += body.mass * controls.gravity.norm();
  controls.max_force = std::max(0.02 * controls.youngs_modulus * area, 0.5 * weight);
  for (const Body& body : world.bodies) {
    if (!body.rigid) continue;
    const double acceleration =
        std::max(hand_over_weight * controls.gravity.norm(), hand_acceleration * world.largest_extent(body));
    controls.max_force = std::max(controls.max_force, body.mass * acceleration);
  }
  if (controls.max_force == 0)  // statics without a density
    controls.max_force =
        1e-3 * controls.youngs_modulus * std::pow(world.largest_extent(), world.dimension - 1);
  controls.max_force = std::stod(format_short(controls.max_force));
  controls.ground_height = height_under(world, up);
  if (world.contact) {
    controls.contact_friction = description.contact.friction;
    controls.contact_stiffness = std::ranges::min(world.contact->surface().stiffness);
    controls.contact_distance = world.contact->activation_distance();
  }
  return controls;
}

MaterialDescription material_of(const BodyControls& controls, const MaterialDescription& description) {
  const LawInfo& law = require_law(controls.law, "law");
  MaterialDescription material = description;
  // The parts of a sum have moduli of their own, which no slider shows.
  if (is_sum(law)) return material;
  material.law = controls.law;
  if (law.max_fibres == 0) material.fibres.clear();
  // The same law keeps what is given beside Young's modulus and Poisson's ratio.
  const auto is_dropped = [&](const auto& given) {
    const auto is_it = [&](const ConstantText& constant) {
      return constant.is_free && constant.name == given.first;
    };
    return controls.law != description.law || std::ranges::none_of(law.constants, is_it);
  };
  std::erase_if(material.constants, is_dropped);
  std::erase_if(material.cell_constants, is_dropped);
  material.constants["youngs_modulus"] = controls.youngs_modulus;
  material.constants["poissons_ratio"] = controls.poissons_ratio;
  return material;
}

std::vector<const LawInfo*> live_laws() {
  std::vector<const LawInfo*> all = laws();
  std::erase_if(all, [](const LawInfo* law) { return !law->needs_only_hooke(); });
  return all;
}

std::size_t first_deformable(const World& world) {
  for (std::size_t b = 0; b < world.bodies.size(); ++b)
    if (!world.bodies[b].rigid) return b;
  return 0;
}

double hand_stiffness(const LiveControls& controls, const World& world, const Body& body) {
  if (body.rigid) return controls.max_force / (stretch_of_hand * world.largest_extent());
  const double thickness = world.dimension == 3 ? cell_size(world) : 1;
  return 10 * controls.youngs_modulus * thickness;
}

double anchor_stiffness(const Body& body, const LiveControls& controls, const World& world) {
  if (body.rigid) return body.rigid->modulus * (world.dimension == 3 ? world.largest_extent(body) : 1);
  return anchor_over_hand * hand_stiffness(controls, world, body);
}

}  // namespace resilin
