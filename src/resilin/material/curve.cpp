#include "resilin/material/curve.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/material/curve_state.hpp"

namespace resilin {
namespace {

constexpr std::array<std::string_view, 5> load_case_names = {"uniaxial", "equibiaxial", "planar", "shear",
                                                             "volumetric"};
constexpr std::array<std::string_view, 5> stability_names = {"stable", "stress_drops", "directions_part",
                                                             "not_elliptic", "no_state"};
constexpr double largest_step = 0.02;   ///< largest step of the load, relative
constexpr double smallest_step = 1e-7;  ///< where a branch ends or becomes unstable is known to this
constexpr double largest_change =
    0.2;  ///< largest change of a free stretch in one step: more is a jump to another branch

using State = LoadedBlock::State;

/// One side of a curve, followed from rest.
class Branch {
 public:
  Branch(const LoadedBlock& block, bool above)
      : block_(block), above_(above), state_(block.rest()), step_(largest_step) {
    if (const Stability loss = block_.stability(state_); loss != Stability::stable) lose(loss, state_);
  }

  /// Goes on to `load`; nothing when the branch ends before.
  std::optional<State> follow(double load) {
    while (state_.load != load && !ended_) {
      const double step = step_ * size(state_.load), left = std::abs(load - state_.load);
      const double target = left <= step ? load : state_.load + (above_ ? step : -step);
      const std::optional<State> next = neighbour(target);
      if (next) {
        if (limits_.empty()) look_for_loss(*next);
        state_ = *next;
        step_ = std::min(largest_step, 2 * step_);
      } else if (std::min(step, left) <= smallest_step * size(state_.load)) {
        ended_ = true;
        lose(Stability::no_state, state_);
      } else {
        step_ = 0.5 * std::min(step, left) / size(state_.load);
      }
    }
    if (ended_) return std::nullopt;
    return state_;
  }

  /// Where it becomes unstable, and where it ends.
  const std::vector<StabilityLimit>& limits() const { return limits_; }

 private:
  double size(double load) const {
    return block_.rest_load() == 0 ? std::max(1.0, std::abs(load)) : std::abs(load);
  }

  /// The state at `load` when it is near the present one.
  std::optional<State> neighbour(double load) const {
    std::optional<State> next = block_.solve(load, state_);
    if (!next) return std::nullopt;
    for (Eigen::Index k = 0; k < next->free.size(); ++k)
      if (std::abs(next->free[k] - state_.free[k]) > largest_change * (1 + state_.free[k]))
        return std::nullopt;
    return next;
  }

  /// Bisects between the present state, which is stable, and `next`.
  void look_for_loss(const State& next) {
    Stability loss = block_.stability(next);
    if (loss == Stability::stable) return;
    State stable = state_;
    double unstable = next.load;
    while (std::abs(unstable - stable.load) > smallest_step * size(stable.load)) {
      const double middle = 0.5 * (stable.load + unstable);
      const std::optional<State> state = block_.solve(middle, stable);
      const Stability here = state ? block_.stability(*state) : Stability::no_state;
      if (here == Stability::stable) {
        stable = *state;
      } else {
        unstable = middle;
        loss = here;
      }
    }
    lose(loss, stable);
  }

  void lose(Stability loss, const State& last) {
    limits_.push_back({loss, above_, last.load, block_.volume_ratio(last)});
  }

  const LoadedBlock& block_;
  bool above_;
  State state_;
  double step_;
  bool ended_ = false;
  std::vector<StabilityLimit> limits_;
};

void check_stretches(LoadCase load_case, std::span<const double> stretches) {
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const bool is_right = std::isfinite(stretches[i]) && (load_case == LoadCase::shear || stretches[i] > 0);
    if (!is_right)
      throw InputError("stretches[" + std::to_string(i) + "]",
                       load_case == LoadCase::shear ? "a finite amount of shear" : "a stretch above 0",
                       format_number(stretches[i]));
  }
}

StretchCurve empty_curve(LoadCase load_case, std::span<const double> stretches) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::size_t count = stretches.size();
  const std::vector<double> undefined(count, nan);
  return {load_case,
          {stretches.begin(), stretches.end()},
          std::vector<Vector3>(count, Vector3::Constant(nan)),
          undefined,
          undefined,
          undefined,
          undefined,
          std::vector<Stability>(count, Stability::no_state),
          {}};
}

void fill(StretchCurve& curve, std::size_t i, const LoadedBlock& block, const State& state) {
  curve.stretches[i] = block.stretches(state);
  curve.nominal_stress[i] = block.nominal_stress(state);
  curve.cauchy_stress[i] = block.cauchy_stress(state);
  curve.energy_density[i] = block.energy_density(state);
  curve.volume_ratio[i] = block.volume_ratio(state);
  curve.stability[i] = block.stability(state);
}

std::string loss_text(Stability loss, LoadCase load_case) {
  switch (loss) {
    case Stability::stress_drops:
      return load_case == LoadCase::volumetric ? "the volumetric stress drops" : "the nominal stress drops";
    case Stability::directions_part:
      return "unequal stretches cost less energy";
    case Stability::not_elliptic:
      return "waves along an edge lose their speed (no ellipticity)";
    case Stability::no_state:
      return "there is no state";
    case Stability::stable:
      break;
  }
  return "stable";
}

std::string six_digits(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.begin(), text.end(), value, std::chars_format::general, 6).ptr;
  return {text.begin(), end};
}

std::string limit_text(const StabilityLimit& limit, LoadCase load_case) {
  std::string text = loss_text(limit.loss, load_case) + (limit.above ? " beyond " : " below ") +
                     (load_case == LoadCase::shear ? "an amount of shear of " : "stretch ") +
                     six_digits(limit.stretch);
  if (limit.loss != Stability::no_state) text += " (volume ratio " + six_digits(limit.volume_ratio) + ")";
  return text;
}

}  // namespace

std::string_view name(LoadCase load_case) { return load_case_names[static_cast<std::size_t>(load_case)]; }

std::string_view name(Stability stability) { return stability_names[static_cast<std::size_t>(stability)]; }

LoadCase require_load_case(std::string_view name, const std::string& place) {
  const auto found = std::ranges::find(load_case_names, name);
  if (found != load_case_names.end()) return static_cast<LoadCase>(found - load_case_names.begin());
  const std::vector<std::string> names(load_case_names.begin(), load_case_names.end());
  refuse_word(place, name, names);
}

LoadRange usual_range(LoadCase load_case) {
  return load_case == LoadCase::shear ? LoadRange{0, 1.5} : LoadRange{0.5, 2};
}

StretchCurve stretch_curve(const Material& material, LoadCase load_case, std::span<const double> stretches) {
  check_stretches(load_case, stretches);
  StretchCurve curve = empty_curve(load_case, stretches);
  const LoadedBlock block(material, load_case);
  std::vector<std::size_t> order(stretches.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return stretches[i]; });
  const auto rest =
      std::ranges::partition_point(order, [&](std::size_t i) { return stretches[i] < block.rest_load(); });

  Branch below(block, false), above(block, true);
  for (auto i = rest; i != order.begin();) {
    --i;
    if (const auto state = below.follow(stretches[*i])) fill(curve, *i, block, *state);
  }
  for (auto i = rest; i != order.end(); ++i)
    if (const auto state = above.follow(stretches[*i])) fill(curve, *i, block, *state);
  for (const Branch* branch : {&below, &above})
    curve.limits.insert(curve.limits.end(), branch->limits().begin(), branch->limits().end());
  return curve;
}

std::string stability_text(const Material& material, const StretchCurve& curve) {
  std::string text;
  for (const StabilityLimit& limit : curve.limits)
    text += (text.empty() ? std::string(material.law->name) + ", " + std::string(name(curve.load_case)) + ": "
                          : "; ") +
            limit_text(limit, curve.load_case);
  return text;
}

std::string curve_csv(const StretchCurve& curve) {
  std::string text = curve.load_case == LoadCase::shear ? "shear" : "stretch";
  text +=
      ",nominal_stress [Pa],cauchy_stress [Pa],volume_ratio,energy_density [J/m^3],stretch_1,stretch_2,"
      "stretch_3,stability\n";
  for (std::size_t i = 0; i < curve.stretch.size(); ++i) {
    for (const double value :
         {curve.stretch[i], curve.nominal_stress[i], curve.cauchy_stress[i], curve.volume_ratio[i],
          curve.energy_density[i], curve.stretches[i][0], curve.stretches[i][1], curve.stretches[i][2]})
      text.append(std::isnan(value) ? "nan" : format_number(value)).append(",");
    text.append(name(curve.stability[i])).append("\n");
  }
  return text;
}

}  // namespace resilin
