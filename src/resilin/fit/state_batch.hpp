#pragma once

#include <span>
#include <vector>

#include "resilin/material/batch.hpp"

namespace resilin {

/// States of displacement gradients H, 9 numbers each, row by row, of a law with one set of constants. Both
/// are kept by reference.
inline StateBatch<double> batch_at(const LawInfo& law, std::span<const double> constants,
                                   const std::vector<double>& H) {
  StateBatch<double> batch{.law = &law,
                           .dim = 3,
                           .count = H.size() / 9,
                           .deformation_gradients = H.data(),
                           .holds_displacement_gradients = true,
                           .constants = {}};
  for (const double& constant : constants) batch.constants.push_back({&constant, 0});
  return batch;
}

}  // namespace resilin
