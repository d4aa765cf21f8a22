#pragma once

#include <algorithm>

#include "resilin/optimize/objective.hpp"

namespace resilin {

/// Lagged quantities of an objective, updated along a search until the forces balance: a fixed-point
/// iteration around Newton's method.
///
/// It is not worth more digits of a search than the next round keeps: the search goes on with it until a
/// tenth of the residual is left.
class Lag {
 public:
  /// How exactly linear systems of rounds are worth solving at least.
  static constexpr double forcing = 5e-2;

  /// @param most_rounds  so often it may be formed before the search ends
  Lag(Objective& objective, int most_rounds) : objective_(objective), most_rounds_(most_rounds) {}

  int rounds() const { return rounds_; }
  bool is_over() const { return rounds_ >= most_rounds_; }
  /// It is not that of x any more.
  void leave() { is_here_ = false; }
  /// The search is back where it was formed last.
  void come_back() { is_here_ = true; }

  /// Whether the search has done with it as it is what is worth doing.
  /// @param relative_residual  beside the forces that act
  bool is_due(double residual, double relative_residual) const {
    if (is_over() || is_here_) return false;
    return rounds_ == 0 ? relative_residual <= first_goal : residual <= goal_of_round * first_residual_;
  }

  /// Makes it and the gradient those at x. @return whether that changed forces
  bool form(const VectorX& x, VectorX& gradient) {
    if (is_here_) return false;
    is_here_ = true;
    if (!objective_.form_lag(x)) return false;
    objective_.gradient(x, gradient);
    return true;
  }
  /// How much of the gradient forming it has changed.
  void set_share_of_change(double share) { share_of_change_ = share; }

  /// How exactly the first system of a round is worth solving: no more than Newton's method converges, nor
  /// than a further round would change.
  /// @param last_ratio  of the residual after the step before to that before it
  double first_forcing(double last_ratio) const {
    const double worth = std::max(0.9 * last_ratio * last_ratio, left_of_change * share_of_change_);
    return std::clamp(worth, least_forcing, forcing);
  }

  /// Begins a round with what was formed last, or with a share of it. The first change says nothing of how
  /// rounds settle. @return whether that changed forces
  bool begin_round(const VectorX& x, VectorX& gradient) {
    ++rounds_;
    if (rounds_ == 1 || !objective_.relax_lag()) return false;
    is_here_ = false;
    objective_.gradient(x, gradient);
    return true;
  }
  /// From this residual.
  void set_first_residual(double residual) { first_residual_ = residual; }

 private:
  static constexpr double first_goal = 0.1, goal_of_round = 0.1;
  static constexpr double left_of_change = 0.03, least_forcing = 1e-3;
  Objective& objective_;
  int most_rounds_;

  int rounds_ = 0;
  bool is_here_ = false;
  double first_residual_ = 0;
  double share_of_change_ = 1;
};

/// Solves lagged friction and the shape as one system, which has no potential, by Newton's method with the
/// true tangent where rounds are slow to settle, from a place near enough to where they would.
class CoupledLag {
 public:
  bool is_on() const { return is_on_; }
  /// Whether it is worth trying.
  /// @param relative_residual  with what lags as it is here, beside the forces that act
  bool is_due(int rounds, double relative_residual) const {
    return rounds >= next_rounds_ && relative_residual <= largest_residual;
  }
  /// @param has_potential  what to come back to
  void begin(const VectorX& x, double residual, bool has_potential, int rounds) {
    is_on_ = true;
    start_ = x;
    goal_ = residual;
    steps_ = 0;
    had_potential_ = has_potential;
    next_rounds_ = rounds + rounds / 2;
  }
  /// After a step of this length that left this residual. @return whether it comes to nothing
  bool fails(double length, double residual) {
    ++steps_;
    if (steps_ > free_steps) goal_ *= largest_left;
    return !(length >= least_length && residual <= (steps_ > free_steps ? goal_ : most_growth * goal_));
  }
  void end() { is_on_ = false; }
  void give_up() {
    is_on_ = false;
    lost_steps_ += steps_;
  }
  /// Number of discarded steps, which do not count.
  int lost_steps() const { return lost_steps_; }

  const VectorX& start() const { return start_; }
  bool had_potential() const { return had_potential_; }

 private:
  static constexpr double largest_residual = 0.2;
  static constexpr int first_rounds = 6;  ///< are left to themselves; then half as many again
  /// Steps that need not lower the residual, nor raise it much; of those after them each is to leave no more.
  static constexpr int free_steps = 3;
  static constexpr double most_growth = 4, largest_left = 0.7;
  static constexpr double least_length = 0.01;  ///< shorter ones are cut by what meets

  bool is_on_ = false;
  int next_rounds_ = first_rounds;
  VectorX start_{};
  double goal_ = 0;
  int steps_ = 0, lost_steps_ = 0;
  bool had_potential_ = true;
};

}  // namespace resilin
