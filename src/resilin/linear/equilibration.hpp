#pragma once

#include <vector>

#include "resilin/linear/merged_pattern.hpp"

namespace resilin {

/// Scales s by unknown such that the largest entry of every row of diag(s) A diag(s) is about one, and scales
/// the blocks of A by them. Powers of two: nothing is rounded. Rows of zeros keep theirs.
///
/// Source: Ruiz 2001.
std::vector<double> equilibrate(const MergedPattern& pattern, int dim, std::vector<double>& values);

}  // namespace resilin
