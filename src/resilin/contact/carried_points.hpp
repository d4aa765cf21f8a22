#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/energy/energy.hpp"

namespace resilin {

/// Adds to the weight of a node, each of which is listed once.
inline void add_weight(Index node, double weight, std::vector<WeightedNode>& nodes) {
  const auto found = std::ranges::find(nodes, node, &WeightedNode::node);
  if (found == nodes.end()) {
    nodes.push_back({node, weight});
  } else {
    found->weight += weight;
  }
}

/// Points that follow nodes by a fixed linear map:
///
///   x_p = sum_k shares_k x_(nodes_k)
///
/// A node by itself has the share 1. Shares may be negative: quadratic shape functions are, and linear ones
/// outside their cell.
struct CarriedPoints {
  std::vector<std::size_t> row_begin{0};  ///< first entry of each point, in `nodes` and `shares`, and the end
  std::vector<Index> nodes;               ///< nodes of a point each once
  std::vector<double> shares;

  Index num_points() const { return static_cast<Index>(row_begin.size()) - 1; }
  std::span<const Index> nodes_of(Index point) const {
    return std::span(nodes).subspan(begin(point), end(point) - begin(point));
  }
  std::vector<WeightedNode> weighted_nodes(Index point) const {
    std::vector<WeightedNode> all;
    for_each_node(point, [&](Index node, double share) { all.push_back({node, share}); });
    return all;
  }
  /// Ends the row of a point that has been appended to `nodes` and `shares`. @return its number
  Index end_row() {
    row_begin.push_back(nodes.size());
    return num_points() - 1;
  }
  Index add_node(Index node) {
    nodes.push_back(node);
    shares.push_back(1);
    return end_row();
  }

  /// Where a point is when nodes are at x, dim numbers each; likewise its way for theirs.
  Vector3 at(int dim, Index point, const VectorX& x) const {
    Vector3 sum = Vector3::Zero();
    for (std::size_t k = begin(point); k < end(point); ++k)
      for (int i = 0; i < dim; ++i) sum[i] += shares[k] * x[Eigen::Index{nodes[k]} * dim + i];
    return sum;
  }
  /// All of them.
  VectorX places(int dim, const VectorX& x) const {
    VectorX all(Eigen::Index{num_points()} * dim);
    for (Index point = 0; point < num_points(); ++point)
      all.segment(Eigen::Index{point} * dim, dim) = at(dim, point, x).head(dim);
    return all;
  }
  /// Adds what acts on a point to what acts on the nodes.
  void add_to_nodes(int dim, Index point, const Vector3& of_point, VectorX& of_nodes) const {
    for (std::size_t k = begin(point); k < end(point); ++k)
      for (int i = 0; i < dim; ++i) of_nodes[Eigen::Index{nodes[k]} * dim + i] += shares[k] * of_point[i];
  }
  /// The same of magnitudes.
  void add_magnitude_to_nodes(int dim, Index point, const Vector3& of_point, VectorX& of_nodes) const {
    for (std::size_t k = begin(point); k < end(point); ++k)
      for (int i = 0; i < dim; ++i)
        of_nodes[Eigen::Index{nodes[k]} * dim + i] += std::abs(shares[k]) * of_point[i];
  }

  /// Calls `visit(node, share)` for the nodes that a point follows.
  template <class Visit>
  void for_each_node(Index point, const Visit& visit) const {
    for (std::size_t k = begin(point); k < end(point); ++k) visit(nodes[k], shares[k]);
  }
  /// Calls `visit(a, b, share_a share_b)` for the nodes that two points follow.
  template <class Visit>
  void for_each_pair_of_nodes(Index p, Index q, const Visit& visit) const {
    for_each_node(p, [&](Index a, double share_a) {
      for_each_node(q, [&](Index b, double share_b) { visit(a, b, share_a * share_b); });
    });
  }

 private:
  std::size_t begin(Index point) const { return row_begin[static_cast<std::size_t>(point)]; }
  std::size_t end(Index point) const { return row_begin[static_cast<std::size_t>(point) + 1]; }
};

}  // namespace resilin
