#pragma once

#include <algorithm>
#include <span>
#include <vector>

namespace resilin {

/// How much of what it forms anew a fixed-point iteration takes, by its last two changes: Aitken's rule
/// (Irons & Tuck 1969, "A version of the Aitken accelerator for computer iteration"). All of it where that
/// settles, less where it is thrown to and fro, and more than all where it leads on in one direction.
class Relaxation {
 public:
  /// @param change  of what was in use to what was formed with it: as many numbers as the last time, or more,
  ///                where the last change of those that are new was none
  /// @return the share of the change to take; 1 at first
  double next_share(std::span<const double> change) {
    if (!last_change_.empty()) {
      last_change_.resize(change.size(), 0.0);
      double last = 0, now = 0, both = 0;
      for (std::size_t i = 0; i < change.size(); ++i) {
        last += last_change_[i] * last_change_[i];
        now += change[i] * change[i];
        both += last_change_[i] * change[i];
      }
      const double turn = last - 2 * both + now;
      const double share = turn > 0 ? share_ * (last - both) / turn : 0;
      if (share > 0) {
        share_ = std::clamp(share, least_share, most_share);
      } else if (now > slow_growth * slow_growth * last) {
        share_ = std::max(shrunk_share * share_, least_share);
      } else if (now > 0) {
        share_ = std::min(2 * share_, most_share);
      }
    }
    last_change_.assign(change.begin(), change.end());
    return share_;
  }

 private:
  static constexpr double least_share = 2e-3, most_share = 2;
  /// Changes that grow in their own direction: by less than this, twice the last share is next, else 0.3 of
  /// it.
  static constexpr double slow_growth = 1.2;
  static constexpr double shrunk_share = 0.3;

  double share_ = 1;
  std::vector<double> last_change_;
};

}  // namespace resilin
