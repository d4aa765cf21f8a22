#include "resilin/live/face_load.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/live/live_contents.hpp"
#include "resilin/world/loads.hpp"

namespace resilin {
namespace {

constexpr const char* place_of_face_load = "load";  ///< begins messages
constexpr double least_direction = 0.05;  ///< smallest sum of a face's normals, relative to its area

/// The sum of the nodal forces of a load at rest [N].
Vector3 resultant(const Energy& load, const World& world) {
  VectorX gradient = VectorX::Zero(world.rest_positions.size());
  load.add_gradient(world.rest_positions, world.at_load(1), gradient);
  Vector3 sum = Vector3::Zero();
  for (Index node = 0; node < world.num_nodes(); ++node)
    sum -= node_position(world.dimension, node, gradient);
  return sum;
}

}  // namespace

int LiveScene::put_load(std::size_t body, std::vector<Index> vertices, const FaceLoadChoice& choice) {
  Contents& c = *contents_;
  if (body >= c.world.bodies.size())
    throw InputError("load: body", "a number from 0 to " + std::to_string(c.world.bodies.size() - 1),
                     std::to_string(body));
  if (!std::isfinite(choice.value) || choice.value == 0)
    throw InputError("load: value", "a finite number other than 0", format_number(choice.value));
  FaceLoad load{.number = 1, .body = body, .description = {}, .term = {}};
  LoadDescription& description = load.description;
  description.place = place_of_face_load;
  description.body = c.description.bodies[body].name;
  description.where.kind = Where::Kind::vertices;
  description.where.vertices = std::move(vertices);
  const auto made = [&] {
    return make_load(description, c.world, c.world.bodies[body], c.description.bodies[body].mesh);
  };
  description.kind = "pressure";
  description.pressure = 1;
  if (choice.kind == FaceLoadChoice::Kind::pressure) {
    description.pressure = choice.value;
  } else {
    const Vector3 inwards = resultant(*made(), c.world);  // its length is the area if the face is flat
    description.kind = "traction";
    description.pressure = 0;
    description.value = Vector3::UnitX();
    const double area = resultant(*made(), c.world).norm();
    if (!(inwards.norm() > least_direction * area))
      throw InputError("load", "a face that looks to one side", "one whose normals cancel",
                       "a smaller angle or radius of the face, or a pressure");
    description.value = choice.value / area * inwards.normalized();
  }
  load.term = made();
  if (!c.face_loads.empty()) load.number = c.face_loads.back().number + 1;
  c.face_loads.push_back(std::move(load));
  c.is_as_run = false;
  c.renew_terms();
  c.wake();
  return c.face_loads.back().number;
}

void LiveScene::remove_load(int number) {
  const auto is_it = [number](const FaceLoad& load) { return load.number == number; };
  if (std::erase_if(contents_->face_loads, is_it) == 0) return;
  contents_->renew_terms();
  contents_->wake();
}

const std::vector<FaceLoad>& LiveScene::face_loads() const { return contents_->face_loads; }

void LiveScene::settle() {
  Contents& c = *contents_;
  const auto rubs = [](const auto& term) { return term->properties().category == EnergyCategory::friction; };
  if (std::ranges::any_of(c.terms, rubs))
    throw InputError("equilibrium", "a scene without friction",
                     "one with friction, where the equilibrium depends on the load history",
                     "set the coefficients of friction to 0, or wait until the scene is at rest");
  if (c.drives.any_moves())
    throw InputError("equilibrium", "motors and cables that are where they are driven to", "one that moves",
                     "wait until it has its value, or drive its velocity to 0");
  if (!std::isfinite(c.changes_end()))
    throw InputError("equilibrium", "loads and boundary conditions that end", "some that never end");
  if (c.state.time < c.changes_end())
    throw InputError("equilibrium",
                     "a time from " + format_short(c.changes_end()) +
                         " s on, when loads, boundary conditions and colliders have ended",
                     format_short(c.state.time) + " s");
  c.wake();
  c.state.velocities.setZero();
  c.calm.quiet_steps = quiet_steps_before_seeking;
}

}  // namespace resilin
