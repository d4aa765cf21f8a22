#include <algorithm>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fit/constrained_fit.hpp"
#include "resilin/fit/law_fit.hpp"

namespace resilin {
namespace {

constexpr int num_stable_states = 33;  ///< along the data of a mode
constexpr std::size_t most_bounded_starts = 5;
/// Starts for compressible laws.
constexpr double poissons_ratios[] = {0.2, 0.4, 0.48, 0.499, 0.49995};

/// States at which stability is required: along the data of each mode, from rest on.
FitLimits limits_of(const FitDescription& description) {
  FitLimits limits;
  if (description.stability != StabilityRule::required) return limits;
  for (const TestMode mode : {TestMode::uniaxial, TestMode::equibiaxial, TestMode::planar,
                              TestMode::simple_shear, TestMode::volumetric, TestMode::confined}) {
    double least = rest_load(mode), most = least;
    for (const MaterialTest& test : description.tests) {
      if (test.mode != mode) continue;
      const auto [low, high] = std::ranges::minmax_element(test.load);
      least = std::min(least, *low);
      most = std::max(most, *high);
    }
    for (const double end : {least, most}) {
      if (end == rest_load(mode)) continue;
      const std::vector<LoadedState> states = states_between(mode, rest_load(mode), end, num_stable_states);
      limits.stable_states.insert(limits.stable_states.end(), states.begin(), states.end());
    }
  }
  return limits;
}

/// A solid of the modulus that the data show.
std::vector<double> plain_constants(const LawChoice& choice, double shear_modulus, double poissons_ratio) {
  const LawInfo& law = *choice.law;
  if (!std::isnan(law.only_poissons_ratio)) poissons_ratio = law.only_poissons_ratio;
  std::vector<double> constants =
      law.constants_from(hooke_from_young_poisson(2 * (1 + poissons_ratio) * shear_modulus, poissons_ratio));
  const std::vector<int> fitted = choice.fitted();
  for (int p = 0; p < static_cast<int>(constants.size()); ++p)
    if (std::ranges::find(fitted, p) == fitted.end())
      constants[static_cast<std::size_t>(p)] = choice.constants[static_cast<std::size_t>(p)];
  return constants;
}

FitPoint point_at(const LawProblem& problem, const std::vector<double>& constants) {
  FitPoint point;
  problem.unknowns(constants, point.c, point.v);
  point.sum = std::numeric_limits<double>::infinity();
  return point;
}

/// Constants of the same law in its incompressible limit, where it has one: the points that keep their
/// volume.
std::vector<std::vector<double>> isochoric_constants(const LawChoice& choice, const FitData& data,
                                                     const FitDescription& description) {
  std::vector<std::vector<double>> found;
  if (choice.volume_constant < 0 || choice.law->is_quadratic) return found;
  LawChoice limit = choose_law(choice.name, false, description.place);
  std::vector<LoadedState> states;
  std::vector<double> measured, weights;
  for (std::size_t i = 0; i < data.states.size(); ++i)
    if (keeps_volume(data.states[i].mode)) {
      states.push_back(data.states[i]);
      measured.push_back(data.measured[static_cast<Eigen::Index>(i)]);
      weights.push_back(data.weights[static_cast<Eigen::Index>(i)]);
    }
  const auto count = static_cast<Eigen::Index>(states.size());
  if (count < static_cast<Eigen::Index>(limit.fitted().size())) return found;
  const HomogeneousModel model(*limit.law, false, states);
  const LawProblem problem(limit, model, Eigen::Map<const VectorX>(measured.data(), count),
                           Eigen::Map<const VectorX>(weights.data(), count), data.stress_scale,
                           description.constants);
  std::vector<FitPoint> ends = fit_from_many_starts(problem);
  if (ends.size() > 2) ends.resize(2);
  for (const FitPoint& end : ends) found.push_back(problem.constants(end.c, end.v));
  return found;
}

/// Places to start from where the stretch of the sides is sought as well.
std::vector<VectorX> compressible_starts(const LawProblem& problem, const FitData& data,
                                         const FitDescription& description) {
  const LawChoice& choice = problem.choice();
  std::vector<VectorX> starts;
  const auto add = [&](const std::vector<double>& constants) {
    VectorX c, v;
    problem.unknowns(constants, c, v);
    if (v.allFinite()) starts.push_back(v);
  };
  const std::vector<std::vector<double>> limits = isochoric_constants(choice, data, description);
  for (const double poissons_ratio : poissons_ratios) {
    const std::vector<double> plain = plain_constants(choice, data.shear_modulus, poissons_ratio);
    add(plain);
    for (std::vector<double> constants : limits) {
      const auto place = static_cast<std::size_t>(choice.volume_constant);
      constants[place] = plain[place];
      add(constants);
    }
  }
  return starts;
}

std::vector<FitPoint> free_optima(const LawProblem& problem, const FitData& data,
                                  const FitDescription& description) {
  if (!problem.choice().is_compressible) return fit_from_many_starts(problem);
  std::vector<FitPoint> ends;
  for (const VectorX& start : compressible_starts(problem, data, description)) {
    FitPoint end;
    if (fit_separably(problem, start, end)) ends.push_back(end);
  }
  std::ranges::stable_sort(ends, {}, &FitPoint::sum);
  return ends;
}

/// The best point within the limits that the searches find.
std::optional<BoundedPoint> best_within_limits(const LawProblem& problem, const FitLimits& limits,
                                               const std::vector<FitPoint>& free, const FitData& data) {
  std::optional<BoundedPoint> best;
  const auto consider = [&](const BoundedPoint& point) {
    if (!best || point.sum < best->sum) best = point;
  };
  for (const FitPoint& point : free)
    if (keeps_limits(problem, limits, point)) {
      BoundedPoint kept;
      static_cast<FitPoint&>(kept) = point;
      kept.reached.resize(0, point.c.size() + point.v.size());
      consider(kept);
      break;  // they are sorted
    }
  std::vector<FitPoint> starts(
      free.begin(), free.begin() + static_cast<std::ptrdiff_t>(std::min(free.size(), most_bounded_starts)));
  starts.push_back(point_at(problem, plain_constants(problem.choice(), data.shear_modulus, 0.49)));
  for (const FitPoint& start : starts) {
    BoundedPoint point;
    if (fit_within_limits(problem, limits, start, point)) consider(point);
  }
  return best;
}

/// Rows by (c, v) as rows by the constants in units of the problem, in the order of the formula.
DenseMatrix by_constants(const LawProblem& problem, const BoundedPoint& point) {
  const LawChoice& choice = problem.choice();
  const std::vector<int> fitted = choice.fitted();
  DenseMatrix rows(point.reached.rows(), static_cast<Eigen::Index>(fitted.size()));
  const auto column_of = [&](int place) {
    return static_cast<Eigen::Index>(std::ranges::find(fitted, place) - fitted.begin());
  };
  for (Eigen::Index i = 0; i < problem.num_linear(); ++i)
    rows.col(column_of(choice.linear[static_cast<std::size_t>(i)])) = point.reached.col(i);
  for (Eigen::Index i = 0; i < problem.num_nonlinear(); ++i)
    rows.col(column_of(choice.nonlinear[static_cast<std::size_t>(i)])) =
        point.reached.col(problem.num_linear() + i);
  return rows;
}

/// Optima whose likelihood is within a 95 % region of the best (n ln(sum / best) < chi^2 of one number), at
/// other constants.
std::vector<std::vector<double>> rivals_of(const LawProblem& problem, const std::vector<FitPoint>& ends,
                                           const LawChoice& choice) {
  constexpr double chi_square_95 = 3.841;
  const FitPoint& best = ends.front();
  const double most = best.sum * std::exp(chi_square_95 / static_cast<double>(problem.num_rows()));
  std::vector<std::vector<double>> different;
  const auto sorted_constants = [&](const FitPoint& point) {
    std::vector<double> constants = problem.constants(point.c, point.v);
    sort_terms(choice, constants);
    return constants;
  };
  // A bulk modulus of a thousand times the stresses is as good as any larger one.
  const double as_good_as_infinite = 1e3 * problem.stress_scale();
  const auto is_near = [&](const std::vector<double>& a, const std::vector<double>& b) {
    for (std::size_t p = 0; p < a.size(); ++p) {
      const bool is_volume = static_cast<int>(p) == choice.volume_constant;
      if (is_volume && std::min(a[p], b[p]) > as_good_as_infinite) continue;
      if (std::abs(a[p] - b[p]) > 0.02 * std::max(std::abs(a[p]), std::abs(b[p]))) return false;
    }
    return true;
  };
  std::vector<std::vector<double>> seen = {sorted_constants(best)};
  for (const FitPoint& end : ends) {
    if (!(end.sum <= most)) break;
    std::vector<double> constants = sorted_constants(end);
    if (std::ranges::any_of(seen, [&](const auto& other) { return is_near(other, constants); })) continue;
    seen.push_back(constants);
    different.push_back(std::move(constants));
  }
  return different;
}

}  // namespace

SearchResult search_constants(const LawChoice& choice, const FitData& data,
                              const FitDescription& description) {
  const HomogeneousModel model(*choice.law, choice.is_compressible, data.states);
  const LawProblem problem(choice, model, data.measured, data.weights, data.stress_scale,
                           description.constants);
  const std::vector<FitPoint> free = free_optima(problem, data, description);
  if (free.empty())
    throw InputError(description.place,
                     choice.name + ": no constants within its range say anything about all points",
                     "is a stretch mistyped?");
  const FitLimits limits = limits_of(description);
  SearchResult result;
  result.reached.resize(0, static_cast<Eigen::Index>(choice.fitted().size()));
  const FitPoint& best = free.front();
  if (keeps_limits(problem, limits, best)) {
    result.rivals = rivals_of(problem, free, choice);
    result.constants = problem.constants(best.c, best.v);
    result.sum = best.sum;
    return result;
  }
  const std::optional<BoundedPoint> bounded = best_within_limits(problem, limits, free, data);
  if (!bounded)
    throw InputError(description.place, "constants of " + choice.name + " that are stable over the data",
                     "none", "set stability = \"report\" to see the free ones, or take another law");
  result.constants = problem.constants(bounded->c, bounded->v);
  result.sum = bounded->sum;
  result.reached = by_constants(problem, *bounded);
  result.is_held_by_stability = bounded->is_held_by_stability;
  result.is_held_by_range = bounded->is_held_by_range;
  result.free_constants = problem.constants(best.c, best.v);
  result.free_sum = best.sum;
  return result;
}

}  // namespace resilin
