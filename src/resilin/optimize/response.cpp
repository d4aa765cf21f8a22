#include "resilin/linear/dependents.hpp"
#include "resilin/optimize/near_solve.hpp"
#include "resilin/optimize/newton.hpp"
#include "resilin/optimize/residual.hpp"

// Response of a scene to forces by the last matrix of Newton's method.

namespace resilin {

void Newton::keep_measure(bool has_matrix, const ConnectedComponents& parts, const VectorX& weights) {
  has_near_factors_ = false;
  last_measure_.reset();
  if (!has_matrix) return;
  last_measure_.emplace();
  if (parts.count() == 1) return;
  last_measure_->parts = parts;
  last_measure_->weights = weights;
}

bool Newton::factorize_last(const VectorX& x) {
  solver_->analyze(hessian_, x);
  const LinearReport linear = solver_->factorize(hessian_);
  require_memory(linear);
  return linear.status == LinearReport::Status::ok;
}

void Newton::form_matrix(const Objective& objective, std::span<const std::uint8_t> is_fixed, const VectorX& x,
                         Factors factors) {
  hessian_.set_zero();
  objective.hessian(x, Projection::clamp, hessian_);
  if (objective.dependents() != nullptr) objective.dependents()->reduce(hessian_);
  eliminate(hessian_, is_fixed);
  if (factors == Factors::anew || !last_measure_) {
    solver_->begin_search();
    return keep_measure(factorize_last(x), parts_, VectorX::Ones(parts_.count()));
  }
  if (last_measure_->parts) scale_components(*last_measure_->parts, last_measure_->weights, hessian_);
  has_near_factors_ = solver_->is_direct();
  if (!has_near_factors_ && !factorize_last(x)) last_measure_.reset();
}

std::optional<VectorX> Newton::response(VectorX forces, std::span<const std::uint8_t> is_fixed,
                                        double tolerance) {
  if (!last_measure_) return std::nullopt;
  set_fixed_to_zero(is_fixed, forces);
  if (last_measure_->parts) scale_components(*last_measure_->parts, last_measure_->weights, forces);
  const auto solve = [this](const VectorX& b, VectorX& way, double goal) {
    way.setZero(b.size());
    const LinearReport linear = solver_->solve(hessian_, b, way, goal);
    return linear.status != LinearReport::Status::indefinite && parts_.share().all(way.allFinite());
  };
  VectorX way;
  if (has_near_factors_) {
    const NearSolve near = [&](const VectorX& b, VectorX& p) { return solve(b, p, 1); };
    const Product times = [&](const VectorX& p, VectorX& product) { multiply(hessian_, p, product); };
    if (std::optional<VectorX> found = solve_by_near(times, near, forces, tolerance)) return found;
    has_near_factors_ = false;
    if (!factorize_last({})) last_measure_.reset();
    if (!last_measure_) return std::nullopt;
  }
  if (!solve(forces, way, tolerance)) return std::nullopt;
  return way;
}

std::optional<VectorX> Newton::response_near(const BlockMatrix& A, VectorX forces,
                                             std::span<const std::uint8_t> is_fixed, double tolerance) {
  if (!last_measure_ || last_measure_->parts || has_near_factors_ || solver_->is_direct())
    return std::nullopt;
  set_fixed_to_zero(is_fixed, forces);
  VectorX way = VectorX::Zero(forces.size());
  if (solver_->solve(A, forces, way, tolerance).status != LinearReport::Status::ok) return std::nullopt;
  return way;
}

}  // namespace resilin
