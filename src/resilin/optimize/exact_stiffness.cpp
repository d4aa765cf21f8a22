#include "resilin/optimize/exact_stiffness.hpp"

#include "resilin/linear/dependents.hpp"
#include "resilin/optimize/residual.hpp"

namespace resilin {

LinearReport ExactStiffness::factorize(const Objective& objective, std::span<const std::uint8_t> is_fixed,
                                       const VectorX& x, const VectorX& fixed_motion, VectorX* pull) {
  hessian_.set_zero();
  objective.hessian(x, Projection::none, hessian_);
  const Dependents* dependents = objective.dependents();
  if (pull != nullptr) {
    multiply(hessian_, fixed_motion, *pull);
    if (dependents != nullptr) dependents->add_forces(*pull);
    set_fixed_to_zero(is_fixed, *pull);
  }
  if (dependents != nullptr) dependents->reduce(hessian_);
  diagonal_ = free_diagonal(hessian_, is_fixed);
  eliminate(hessian_, is_fixed);
  return solver_->factorize(hessian_);
}

}  // namespace resilin
