#pragma once

#include <utility>

namespace resilin {

/// For how many nodes of a cell the kernels over quadrature points are compiled. An element with another
/// number adds it here; energy/elastic.cpp does not compile before.
template <int dim>
struct NodeCounts;
template <>
struct NodeCounts<2> {
  using type = std::integer_sequence<int, 4, 6>;
};
template <>
struct NodeCounts<3> {
  using type = std::integer_sequence<int, 8, 10>;
};

template <int... counts>
constexpr bool is_counted(int num_nodes, std::integer_sequence<int, counts...>) {
  return ((num_nodes == counts) || ...);
}

}  // namespace resilin
