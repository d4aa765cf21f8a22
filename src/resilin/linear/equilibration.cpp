#include "resilin/linear/equilibration.hpp"

#include <algorithm>
#include <cmath>

namespace resilin {
namespace {

/// Calls visit(row, column, value) for the entries of the blocks on and above the diagonal.
template <class Values, class Visit>
void for_each_entry(const MergedPattern& pattern, int dim, Values& values, const Visit& visit) {
  for (Index i = 0; i < pattern.num_nodes(); ++i)
    for (Offset slot = pattern.row_begin[i]; slot < pattern.row_begin[i + 1]; ++slot)
      for (int r = 0; r < dim; ++r)
        for (int c = 0; c < dim; ++c)
          visit(i * dim + r, pattern.columns[slot] * dim + c, values[(slot * dim + r) * dim + c]);
}

}  // namespace

std::vector<double> equilibrate(const MergedPattern& pattern, int dim, std::vector<double>& values) {
  constexpr int max_rounds = 30;
  constexpr double near_one = 2;
  const auto num_unknowns = static_cast<std::size_t>(pattern.num_nodes()) * static_cast<std::size_t>(dim);
  std::vector<double> scales(num_unknowns, 1.0), largest(num_unknowns);
  bool is_even = false;
  for (int round = 0; round < max_rounds && !is_even; ++round) {
    std::ranges::fill(largest, 0.0);
    for_each_entry(pattern, dim, values, [&](Index i, Index j, double value) {
      const double size = std::abs(value) * scales[i] * scales[j];
      largest[i] = std::max(largest[i], size);
      largest[j] = std::max(largest[j], size);
    });
    is_even = true;
    for (std::size_t k = 0; k < num_unknowns; ++k) {
      if (largest[k] == 0 || !std::isfinite(largest[k])) continue;
      is_even = is_even && largest[k] <= near_one && largest[k] * near_one >= 1;
      scales[k] /= std::sqrt(largest[k]);
    }
  }
  for (double& scale : scales) scale = std::exp2(std::round(std::log2(scale)));
  for_each_entry(pattern, dim, values,
                 [&](Index i, Index j, double& value) { value *= scales[i] * scales[j]; });
  return scales;
}

}  // namespace resilin
