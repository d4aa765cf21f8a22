#include "resilin/linear/dependents.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace resilin {

Dependents::Dependents(int dim, Index num_unknowns, std::vector<Relation> relations)
    : dim_(dim),
      relations_(std::move(relations)),
      row_of_(static_cast<std::size_t>(num_unknowns), -1),
      parts_(static_cast<std::size_t>(num_unknowns / dim)) {
  for (std::size_t row = 0; row < relations_.size(); ++row)
    row_of_[static_cast<std::size_t>(relations_[row].unknown)] = static_cast<Index>(row);
  for (const Relation& relation : relations_) {
    std::vector<Part>& parts = parts_[static_cast<std::size_t>(relation.unknown / dim)];
    if (parts.empty()) parts = parts_of(relation.unknown / dim);
  }
}

std::vector<Dependents::Part> Dependents::parts_of(Index node) const {
  std::vector<Part> parts;
  const auto add = [&](int row, Index unknown, double weight) {
    const Index of = unknown / dim_;
    auto found = std::ranges::find(parts, of, &Part::node);
    if (found == parts.end()) found = parts.insert(parts.end(), {of, {}});
    found->weights[static_cast<std::size_t>(row * dim_ + unknown % dim_)] += weight;
  };
  for (int k = 0; k < dim_; ++k) {
    const Index unknown = node * dim_ + k;
    const Index row = row_of_[static_cast<std::size_t>(unknown)];
    if (row < 0) {
      add(k, unknown, 1);
      continue;
    }
    for (const Weight& weight : relations_[static_cast<std::size_t>(row)].by)
      add(k, weight.unknown, weight.value);
  }
  std::ranges::sort(parts, {}, &Part::node);
  return parts;
}

void Dependents::add_forces(VectorX& forces) const {
  for (const Relation& relation : relations_)
    for (const Weight& weight : relation.by)
      forces[weight.unknown] += weight.value * forces[relation.unknown];
}

void Dependents::add_magnitudes(VectorX& magnitudes) const {
  for (const Relation& relation : relations_)
    for (const Weight& weight : relation.by)
      magnitudes[weight.unknown] += std::abs(weight.value) * magnitudes[relation.unknown];
}

void Dependents::follow(VectorX& change) const {
  for (const Relation& relation : relations_) {
    double sum = 0;
    for (const Weight& weight : relation.by) sum += weight.value * change[weight.unknown];
    change[relation.unknown] = sum;
  }
}

void Dependents::place(const VectorX& constants, VectorX& positions) const {
  for (const Relation& relation : relations_) {
    double sum = constants[relation.unknown];
    for (const Weight& weight : relation.by) sum += weight.value * positions[weight.unknown];
    positions[relation.unknown] = sum;
  }
}

BlockPattern Dependents::extended(const BlockPattern& pattern, BlockPatternBuilder builder) const {
  const auto for_each_of = [&](Index node, const auto& visit) {
    const std::vector<Part>& parts = parts_[static_cast<std::size_t>(node)];
    if (parts.empty()) return visit(node);
    for (const Part& part : parts) visit(part.node);
  };
  std::vector<std::pair<Index, Index>> pairs;
  for (Index i = 0; i < pattern.num_nodes(); ++i)
    for (Offset slot = pattern.row_begin[i]; slot < pattern.row_begin[i + 1]; ++slot) {
      const Index j = pattern.columns[slot];
      if (parts_[static_cast<std::size_t>(i)].empty() && parts_[static_cast<std::size_t>(j)].empty())
        continue;
      for_each_of(i, [&](Index m) {
        for_each_of(j, [&](Index n) { pairs.emplace_back(std::min(m, n), std::max(m, n)); });
      });
    }
  std::ranges::sort(pairs);
  pairs.erase(std::ranges::unique(pairs).begin(), pairs.end());
  for (const auto& [m, n] : pairs) builder.add_pair(m, n);
  return builder.build();
}

// A block (i, j) with i < j stands for its transpose at (j, i), too.
void Dependents::add_reduced(Index i, Index j, const double* block, BlockMatrix& matrix) const {
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 3, 3>;
  const auto parts = [&](Index node) -> std::vector<Part> {
    const std::vector<Part>& own = parts_[static_cast<std::size_t>(node)];
    return own.empty() ? parts_of(node) : own;
  };
  const Eigen::Map<const Block> B(block, dim_, dim_);
  const std::vector<Part> columns = parts(j);
  for (const Part& row : parts(i)) {
    const Block left = Eigen::Map<const Block>(row.weights.data(), dim_, dim_).transpose() * B;
    for (const Part& column : columns) {
      if (i == j && column.node < row.node) continue;
      Block product = left * Eigen::Map<const Block>(column.weights.data(), dim_, dim_);
      if (i != j && row.node == column.node) product += Block(product.transpose());
      matrix.add_block(row.node, column.node, product.data());
    }
  }
}

void Dependents::reduce(BlockMatrix& matrix) const {
  const BlockPattern& pattern = *matrix.pattern;
  const auto size = static_cast<std::size_t>(dim_ * dim_);
  std::vector<double> blocks;  // all are taken out before any comes back
  std::vector<std::pair<Index, Index>> places;
  const auto take = [&](Index i, Index j, double* values) {
    if (parts_[static_cast<std::size_t>(i)].empty() && parts_[static_cast<std::size_t>(j)].empty()) return;
    if (std::all_of(values, values + size, [](double value) { return value == 0; })) return;
    places.emplace_back(i, j);
    blocks.insert(blocks.end(), values, values + size);
    std::fill(values, values + size, 0.0);
  };
  for (Index i = 0; i < pattern.num_nodes(); ++i)
    for (Offset slot = pattern.row_begin[i]; slot < pattern.row_begin[i + 1]; ++slot)
      take(i, pattern.columns[slot], matrix.block(slot));
  for (const BlockMatrix::ExtraBlock& extra : matrix.extra)
    take(extra.row, extra.column, matrix.extra_values.data() + extra.begin);
  for (std::size_t k = 0; k < places.size(); ++k)
    add_reduced(places[k].first, places[k].second, blocks.data() + k * size, matrix);
}

}  // namespace resilin
