#include "resilin/sensitivity/rest_balance.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/sensitivity/prescribed_changes.hpp"
#include "resilin/sensitivity/stage_slopes.hpp"
#include "resilin/world/meeting_surface.hpp"

namespace resilin {
namespace {
/// Loads and the forces of contact, both as raised to this part.
Conditions raised(const World& world, double part) {
  Conditions conditions = world.at_load(part);
  conditions.weight = part;
  return conditions;
}

}  // namespace

bool is_free_along(const World& world, const Body& body, int axis) {
  for (Index node = body.first_node; node < body.first_node + body.num_nodes; ++node)
    if (world.support_of[static_cast<std::size_t>(node * world.dimension + axis)] >= 0) return false;
  return std::ranges::none_of(world.made_from->loads, [&](const LoadDescription& load) {
    return load.kind == "spring" && (load.body == body.name || load.body.empty());
  });
}

VectorX places_moved(VectorX places, const Vector3& by, int dim) {
  for (Eigen::Index i = 0; i < places.size(); ++i) places[i] += by[i % dim];
  return places;
}

RestBalance::RestBalance(Description description, const std::vector<std::string>& names,
                         const RestAndDeformed& shape, double part)
    : world_(std::move(description)),
      links_(world_),
      conditions_(raised(world_, part)),
      x_(places_moved(shape.deformed, -world_.origin, world_.dimension)),
      potential_(Potential::at(world_, conditions_, x_)),
      tangent_(world_, world_.solver.kind),
      other_areas_(world_) {
  for (const std::string& name : names) parameters_.push_back(find_parameter(world_, name));
  for (const Body& body : world_.bodies)
    for (int axis = 0; axis < world_.dimension; ++axis) is_free_.push_back(is_free_along(world_, body, axis));
  potential_.prepare(x_, VectorX::Zero(x_.size()));
}
bool RestBalance::is_apart() const { return std::isfinite(potential_.energy(EnergyCategory::contact, x_)); }

void RestBalance::form() {
  tangent_.form(potential_, x_);
  const bool is_held = std::ranges::none_of(is_free_, [](bool is_free) { return is_free; });
  if (!is_held || potential_.gradient_of(EnergyCategory::contact, x_).isZero(0)) return;
  Conditions conditions = conditions_;
  conditions.weight = 0;
  untouched_ = std::make_unique<Potential>(Potential::at(world_, conditions, x_));
  untouched_->prepare(x_, VectorX::Zero(x_.size()));
  untouched_tangent_ = std::make_unique<Tangent>(world_, world_.solver.kind);
  untouched_tangent_->form(*untouched_, x_);
}

VectorX RestBalance::residual() const {
  VectorX found;
  potential_.gradient(x_, found);
  for (std::size_t i = 0; i < world_.is_fixed.size(); ++i)
    if (world_.is_fixed[i] != 0) found[static_cast<Eigen::Index>(i)] = 0;
  VectorX prescribed = world_.rest_positions;
  place_supports(world_.dimension, world_.supports, world_.rest_positions, conditions_, prescribed);
  for (std::size_t i = 0; i < world_.is_fixed.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (world_.is_fixed[i] != 0) found[k] = x_[k] - prescribed[k];
  }
  return found;
}

VectorX RestBalance::preconditioned(const VectorX& residual) {
  VectorX z = residual;
  for (std::size_t i = 0; i < world_.is_fixed.size(); ++i)
    if (world_.is_fixed[i] == 0) z[static_cast<Eigen::Index>(i)] = 0;
  Tangent& K = untouched_tangent_ ? *untouched_tangent_ : tangent_;
  return z + K.solve_symmetric_part(residual - K.times(z, false));
}

VectorX RestBalance::product(const VectorX& z) {
  const WorldChange change = change_of(z);
  const VectorX dx = z + change.rest_positions;
  VectorX found = VectorX::Zero(x_.size());
  add_stage_forces({world_, potential_}, x_, links_.spread(change), {}, found);
  add_area_forces(change.rest_positions, found);
  found += tangent_.times(dx, false);
  Motion prescribed{dx, VectorX::Zero(dx.size()), VectorX::Zero(dx.size())};
  place_prescribed_changes(world_, change, conditions_, prescribed);
  for (std::size_t i = 0; i < world_.is_fixed.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (world_.is_fixed[i] != 0) found[k] = dx[k] - prescribed.positions[k];
  }
  return found;
}

// Areas are polynomials of the rest places, or roots of such: a central difference has ten digits.
void RestBalance::add_area_forces(const VectorX& change, VectorX& forces) {
  const double size = change.cwiseAbs().maxCoeff();
  if (world_.colliders.empty() || !(size > 0)) return;
  const double step = 1e-5 * world_.largest_extent() / size;
  for (std::size_t i = 0, k = 0; i < world_.made_from->colliders.size(); ++i) {
    const ColliderDescription& description = world_.made_from->colliders[i];
    if (k == world_.colliders.size() || world_.colliders[k]->name() != description.name) continue;
    const auto stiffness_at = [&](double t) {
      other_areas_.other_contact_shape = world_.contact_shape() + t * change;
      const std::vector<double> found = contact_points(other_areas_, description.stiffness).stiffness;
      return VectorX(Eigen::Map<const VectorX>(found.data(), static_cast<Eigen::Index>(found.size())));
    };
    const ColliderBarrier& collider = *world_.colliders[k++];
    VectorX by = VectorX::Zero(collider.num_stiffnesses());  // those of facets do not follow the shape
    const VectorX of_points = (stiffness_at(step) - stiffness_at(-step)) / (2 * step);
    by.head(of_points.size()) = of_points;
    collider.add_parameter_forces("barrier_stiffness", x_, by, conditions_, forces);
  }
}

RestAndDeformed RestBalance::moved(const RestAndDeformed& shape, const VectorX& z) const {
  RestAndDeformed next = shape;
  for (std::size_t b = 0; b < parameters_.size(); ++b) next.rest[b] += of_vertices(b, z);
  next.deformed += z + change_of(z).rest_positions;
  return next;
}

VectorX RestBalance::of_vertices(std::size_t body, const VectorX& z) const {
  const Eigen::Index dim = world_.dimension;
  VectorX change =
      -z.segment(Eigen::Index{world_.bodies[body].first_node} * dim, parameters_[body].value.size());
  Eigen::Map<Eigen::MatrixXd> rows(change.data(), dim, change.size() / dim);
  for (Eigen::Index axis = 0; axis < dim; ++axis)
    if (is_free_[body * static_cast<std::size_t>(dim) + static_cast<std::size_t>(axis)])
      rows.row(axis).array() -= rows.row(axis).mean();
  return change;
}
WorldChange RestBalance::change_of(const VectorX& z) const {
  WorldChange change(world_);
  for (const Parameter& parameter : parameters_) parameter.ask(change);
  for (std::size_t b = 0; b < parameters_.size(); ++b) parameters_[b].spread(of_vertices(b, z), change);
  return change;
}

}  // namespace resilin
