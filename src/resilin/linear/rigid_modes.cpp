#include "resilin/linear/rigid_modes.hpp"

#include <cmath>

#include "resilin/core/parallel.hpp"
#include "resilin/core/rigid_motions.hpp"

namespace resilin {

Modes rigid_modes(int dim, const VectorX& positions, std::span<const std::uint8_t> is_fixed) {
  const auto num_nodes = static_cast<Index>(is_fixed.size()) / dim;
  Modes modes{.size = dim, .count = dim == 3 ? 6 : 3, .values = {}};
  modes.values.assign(static_cast<std::size_t>(num_nodes) * dim * modes.count, 0.0);
  const bool has_positions = positions.size() > 0;
  const auto position = [&](Index i) {
    return has_positions
               ? Vector3(positions[i * dim], positions[i * dim + 1], dim == 3 ? positions[i * dim + 2] : 0)
               : Vector3(0, 0, 0);
  };
  Vector3 center = Vector3::Zero();
  for (Index i = 0; i < num_nodes; ++i) center += position(i) / num_nodes;
  double radius = 0;
  for (Index i = 0; i < num_nodes; ++i) radius = std::max(radius, (position(i) - center).norm());
  constexpr std::size_t nodes_per_chunk = 2048;
  parallel_for(
      static_cast<std::size_t>(num_nodes), nodes_per_chunk, [&](std::size_t first, std::size_t last) {
        for (auto i = static_cast<Index>(first); i < static_cast<Index>(last); ++i) {
          Eigen::Map<Eigen::Matrix<double, -1, -1, Eigen::RowMajor>> mode(modes.of(i), dim, modes.count);
          mode = rigid_motions(dim, radius > 0 ? Vector3((position(i) - center) / radius) : Vector3(0, 0, 0));
          for (int d = 0; d < dim; ++d)
            if (is_fixed[i * dim + d] != 0) mode.row(d).setZero();
        }
      });
  return modes;
}

namespace {

using Block = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;

/// Fills what `result` says of one group, by Gram and Schmidt. @param Q  memory
void orthonormalize(const Modes& modes, const std::vector<Index>& nodes, Index group, Eigen::MatrixXd& Q,
                    TentativeProlongation& result) {
  constexpr double least_norm = 1e-8;  // of the column before: what is left is round-off
  const int count = modes.count;
  Q.resize(static_cast<Offset>(nodes.size()) * modes.size, count);
  for (std::size_t k = 0; k < nodes.size(); ++k)
    Q.middleRows(static_cast<Offset>(k) * modes.size, modes.size) =
        Eigen::Map<const Block>(modes.of(nodes[k]), modes.size, count);
  Eigen::Map<Block> R(result.coarse.of(group), count, count);
  for (int c = 0; c < count; ++c) {
    const double norm_before = Q.col(c).norm();
    for (int pass = 0; pass < 2; ++pass)  // twice is enough
      for (int k = 0; k < c; ++k) {
        const double part = Q.col(k).dot(Q.col(c));
        R(k, c) += part;
        Q.col(c) -= part * Q.col(k);
      }
    const double norm = Q.col(c).norm();
    if (norm > least_norm * norm_before) {
      R(c, c) = norm;
      Q.col(c) /= norm;
    } else {
      Q.col(c).setZero();
      result.is_absent[group * count + c] = 1;
    }
  }
  for (std::size_t k = 0; k < nodes.size(); ++k)
    Eigen::Map<Block>(result.fine.of(nodes[k]), modes.size, count) =
        Q.middleRows(static_cast<Offset>(k) * modes.size, modes.size);
}

}  // namespace

TentativeProlongation orthonormalize(const Modes& modes, const Aggregates& groups) {
  constexpr std::size_t groups_per_chunk = 32;
  const int count = modes.count;
  TentativeProlongation result;
  result.fine = {modes.size, count, std::vector<double>(modes.values.size(), 0.0)};
  result.coarse = {count, count,
                   std::vector<double>(static_cast<std::size_t>(groups.count) * count * count, 0.0)};
  result.is_absent.assign(static_cast<std::size_t>(groups.count) * count, 0);

  std::vector<std::vector<Index>> members(static_cast<std::size_t>(groups.count));
  for (Index i = 0; i < static_cast<Index>(groups.of_node.size()); ++i)
    if (groups.of_node[i] >= 0) members[groups.of_node[i]].push_back(i);
  parallel_for(members.size(), groups_per_chunk, [&](std::size_t first, std::size_t last) {
    Eigen::MatrixXd Q;
    for (std::size_t group = first; group < last; ++group)
      orthonormalize(modes, members[group], static_cast<Index>(group), Q, result);
  });
  return result;
}

}  // namespace resilin
