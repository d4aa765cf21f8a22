#include "resilin/sensitivity/tangent.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/linear/gmres.hpp"
#include "resilin/optimize/near_solve.hpp"
#include "resilin/optimize/residual.hpp"
#include "resilin/world/linear_constraints.hpp"

namespace resilin {
namespace {

constexpr double tight_tolerance = 1e-13;  ///< asked of solvers
constexpr double iterative_tolerance =
    1e-8;  ///< tolerance of iterative solvers, at rest, as of equilibria themselves
/// In motion beside newton.tolerance, to which the steps are right themselves; and at most.
constexpr double beside_newton = 1e-2, loosest_in_motion = 1e-8;
/// When a solution takes more, the next matrix gets factors of its own.
constexpr int most_solves_with_old_factors = 10;
constexpr double largest_residual = 1e-7;  ///< residual with which a solution is still taken
constexpr int most_skew_iterations = 200;  ///< most skew iterations of GMRES
constexpr double refinement = 1e-4;        ///< refinement of a solution of GMRES

LinearOptions options(const World& world, const std::string& kind, bool is_definite,
                      const std::shared_ptr<AnalysisCache>& analyses) {
  return {.kind = kind,
          .is_dynamic = world.is_dynamic,
          .is_definite = is_definite,
          .max_iterations = world.solver.max_iterations,
          .analyses = analyses};
}

}  // namespace

SkewPart::SkewPart(const World& world, const Potential& potential, const VectorX& x)
    : conditions_(potential.conditions()), x_(x) {
  for (const Energy* term : potential.terms()) {
    const auto parameters = term->parameters();
    if (std::ranges::find(parameters, "lag", &EnergyParameter::name) == parameters.end()) continue;
    VectorX probe(x.size()), change = VectorX::Zero(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) probe[i] = std::sin(1.0 + 12.9898 * static_cast<double>(i));
    term->add_parameter_forces("lag", x, probe, conditions_, change);
    if (!change.isZero(0)) lagging_.push_back(term);
  }
  if (potential.has_potential(x)) return;
  symmetric_ = BlockMatrix(world.dimension, world.pattern);
  for (const Energy* term : potential.terms()) {
    if (term->properties().has_potential) continue;
    terms_.push_back(term);
    term->add_hessian(x, conditions_, Projection::none, symmetric_);
  }
}

VectorX SkewPart::times(const VectorX& p, bool is_transposed) const {
  VectorX product = (is_transposed ? -1 : 1) * skew_times(p);
  for (const Energy* term : lagging_) {
    if (is_transposed)
      term->add_parameter_slopes("lag", x_, p, conditions_, product);
    else
      term->add_parameter_forces("lag", x_, p, conditions_, product);
  }
  return product;
}

VectorX SkewPart::skew_times(const VectorX& p) const {
  const double size = p.cwiseAbs().maxCoeff();
  if (terms_.empty() || !(size > 0)) return VectorX::Zero(p.size());
  const double length = (x_.maxCoeff() - x_.minCoeff()) / size;
  VectorX after = VectorX::Zero(p.size()), before = after, symmetric;
  for (const Energy* term : terms_) {
    term->add_gradient(x_ + length * p, conditions_, after);
    term->add_gradient(x_ - length * p, conditions_, before);
  }
  multiply(symmetric_, p, symmetric);
  return (after - before) / (2 * length) - symmetric;
}

Tangent::Tangent(const World& world, const std::string& solver_kind, std::shared_ptr<AnalysisCache> analyses)
    : world_(world),
      solver_kind_(solver_kind),
      analyses_(std::move(analyses)),
      whole_(world.dimension, world.pattern) {}

void Tangent::begin_sequence() {
  is_sequence_ = true;
  has_factors_ = false;
  if (definite_) definite_->begin_search();
  if (indefinite_) indefinite_->begin_search();
}

void Tangent::form(const Potential& potential, const VectorX& x, Newton* near) {
  whole_.set_zero();
  potential.hessian(x, Projection::none, whole_);
  skew_.emplace(world_, potential, x);
  free_ = whole_;
  if (world_.constraints) world_.dependents()->reduce(free_);
  eliminate(free_, world_.is_fixed);
  has_impulses_ = std::ranges::any_of(
      potential.terms(), [](const Energy* term) { return acts_as_impulse(term->properties().category); });
  x_ = x;
  near_ = near;
  negative_ = 0;
  are_factors_old_ = has_factors_;
  if (near_ == nullptr && !has_factors_) factorize();
}

void Tangent::factorize() {
  const Index num_unknowns = world_.num_free_unknowns();
  if (!definite_)
    definite_ = make_linear_solver(options(world_, solver_kind_, true, analyses_), num_unknowns);
  solver_ = definite_.get();
  has_factors_ = are_factors_old_ = false;
  if (!is_sequence_) solver_->begin_search();
  solver_->analyze(free_, x_);
  LinearReport report = solver_->factorize(free_);
  require_memory(report);
  if (report.status == LinearReport::Status::ok && !solver_->is_direct() && !is_sequence_) {
    // A matrix that an iterative solver has not refused may still be indefinite.
    VectorX probe = VectorX::Zero(x_.size()), b(x_.size());
    for (Eigen::Index i = 0; i < b.size(); ++i) b[i] = std::sin(1.0 + 12.9898 * static_cast<double>(i));
    set_fixed_to_zero(world_.is_fixed, b);
    report = solver_->solve(free_, b, probe, 1e-3);
  }
  if (report.status == LinearReport::Status::ok) {
    has_factors_ = is_sequence_ && solver_->is_direct();
    return;
  }
  factorize_indefinite();
}

void Tangent::factorize_indefinite() {
  const Index num_unknowns = world_.num_free_unknowns();
  if (!indefinite_) indefinite_ = make_linear_solver(options(world_, "auto", false, analyses_), num_unknowns);
  solver_ = indefinite_.get();
  if (!is_sequence_) solver_->begin_search();
  solver_->analyze(free_, x_);
  const LinearReport report = solver_->factorize(free_);
  require_memory(report);
  if (report.status != LinearReport::Status::ok)
    throw InputError(world_.place, "an invertible stiffness matrix", "a singular one",
                     "the body is at a limit point: take another load");
  negative_ = report.negative_pivots;
}

VectorX Tangent::times(const VectorX& p, bool is_transposed) const {
  VectorX product;
  multiply(whole_, p, product);
  if (skew_ && !skew_->is_zero()) product += skew_->times(p, is_transposed);
  return product;
}

double Tangent::tolerance() const {
  if (world_.is_dynamic) {
    // Impulses of stiff barriers magnify what is left.
    if (!is_symmetric() || has_impulses_) return tight_tolerance;
    return std::clamp(beside_newton * world_.newton.tolerance, tight_tolerance, loosest_in_motion);
  }
  const bool is_direct = near_ != nullptr ? near_->solver_is_direct() : solver_->is_direct();
  return is_direct ? tight_tolerance : iterative_tolerance;
}

/// With a solver that iterates, whose answers are no linear function of
/// what it is asked, the residual is solved for again and again.
std::optional<VectorX> Tangent::solve_by_newton(const VectorX& b, double tolerance) {
  constexpr double inner_tolerance = 1e-4;
  const double size = b.norm();
  if (!near_->solver_is_direct()) {
    if (std::optional<VectorX> found = near_->response_near(free_, b, world_.is_fixed, tolerance))
      return found;
    VectorX p = VectorX::Zero(b.size()), residual = b, product;
    for (double left = size; left > tolerance * size;) {
      const std::optional<VectorX> z = near_->response(residual, world_.is_fixed, inner_tolerance);
      if (!z) return std::nullopt;
      p += *z;
      multiply(free_, p, product);
      residual = b - product;
      const double before = left;
      left = residual.norm();
      if (!(left < 0.3 * before)) return std::nullopt;
    }
    return p;
  }
  const NearSolve near = [&](const VectorX& residual, VectorX& p) {
    std::optional<VectorX> found = near_->response(residual, world_.is_fixed, 1);
    if (!found) return false;
    p = *std::move(found);
    return true;
  };
  const Product times = [&](const VectorX& p, VectorX& product) { multiply(free_, p, product); };
  return solve_by_near(times, near, b, tolerance);
}

std::optional<VectorX> Tangent::solve_with_old_factors(const VectorX& b, double tolerance) {
  int solves = 0;
  const NearSolve near = [&](const VectorX& residual, VectorX& p) {
    ++solves;
    p.setZero(residual.size());
    return solver_->solve(free_, residual, p, 1).status == LinearReport::Status::ok;
  };
  const Product times = [&](const VectorX& p, VectorX& product) { multiply(free_, p, product); };
  std::optional<VectorX> found = solve_by_near(times, near, b, tolerance);
  if (solves > most_solves_with_old_factors) has_factors_ = false;
  return found;
}

std::optional<VectorX> Tangent::solve_with_near(const VectorX& b, double tolerance) {
  if (near_ == nullptr && !are_factors_old_) return std::nullopt;
  std::optional<VectorX> found =
      near_ != nullptr ? solve_by_newton(b, tolerance) : solve_with_old_factors(b, tolerance);
  if (!found) {
    near_ = nullptr;
    factorize();
  }
  return found;
}

VectorX Tangent::solve_symmetric(const VectorX& b, EarlierSolutions* earlier) {
  VectorX p = VectorX::Zero(b.size()), product;
  const double size = b.norm();
  if (!(size > 0)) return p;
  VectorX rest = b;
  if (earlier != nullptr) {
    if (VectorX start = earlier->nearest(free_, b); start.size() > 0) {
      p = std::move(start);
      multiply(free_, p, product);
      rest -= product;
    }
  }
  LinearReport report;
  // An iterative solver ends at its rounding; what is left is solved for once more.
  for (int again = 0; again < 3; ++again) {
    const double left = rest.norm();
    if (left <= tolerance() * size) break;
    const double wanted = std::min(0.5, tolerance() * size / left);
    VectorX more = VectorX::Zero(b.size());
    std::optional<VectorX> found = solve_with_near(rest, wanted);
    const bool is_near_enough = found.has_value();
    if (found) {
      more = *std::move(found);
    } else {
      report = solver_->solve(free_, rest, more, wanted);
      if (report.status == LinearReport::Status::indefinite && is_sequence_) {
        factorize_indefinite();
        more.setZero();
        report = solver_->solve(free_, rest, more, wanted);
      }
    }
    p += more;
    multiply(free_, p, product);
    rest = b - product;
    if (is_near_enough || report.status == LinearReport::Status::indefinite) break;
  }
  const double left = rest.norm() / size;
  if (!(left <= largest_residual))
    throw InputError(world_.place, "a linear solve to a residual of " + format_short(largest_residual),
                     format_short(left),
                     "the body is near a limit point, or solver.kind = \"" + solver_kind_ +
                         "\" is too weak: take \"auto\"");
  if (earlier != nullptr) earlier->take(p);
  return p;
}

/// C^T b at the free unknowns (linear/dependents.hpp).
void Tangent::reduce(VectorX& b) const {
  if (world_.constraints) world_.dependents()->add_forces(b);
  set_fixed_to_zero(world_.is_fixed, b);
}

/// C p, p zero at the fixed unknowns.
VectorX Tangent::followed(VectorX p) const {
  if (world_.constraints) world_.dependents()->follow(p);
  return p;
}

VectorX Tangent::solve_symmetric_part(VectorX b) {
  reduce(b);
  return followed(solve_symmetric(b));
}

/// With the symmetric part as preconditioner.
VectorX Tangent::solve(VectorX b, bool is_transposed, EarlierSolutions* earlier) {
  reduce(b);
  if (is_symmetric()) return followed(solve_symmetric(b, earlier));
  const auto product = [&](const VectorX& p) {
    VectorX forces = times(followed(p), is_transposed);
    reduce(forces);
    return forces;
  };
  const auto precondition = [this](const VectorX& r) { return solve_symmetric(r); };
  GmresReport report = gmres(product, b, tolerance(), most_skew_iterations, precondition);
  if (!(report.left <= largest_residual))
    throw InputError(
        world_.place, "an invertible stiffness matrix",
        "one with a too large nonsymmetric part, from friction or a follower pressure on an open surface",
        "use a smaller coefficient or pressure");
  // Impulses of stiff barriers magnify what is left, and the iteration knows it by its own sums alone.
  if (tolerance() <= tight_tolerance)
    report.x += gmres(product, b - product(report.x), refinement, most_skew_iterations, precondition).x;
  return followed(std::move(report.x));
}

}  // namespace resilin
