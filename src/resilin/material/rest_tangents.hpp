#pragma once

#include <algorithm>
#include <vector>

#include "resilin/material/batch.hpp"

namespace resilin {

/// Calls `visit(i, A)` with dP/dF at rest, 81 numbers by rows [Pa], for one set of constants after another.
/// @param constants  of the law's formula, in its order, those of one set after another
template <class Visit>
void for_each_rest_tangent(const LawInfo& law, const std::vector<double>& constants, const Visit& visit) {
  constexpr std::size_t most = 4096;  // states at once
  const std::size_t n = law.constants.size(), count = constants.size() / n;
  std::vector<double> columns(constants.size()), H(9 * std::min(count, most), 0.0), A(9 * H.size());
  for (std::size_t i = 0; i < constants.size(); ++i) columns[i % n * count + i / n] = constants[i];
  for (std::size_t first = 0; first < count; first += most) {
    StateBatch<double> states{.law = &law,
                              .dim = 3,
                              .count = std::min(most, count - first),
                              .deformation_gradients = H.data(),
                              .holds_displacement_gradients = true,
                              .constants = {}};
    for (std::size_t k = 0; k < n; ++k) states.constants.push_back({columns.data() + k * count + first, 1});
    stress_tangents(states, Projection::none, A.data());
    for (std::size_t i = 0; i < states.count; ++i) visit(first + i, A.data() + 81 * i);
  }
}

}  // namespace resilin
