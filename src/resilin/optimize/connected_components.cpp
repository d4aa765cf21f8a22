#include "resilin/optimize/connected_components.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "resilin/core/archive.hpp"
#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

/// Sets of nodes that grow together (union-find with path halving).
class Sets {
 public:
  explicit Sets(Index size) : parent_(static_cast<std::size_t>(size)) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  Index root(Index i) {
    while (at(i) != i) i = at(i) = at(at(i));
    return i;
  }
  /// The smaller root stays, so that the roots do not depend on the order.
  void join(Index i, Index j) {
    const Index a = root(i), b = root(j);
    at(std::max(a, b)) = std::min(a, b);
  }

 private:
  Index& at(Index i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<Index> parent_;
};

constexpr std::size_t nodes_per_chunk = 2048;

/// A power of two times which numbers have squares that neither vanish nor overflow; 1 where they have
/// anyway.
double unit_for_squares(double largest) {
  constexpr double tiny = 1e-100, huge = 1e100;
  constexpr int most = 1000;  // the smallest double is 2^-1074
  if (!(largest > 0) || (largest > tiny && largest < huge) || !std::isfinite(largest)) return 1;
  return std::ldexp(1.0, std::clamp(-std::ilogb(largest), -most, most));
}

}  // namespace

ConnectedComponents::ConnectedComponents(const BlockPattern& pattern, ProcessGroup share)
    : share_(std::move(share)), part_of_(static_cast<std::size_t>(pattern.num_nodes()), 0) {
  Sets sets(pattern.num_nodes());
  std::vector<bool> is_coupled(part_of_.size(), false);
  for (Index i = 0; i < pattern.num_nodes(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    for (Offset slot = pattern.row_begin[row] + 1; slot < pattern.row_begin[row + 1]; ++slot) {
      const Index j = pattern.columns[static_cast<std::size_t>(slot)];
      sets.join(i, j);
      is_coupled[row] = is_coupled[static_cast<std::size_t>(j)] = true;
    }
  }
  std::vector<Index> number_of_root(part_of_.size(), -1);
  Index found = 0;
  for (Index i = 0; i < pattern.num_nodes(); ++i) {
    if (!is_coupled[static_cast<std::size_t>(i)]) continue;
    Index& number = number_of_root[static_cast<std::size_t>(sets.root(i))];
    if (number < 0) number = found++;
    part_of_[static_cast<std::size_t>(i)] = number;
  }
  count_ = std::max(Index{1}, found);
  if (!share_.is_whole()) join_across(is_coupled);
}

void ConnectedComponents::join_across(const std::vector<bool>& is_coupled) {
  constexpr double none = std::numeric_limits<double>::infinity();
  const auto part_at = [this](std::size_t node) { return static_cast<std::size_t>(part_of_[node]); };
  // Each piece is known by the smallest number of its nodes, which goes from copy to copy.
  std::vector<double> label(static_cast<std::size_t>(count_), none);
  for (std::size_t node = 0; node < part_of_.size(); ++node)
    if (is_coupled[node])
      label[part_at(node)] =
          std::min(label[part_at(node)], static_cast<double>(share_.number_of(static_cast<Index>(node))));
  for (bool is_changed = true; is_changed;) {
    VectorX labels = VectorX::Constant(num_nodes(), none);
    for (std::size_t node = 0; node < part_of_.size(); ++node)
      if (is_coupled[node]) labels[static_cast<Eigen::Index>(node)] = label[part_at(node)];
    share_.exchange().combine_copies(labels, Exchange::Combine::smallest);
    is_changed = false;
    for (std::size_t node = 0; node < part_of_.size(); ++node) {
      if (!is_coupled[node] || labels[static_cast<Eigen::Index>(node)] >= label[part_at(node)]) continue;
      label[part_at(node)] = labels[static_cast<Eigen::Index>(node)];
      is_changed = true;
    }
    is_changed = share_.any(is_changed);
  }
  // All labels there are, in order.
  ArchiveWriter mine;
  mine(label);
  std::vector<double> all;
  for (const std::string& bytes : share_.exchange().gather(mine.take())) {
    std::vector<double> theirs;
    ArchiveReader(bytes, "labels")(theirs);
    all.insert(all.end(), theirs.begin(), theirs.end());
  }
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  if (all.size() > 1 && all.back() == none) all.pop_back();
  ArchiveWriter sorted;
  sorted(all);
  const std::string bytes = share_.exchange().tell(0, sorted.take());
  ArchiveReader(bytes, "labels")(all);
  const auto number_of = [&](double value) {
    const auto found = std::ranges::lower_bound(all, value);
    return found == all.end() ? Index{0} : static_cast<Index>(found - all.begin());
  };
  for (Index& part : part_of_) part = number_of(label[static_cast<std::size_t>(part)]);
  for (std::size_t node = 0; node < part_of_.size(); ++node)
    if (!is_coupled[node]) part_of_[node] = 0;
  count_ = std::max(Index{1}, static_cast<Index>(all.size()));
}

ConnectedComponents ConnectedComponents::joined_by(const BlockMatrix& hessian) const {
  Sets sets(count_);
  for (const BlockMatrix::ExtraBlock& extra : hessian.extra)
    sets.join(of_node(extra.row), of_node(extra.column));
  std::vector<Index> number(static_cast<std::size_t>(count_));
  Index found = 0;
  for (Index part = 0; part < count_; ++part) {
    const Index root = sets.root(part);
    number[static_cast<std::size_t>(part)] = root == part ? found++ : number[static_cast<std::size_t>(root)];
  }
  ConnectedComponents joined = *this;
  joined.count_ = found;
  for (Index& part : joined.part_of_) part = number[static_cast<std::size_t>(part)];
  return joined;
}

VectorX ConnectedComponents::own_squares(const VectorX& values, const VectorX& units,
                                         std::span<const std::uint8_t> is_fixed, Unknowns which) const {
  struct Sums : VectorX {
    Sums& operator+=(const Sums& other) {
      if (size() == 0) return *this = other;
      static_cast<VectorX&>(*this) += other;
      return *this;
    }
  };
  const std::size_t dim = static_cast<std::size_t>(values.size()) / part_of_.size();
  return parallel_sum<Sums>(part_of_.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    Sums sums;
    sums.setZero(count_);
    for (std::size_t node = begin; node < end; ++node) {
      if (!share_.owns(static_cast<Index>(node))) continue;
      double sum = 0;  // by node: the additions of a part wait for each other
      const Index part = part_of_[node];
      for (std::size_t k = node * dim; k < (node + 1) * dim; ++k) {
        const double counted = units[part] * values[static_cast<Eigen::Index>(k)];
        if (which == Unknowns::all || (is_fixed[k] != 0) == (which == Unknowns::fixed))
          sum += counted * counted;
      }
      sums[part] += sum;
    }
    return sums;
  });
}

VectorX ConnectedComponents::squares(const VectorX& values, const VectorX& units,
                                     std::span<const std::uint8_t> is_fixed, Unknowns which) const {
  VectorX sums = own_squares(values, units, is_fixed, which);
  share_.sum(std::span(sums.data(), static_cast<std::size_t>(sums.size())));
  return sums;
}

VectorX ConnectedComponents::norms(const VectorX& values, std::span<const std::uint8_t> is_fixed,
                                   Unknowns which) const {
  constexpr double tiny = 1e-200, huge = 1e200;
  const VectorX ones = VectorX::Ones(count_);
  const VectorX sums = squares(values, ones, is_fixed, which);
  if (std::ranges::all_of(sums, [](double sum) { return sum > tiny && sum < huge; })) return sums.cwiseSqrt();
  const VectorX units = largest(values).unaryExpr(&unit_for_squares);
  if (units == ones) return sums.cwiseSqrt();
  return squares(values, units, is_fixed, which).cwiseSqrt().cwiseQuotient(units);
}

VectorX ConnectedComponents::largest(const VectorX& values) const {
  struct Largest : VectorX {
    Largest& operator+=(const Largest& other) {
      if (size() == 0) return *this = other;
      static_cast<VectorX&>(*this) = cwiseMax(other);
      return *this;
    }
  };
  const Eigen::Index dim = values.size() / static_cast<Eigen::Index>(part_of_.size());
  VectorX largest =
      parallel_sum<Largest>(part_of_.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
        Largest so_far;
        so_far.setZero(count_);
        for (std::size_t node = begin; node < end; ++node) {
          double& of_part = so_far[part_of_[node]];
          const auto first = static_cast<Eigen::Index>(node) * dim;
          for (Eigen::Index i = first; i < first + dim; ++i) of_part = std::max(of_part, std::abs(values[i]));
        }
        return so_far;
      });
  share_.largest(std::span(largest.data(), static_cast<std::size_t>(largest.size())));
  return largest;
}

void scale_components(const ConnectedComponents& parts, const VectorX& weights, BlockMatrix& matrix) {
  const int dim = matrix.dim;
  const BlockPattern& pattern = *matrix.pattern;
  const auto num_nodes = static_cast<std::size_t>(pattern.num_nodes());
  parallel_for(num_nodes, nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const double weight = weights[parts.of_node(static_cast<Index>(row))];
      const auto first = pattern.row_begin[row] * dim * dim, last = pattern.row_begin[row + 1] * dim * dim;
      for (Offset i = first; i < last; ++i) matrix.values[static_cast<std::size_t>(i)] *= weight;
    }
  });
  for (const BlockMatrix::ExtraBlock& extra : matrix.extra) {
    const double weight = weights[parts.of_node(extra.row)];
    double* block = matrix.extra_values.data() + extra.begin;
    std::for_each_n(block, dim * dim, [weight](double& value) { value *= weight; });
  }
}

void scale_components(const ConnectedComponents& parts, const VectorX& weights, VectorX& right_side) {
  const Eigen::Index dim = right_side.size() / parts.num_nodes();
  for (Eigen::Index i = 0; i < right_side.size(); ++i)
    right_side[i] *= weights[parts.of_node(static_cast<Index>(i / dim))];
}

}  // namespace resilin
