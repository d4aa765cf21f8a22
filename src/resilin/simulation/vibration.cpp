#include "resilin/simulation/vibration.hpp"

#include <cmath>
#include <numbers>

#include "resilin/core/log.hpp"
#include "resilin/core/memory.hpp"
#include "resilin/core/stopwatch.hpp"
#include "resilin/linear/eigenmodes.hpp"
#include "resilin/simulation/potential.hpp"

namespace resilin {
namespace {

constexpr double drawn_size = 0.1;  ///< drawn size, relative to the largest extent

/// (shape^T M 1_k)^2 for each axis k.
Vector3 effective_mass(const World& world, const VectorX& shape) {
  VectorX momentum;
  world.mass->multiply(shape, momentum);
  Vector3 participation = Vector3::Zero();
  for (Eigen::Index i = 0; i < momentum.size(); ++i)
    participation[static_cast<int>(i % world.dimension)] += momentum[i];
  return participation.cwiseAbs2();
}

/// Shapes have two signs: the one whose largest entry is positive.
VectorX with_fixed_sign(const VectorX& shape) {
  Eigen::Index largest = 0;
  shape.cwiseAbs().maxCoeff(&largest);
  return shape[largest] < 0 ? VectorX(-shape) : shape;
}

void explain(EigenModes::Status status, StepReport& report) {
  using Status = EigenModes::Status;
  if (status == Status::converged) return;
  report.status =
      status == Status::interrupted ? StepReport::Status::interrupted : StepReport::Status::not_converged;
  report.reason = "the eigenvalue solver did not converge";
}

}  // namespace

double VibrationMode::frequency() const {
  return is_rigid || eigenvalue < 0 ? 0 : std::sqrt(eigenvalue) / (2 * std::numbers::pi);
}

std::vector<VibrationMode> find_modes(const World& world, const VectorX& equilibrium, double load,
                                      StepReport& report, const std::function<bool()>& is_stopped) {
  BlockMatrix stiffness(world.dimension, world.pattern);
  {
    const Stopwatch watch(report.newton.assembly_seconds);
    const Potential potential = Potential::at(world, world.at_load(load), equilibrium);
    potential.hessian(equilibrium, Projection::none, stiffness);
  }
  const EigenProblem problem{
      .stiffness = stiffness,
      .add_mass = [&world](double factor, BlockMatrix& A) { world.mass->add_to(factor, A); },
      .multiply_mass = [&world](const VectorX& x, VectorX& y) { world.mass->multiply(x, y); },
      .is_fixed = world.is_fixed};
  const auto search = [&](const std::string& kind) {
    const auto solver = make_linear_solver({.kind = kind, .max_iterations = world.solver.max_iterations},
                                           world.num_free_unknowns());
    return smallest_eigenmodes(problem, world.modes->count, *solver, is_stopped);
  };
  const Stopwatch watch(report.newton.solve_seconds);
  // A factor is used for dozens of right sides: a direct solver, where it has room, unless the scene names
  // another.
  const bool is_free_choice = world.solver.kind == "auto";
  EigenModes found = search(is_free_choice ? "cholesky" : world.solver.kind);
  if (found.status == EigenModes::Status::out_of_memory && is_free_choice) {
    log_info(found.shortage + "; auto solves instead");
    found = search("auto");
  }
  if (found.status == EigenModes::Status::out_of_memory) throw OutOfMemory(found.shortage);
  report.newton.linear_solves += found.num_solves;
  explain(found.status, report);
  std::vector<VibrationMode> modes;
  if (found.status != EigenModes::Status::converged) return modes;
  for (Eigen::Index k = 0; k < found.values.size(); ++k) {
    const VectorX shape = with_fixed_sign(found.vectors.col(k));
    modes.push_back({.eigenvalue = found.values[k],
                     .is_rigid = std::abs(found.values[k]) <= found.zero,
                     .shape = shape,
                     .effective_mass = effective_mass(world, shape)});
  }
  return modes;
}

VectorX drawn_mode(const World& world, const VectorX& equilibrium, const VibrationMode& mode) {
  double farthest = 0;
  for (Index node = 0; node < world.num_nodes(); ++node)
    farthest =
        std::max(farthest, mode.shape.segment(Eigen::Index{node} * world.dimension, world.dimension).norm());
  const VectorX motion = drawn_size * world.largest_extent() / farthest * mode.shape;
  double length = 1;
  for (const auto& term : world.terms) length = std::min(length, term->max_step(equilibrium, motion, {}));
  return equilibrium + length * motion;
}

}  // namespace resilin
