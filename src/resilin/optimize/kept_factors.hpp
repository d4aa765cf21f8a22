#pragma once

#include <algorithm>
#include <cmath>

namespace resilin {

/// Whether factors of one matrix are worth trying as the preconditioner of those that follow in a search: a
/// factorisation costs some 15 iterations of conjugate gradients.
class KeptFactors {
 public:
  bool may_serve() const { return may_serve_; }
  /// The matrices that follow are others.
  void leave() { may_serve_ = false; }
  /// They were made, and solved with their own matrix to this tolerance.
  void made(int iterations, double tolerance) {
    iterations_ = iterations;
    iterations_per_digit_ = iterations / digits(tolerance);
    may_serve_ = !have_failed_;
  }
  /// They have been tried for a later matrix.
  void tried(bool is_solved, int iterations, double tolerance) {
    have_failed_ |= !is_solved;
    iterations_ += iterations;
    const double as_own = iterations_per_digit_ * digits(tolerance);
    may_serve_ = is_solved && iterations <= as_own + most_more && iterations_ <= most_iterations;
  }

 private:
  static constexpr double most_more = 6;      ///< iterations more than with factors of the matrix itself
  static constexpr int most_iterations = 40;  ///< sum over all matrices that they serve
  static double digits(double tolerance) { return std::max(1.0, -std::log10(tolerance)); }

  bool may_serve_ = false, have_failed_ = false;
  int iterations_ = 0;
  double iterations_per_digit_ = 0;
};

}  // namespace resilin
