#include "resilin/simulation/contact_patches.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "resilin/simulation/step.hpp"

namespace resilin {
namespace {

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

double worst_patch(const World& world, const Potential& potential, const ConnectedComponents& parts,
                   const VectorX& x, double residual, const VectorX& rounding) {
  if (!world.share.is_whole()) return 0;
  const std::vector<VectorX> acting = potential.gradients_without(EnergyCategory::elastic, x);
  const VectorX touch =
      potential.gradient_of(EnergyCategory::contact, x) + potential.gradient_of(EnergyCategory::friction, x);
  if (touch.isZero(0)) return 0;
  Index count = 0;
  const std::vector<Index> patch_of = patches_of(world, touch, count);
  const Eigen::Index dim = world.dimension;
  const auto sums_over_patches = [&](const VectorX& forces) {
    VectorX sums = VectorX::Zero(count);
    for (Index node = 0; node < world.num_nodes(); ++node)
      if (const Index patch = patch_of[static_cast<std::size_t>(node)]; patch >= 0)
        sums[patch] += forces.segment(node * dim, dim).squaredNorm();
    return VectorX(sums.cwiseSqrt());
  };
  const VectorX touches = sums_over_patches(touch);
  VectorX scales = parts.norms(touch, world.is_fixed, Unknowns::all);
  for (const VectorX& forces : acting)
    scales = scales.cwiseMax(parts.norms(forces, world.is_fixed, Unknowns::all));
  VectorX allowed = VectorX::Constant(count, 0.0);  // what the residual of its part may leave at a patch
  for (Index node = 0; node < world.num_nodes(); ++node)
    if (const Index patch = patch_of[static_cast<std::size_t>(node)]; patch >= 0)
      allowed[patch] = residual * scales[parts.of_node(node)];
  if ((allowed.array() <= largest_patch_error * touches.array()).all()) return 0;

  VectorX left;
  potential.gradient(x, left);
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    const double lost = rounding.size() == left.size() ? rounding[i] : 0;
    left[i] = world.is_fixed[static_cast<std::size_t>(i)] != 0 ? 0 : std::max(0.0, std::abs(left[i]) - lost);
  }
  const VectorX residuals = sums_over_patches(left);
  double worst = 0;
  for (Index patch = 0; patch < count; ++patch)
    if (allowed[patch] > largest_patch_error * touches[patch])
      worst = std::max(worst, residuals[patch] / touches[patch]);
  return worst;
}

void settle_patches(const World& world, Potential& potential, const VectorX& targets,
                    const NewtonSettings& settings, Newton& newton, VectorX& x, StageReport& searched,
                    const NewtonObserver& observer) {
  if (!searched.newton.converged() || settings.is_quadratic) return;
  const double residual = std::max(settings.tolerance, searched.friction_mismatch);
  const double worst = worst_patch(world, potential, newton.parts(), x, residual, searched.newton.rounding);
  if (worst <= largest_patch_error) return;
  NewtonSettings tighter = settings;
  tighter.tolerance = std::max(smallest_tolerance, 0.3 * largest_patch_error / worst * settings.tolerance);
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
