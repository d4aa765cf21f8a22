#include "resilin/linear/rigid_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "resilin/core/parallel.hpp"
#include "resilin/core/rigid_motions.hpp"

namespace resilin {
namespace {

using Block = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;

/// The nodes of every group, one group after another.
struct Members {
  std::vector<Index> begin, nodes;

  explicit Members(const Aggregates& groups) : begin(static_cast<std::size_t>(groups.count) + 1, 0) {
    for (const Index group : groups.of_node)
      if (group >= 0) ++begin[group + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    nodes.resize(static_cast<std::size_t>(begin.back()));
    std::vector<Index> next(begin.begin(), begin.end() - 1);
    for (Index i = 0; i < static_cast<Index>(groups.of_node.size()); ++i)
      if (groups.of_node[i] >= 0) nodes[next[groups.of_node[i]]++] = i;
  }
  std::span<const Index> of(std::size_t group) const {
    return std::span(nodes).subspan(static_cast<std::size_t>(begin[group]),
                                    static_cast<std::size_t>(begin[group + 1] - begin[group]));
  }
};

/// Fills what `result` says of one group, by Gram and Schmidt. @param Q, rows  memory
template <class NodeModes>
void orthonormalize_group(const NodeModes& modes, std::span<const Index> nodes, Index group,
                          Eigen::MatrixXd& Q, Block& rows, TentativeProlongation& result) {
  constexpr double least_norm = 1e-8;  // least norm relative to the column before: a smaller one is round-off
  const int size = modes.size, count = modes.count;
  rows.resize(size, count);
  Q.resize(static_cast<Offset>(nodes.size()) * size, count);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    modes.write(nodes[k], rows.data());
    Q.middleRows(static_cast<Offset>(k) * size, size) = rows;
  }
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
    Eigen::Map<Eigen::Matrix<float, -1, -1, Eigen::RowMajor>>(
        result.fine.data() + static_cast<Offset>(nodes[k]) * size * count, size, count) =
        Q.middleRows(static_cast<Offset>(k) * size, size).template cast<float>();
}

template <class NodeModes>
TentativeProlongation orthonormalize_groups(const NodeModes& modes, const Aggregates& groups) {
  constexpr std::size_t groups_per_chunk = 32;
  const auto num_groups = static_cast<std::size_t>(groups.count),
             count = static_cast<std::size_t>(modes.count);
  TentativeProlongation result;
  result.fine.assign(groups.of_node.size() * static_cast<std::size_t>(modes.size) * count, 0.0F);
  result.coarse = {modes.count, modes.count, std::vector<double>(num_groups * count * count, 0.0)};
  result.is_absent.assign(num_groups * count, 0);
  const Members members(groups);
  parallel_for(num_groups, groups_per_chunk, [&](std::size_t first, std::size_t last) {
    Eigen::MatrixXd Q;
    Block rows;
    for (std::size_t group = first; group < last; ++group)
      orthonormalize_group(modes, members.of(group), static_cast<Index>(group), Q, rows, result);
  });
  return result;
}

}  // namespace

RigidModes::RigidModes(int dim, const VectorX& positions, std::span<const std::uint8_t> is_fixed,
                       std::span<const Index> node_at)
    : size(dim), count(dim == 3 ? 6 : 3), positions_(positions), is_fixed_(is_fixed), node_at_(node_at) {
  constexpr std::size_t nodes_per_chunk = 2048;
  struct Sum {
    Vector3 vector = Vector3::Zero();
    Sum& operator+=(const Sum& other) {
      vector += other.vector;
      return *this;
    }
  };
  const auto sum =
      parallel_sum<Sum>(node_at.size(), nodes_per_chunk, [&](std::size_t first, std::size_t last) {
        Sum part;
        for (std::size_t node = first; node < last; ++node) part.vector += position(static_cast<Index>(node));
        return part;
      });
  center_ = sum.vector / num_nodes();
  const auto squares =
      parallel_sum<double>(node_at.size(), nodes_per_chunk, [&](std::size_t first, std::size_t last) {
        double part = 0;
        for (std::size_t node = first; node < last; ++node)
          part += (position(static_cast<Index>(node)) - center_).squaredNorm();
        return part;
      });
  radius_ = std::sqrt(squares / num_nodes());
}

Vector3 RigidModes::position(Index node) const {
  if (positions_.size() == 0) return Vector3::Zero();
  return {positions_[node * size], positions_[node * size + 1], size == 3 ? positions_[node * size + 2] : 0};
}

void RigidModes::write(Index number, double* rows) const {
  const Index node = node_at_[number];
  Eigen::Map<Block> modes(rows, size, count);
  modes = rigid_motions(size, radius_ > 0 ? Vector3((position(node) - center_) / radius_) : Vector3(0, 0, 0));
  for (int d = 0; d < size; ++d)
    if (is_fixed_[node * size + d] != 0) modes.row(d).setZero();
}

void CoarseModes::write(Index node, double* rows) const {
  std::copy_n(of(node), static_cast<std::size_t>(size * count), rows);
}

TentativeProlongation orthonormalize(const RigidModes& modes, const Aggregates& groups) {
  return orthonormalize_groups(modes, groups);
}

TentativeProlongation orthonormalize(const CoarseModes& modes, const Aggregates& groups) {
  return orthonormalize_groups(modes, groups);
}

}  // namespace resilin
