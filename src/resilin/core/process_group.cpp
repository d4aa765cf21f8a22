#include "resilin/core/process_group.hpp"

#include <cmath>

namespace resilin {

double ProcessGroup::owned_dot(const VectorX& a, const VectorX& b) const {
  const std::span<const std::uint8_t> owned = exchange_->owned();
  if (owned.empty()) return 0;
  const Eigen::Index dim = a.size() / static_cast<Eigen::Index>(owned.size());
  double sum = 0;
  for (std::size_t node = 0; node < owned.size(); ++node)
    if (owned[node] != 0) {
      const Eigen::Index first = static_cast<Eigen::Index>(node) * dim;
      sum += a.segment(first, dim).dot(b.segment(first, dim));
    }
  return sum;
}

double ProcessGroup::norm(const VectorX& a) const {
  return is_whole() ? a.norm() : std::sqrt(sum(owned_dot(a, a)));
}

}  // namespace resilin
