#include "resilin/simulation/contact_patches.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "resilin/simulation/step.hpp"

namespace resilin {
namespace {

/// Imbalance of a part that is small for a patch, relative to the forces on the patch.
constexpr double largest_patch_error = 1e-3;
/// Positions have no digits for less; a patch that would need it is grazed.
constexpr double smallest_tolerance = 1e-12;

/// Numbers of the patches by node, -1 for nodes that nothing touches.
std::vector<Index> patches_of(const World& world, const VectorX& touch, Index& count) {
  const Eigen::Index dim = world.dimension;
  std::vector<Index> root(static_cast<std::size_t>(world.num_nodes()), -1);
  const auto at = [&](Index node) -> Index& { return root[static_cast<std::size_t>(node)]; };
  for (Index node = 0; node < world.num_nodes(); ++node)
    if (!touch.segment(node * dim, dim).isZero(0)) at(node) = node;
  const auto root_of = [&](Index node) {
    while (at(node) != node) node = at(node) = at(at(node));
    return node;
  };
  const BlockPattern& pattern = *world.pattern;
  for (Index i = 0; i < world.num_nodes(); ++i) {
    if (at(i) < 0) continue;
    const auto row = static_cast<std::size_t>(i);
    for (Offset slot = pattern.row_begin[row] + 1; slot < pattern.row_begin[row + 1]; ++slot) {
      const Index j = pattern.columns[static_cast<std::size_t>(slot)];
      if (at(j) < 0) continue;
      const Index a = root_of(i), b = root_of(j);
      at(std::max(a, b)) = std::min(a, b);
    }
  }
  std::vector<Index> number(root.size(), -1);
  count = 0;
  for (Index node = 0; node < world.num_nodes(); ++node) {
    if (at(node) < 0) continue;
    Index& of_root = number[static_cast<std::size_t>(root_of(node))];
    if (of_root < 0) of_root = count++;
    number[static_cast<std::size_t>(node)] = of_root;
  }
  return number;
}

}  // namespace

double tolerance_of_patches(const World& world, const Potential& potential, const ConnectedComponents& parts,
                            const VectorX& x, double tolerance, double residual, const VectorX& rounding) {
  if (!world.share.is_whole()) return tolerance;
  const VectorX touch =
      potential.gradient_of(EnergyCategory::contact, x) + potential.gradient_of(EnergyCategory::friction, x);
  if (touch.isZero(0)) return tolerance;
  VectorX scales = parts.norms(touch, world.is_fixed, Unknowns::all);
  for (const VectorX& forces : potential.gradients_without(EnergyCategory::elastic, x))
    scales = scales.cwiseMax(parts.norms(forces, world.is_fixed, Unknowns::all));
  Index count = 0;
  const std::vector<Index> patch_of = patches_of(world, touch, count);
  const Eigen::Index dim = world.dimension;
  VectorX forces = VectorX::Zero(count);
  std::vector<Index> part_of(static_cast<std::size_t>(count));
  for (Index node = 0; node < world.num_nodes(); ++node)
    if (const Index patch = patch_of[static_cast<std::size_t>(node)]; patch >= 0) {
      forces[patch] += touch.segment(node * dim, dim).squaredNorm();
      part_of[static_cast<std::size_t>(patch)] = parts.of_node(node);
    }
  std::optional<VectorX> residuals;  // costs a gradient
  double needed = tolerance;
  for (Index patch = 0; patch < count; ++patch) {
    const Index part = part_of[static_cast<std::size_t>(patch)];
    const double left = largest_patch_error * std::sqrt(forces[patch]), wanted = left / scales[part];
    if (wanted >= residual || wanted < smallest_tolerance) continue;
    if (!residuals) {
      VectorX gradient;
      potential.gradient(x, gradient);
      if (rounding.size() == gradient.size())
        gradient = (gradient.cwiseAbs() - rounding).cwiseMax(0.0).eval();
      residuals = parts.norms(gradient, world.is_fixed, Unknowns::free);
    }
    if ((*residuals)[part] > left) needed = std::min(needed, wanted);
  }
  return needed;
}

void settle_patches(const World& world, Potential& potential, const VectorX& targets,
                    const NewtonSettings& settings, Newton& newton, VectorX& x, StageReport& searched,
                    const NewtonObserver& observer) {
  if (!searched.newton.converged() || settings.is_quadratic) return;
  const double residual = std::max(settings.tolerance, searched.friction_mismatch);
  NewtonSettings tighter = settings;
  tighter.tolerance = tolerance_of_patches(world, potential, newton.parts(), x, settings.tolerance, residual,
                                           searched.newton.rounding);
  if (!(tighter.tolerance < settings.tolerance)) return;
  VectorX closer = x;
  const StageReport again =
      solve_stage(potential, world.is_fixed, targets, {}, tighter,
                  {.friction_rounds = world.friction_iterations}, newton, closer, observer);
  if (!again.newton.converged()) {
    add_counts(searched.newton, again.newton);
    potential.form_lag(x);
    return;
  }
  x = std::move(closer);
  add_to(searched.newton, again.newton);
  searched.friction_rounds += again.friction_rounds;
  searched.friction_mismatch = again.friction_mismatch;
}

}  // namespace resilin
