#include "resilin/results/moment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "resilin/core/text.hpp"

namespace resilin {
std::string words_of_moment(const World& world, const State& state) {
  if (world.modes) return {};
  if (world.is_dynamic) return format_short(state.time) + " s";
  return state.load == 1 ? "" : "load " + format_short(state.load);
}

MomentsOfFrames::MomentsOfFrames(std::vector<double> times, std::vector<double> loads)
    : times_(std::move(times)), loads_(std::move(loads)) {
  is_motion_ = !times_.empty() && times_.back() > times_.front();
  if (!is_motion_) return;
  const double begin = times_.front(), end = times_.back();
  struct Scale {
    double from, factor;
    const char* unit;
  };
  for (const Scale& scale : {Scale{1e-1, 1, "s"}, {1e-4, 1e3, "ms"}, {0, 1e6, "\xC2\xB5s"}}) {
    if (end < scale.from) continue;
    factor_ = scale.factor;
    unit_ = scale.unit;
    break;
  }
  const double apart = (end - begin) / static_cast<double>(times_.size() - 1);
  const auto is_told = [&](double time) {
    const double power = std::pow(10, decimals_), shown = std::round(time * factor_ * power) / power;
    return std::abs(shown - factor_ * time) <= 0.1 * factor_ * apart;
  };
  for (decimals_ = 0; decimals_ < 6 && !std::ranges::all_of(times_, is_told);) ++decimals_;
}

std::string MomentsOfFrames::words(std::size_t frame) const {
  if (frame >= times_.size()) return {};
  return is_motion_ ? format_fixed(factor_ * times_[frame], decimals_) + " " + unit_
                    : "load " + format_fixed(loads_[frame], decimals_);
}

}  // namespace resilin
