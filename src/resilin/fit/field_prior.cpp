#include "resilin/fit/field_prior.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "resilin/core/error.hpp"
#include "resilin/mesh/cell_positions.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

VectorX flat(const std::vector<Vector3>& vertices, int dim) {
  VectorX x(static_cast<Eigen::Index>(vertices.size()) * dim);
  for (std::size_t v = 0; v < vertices.size(); ++v)
    x.segment(static_cast<Eigen::Index>(v) * dim, dim) = vertices[v].head(dim);
  return x;
}

Vector3 mean_of(std::span<const Index> nodes, const std::vector<Vector3>& vertices) {
  Vector3 sum = Vector3::Zero();
  for (const Index node : nodes) sum += vertices[static_cast<std::size_t>(node)];
  return sum / static_cast<double>(nodes.size());
}

/// Pieces of cells with common sides, by the least cell of each.
class Pieces {
 public:
  explicit Pieces(std::size_t count) : parent_(count) {
    for (std::size_t i = 0; i < count; ++i) parent_[i] = i;
  }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    const std::size_t first = root(a), second = root(b);
    parent_[std::max(first, second)] = std::min(first, second);
  }

 private:
  std::vector<std::size_t> parent_;
};

/// The diagonal of A^-1 from A = L D L^T: Z = A^-1 on the pattern of L alone, from its last column to the
/// first (Takahashi, Fagan & Chen 1973), Z = D^-1 L^-1 + (I - L^T) Z.
VectorX diagonal_of_inverse(const Eigen::SimplicialLDLT<SparseMatrix>& factors) {
  const SparseMatrix L = factors.matrixL();  // unit lower
  const VectorX pivots = factors.vectorD();
  const Eigen::Index n = L.cols();
  VectorX diagonal(n), l = VectorX::Zero(n), z = VectorX::Zero(n);
  SparseMatrix Z = L;
  const auto below = [&](Eigen::Index column, const auto& visit) {
    for (SparseMatrix::InnerIterator entry(Z, column); entry; ++entry)
      if (entry.row() > column) visit(entry);
  };
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    for (SparseMatrix::InnerIterator entry(L, j); entry; ++entry)
      if (entry.row() > j) l[entry.row()] = entry.value();
    below(j, [&](const SparseMatrix::InnerIterator& entry) {
      const Eigen::Index c = entry.row();
      z[c] -= diagonal[c] * l[c];
      below(c, [&](const SparseMatrix::InnerIterator& other) {
        if (l[other.row()] == 0) return;
        z[other.row()] -= other.value() * l[c];
        z[c] -= other.value() * l[other.row()];
      });
    });
    diagonal[j] = 1 / pivots[j];
    below(j,
          [&](const SparseMatrix::InnerIterator& entry) { diagonal[j] -= l[entry.row()] * z[entry.row()]; });
    for (SparseMatrix::InnerIterator entry(Z, j); entry; ++entry) {
      if (entry.row() <= j) continue;
      entry.valueRef() = z[entry.row()];
      z[entry.row()] = l[entry.row()] = 0;
    }
  }
  return factors.permutationPinv() * diagonal;
}

}  // namespace

FieldCells field_cells(const CellBlock& cells, const std::vector<Vector3>& vertices, int dim) {
  FieldCells result;
  result.dim = dim;
  const VectorX x = flat(vertices, dim);
  std::vector<Vector3> middles;
  for (Index c = 0; c < cells.num_cells(); ++c) middles.push_back(mean_of(cells.cell(c), vertices));
  result.shares.assign(middles.size(), 0);
  // The volume of a cell by the divergence theorem: the sum over its sides of middle . area / dim.
  visit_facets(cells, [&](std::span<const Facet> uses) {
    const CellSide& side = cell_sides(cells.kind)[static_cast<std::size_t>(uses[0].local)];
    const CellKind kind = first_order(side.kind);
    const std::array<Index, 4> all = facet_corners(cells, uses[0]);
    const auto corners = std::span(all).first(static_cast<std::size_t>(num_corners(kind)));
    const Vector3 area = area_vector(dim, kind, corners, x), middle = mean_of(corners, vertices);
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const auto cell = static_cast<std::size_t>(uses[i].cell);
      result.shares[cell] += std::abs((middle - middles[cell]).dot(area)) / dim;
    }
    if (uses.size() != 2) return;
    const double distance =
        (middles[static_cast<std::size_t>(uses[0].cell)] - middles[static_cast<std::size_t>(uses[1].cell)])
            .norm();
    result.pairs.push_back({uses[0].cell, uses[1].cell, area.norm() / distance});
  });
  for (const double volume : result.shares) result.volume += volume;
  for (double& share : result.shares) share /= result.volume;
  for (FieldCells::Pair& pair : result.pairs) pair.weight *= std::pow(result.volume, 2.0 / dim - 1);
  return result;
}

struct FieldPrior::Matrices {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<std::vector<Eigen::Index>> unfelt;  ///< supports of the columns
  std::vector<bool> is_pinned;                    ///< for all unknowns
  SparseMatrix R;
  std::vector<Eigen::Index> kept;  ///< those that are not pinned
  Eigen::SimplicialLDLT<SparseMatrix> factors;
};

FieldPrior::FieldPrior(Eigen::Index num_unknowns) : matrices_(std::make_unique<Matrices>()) {
  matrices_->is_pinned.assign(static_cast<std::size_t>(num_unknowns), true);
}

FieldPrior::~FieldPrior() = default;

void FieldPrior::add(const FieldCells& cells, Eigen::Index first, PriorKind kind) {
  Matrices& m = *matrices_;
  const std::size_t n = cells.shares.size();
  for (std::size_t c = 0; c < n; ++c) m.is_pinned[static_cast<std::size_t>(first) + c] = false;
  if (kind != PriorKind::smooth)
    for (std::size_t c = 0; c < n; ++c) {
      const Eigen::Index i = first + static_cast<Eigen::Index>(c);
      m.entries.emplace_back(i, i, cells.shares[c]);
    }
  if (kind == PriorKind::tikhonov) return;
  Pieces pieces(n);
  for (const FieldCells::Pair& pair : cells.pairs) {
    const Eigen::Index a = first + pair.first, b = first + pair.second;
    m.entries.emplace_back(a, a, pair.weight);
    m.entries.emplace_back(b, b, pair.weight);
    m.entries.emplace_back(a, b, -pair.weight);
    m.entries.emplace_back(b, a, -pair.weight);
    pieces.join(static_cast<std::size_t>(pair.first), static_cast<std::size_t>(pair.second));
  }
  if (kind != PriorKind::smooth) return;
  std::vector<std::vector<Eigen::Index>> members(n);
  for (std::size_t c = 0; c < n; ++c) members[pieces.root(c)].push_back(first + static_cast<Eigen::Index>(c));
  for (std::vector<Eigen::Index>& piece : members) {
    if (piece.empty()) continue;
    m.is_pinned[static_cast<std::size_t>(piece.front())] = true;
    m.unfelt.push_back(std::move(piece));
  }
}

void FieldPrior::finish() {
  Matrices& m = *matrices_;
  const auto n = static_cast<Eigen::Index>(m.is_pinned.size());
  m.R.resize(n, n);
  m.R.setFromTriplets(m.entries.begin(), m.entries.end());
  std::vector<bool> is_felt(m.is_pinned.size(), false);
  for (Eigen::Index j = 0; j < n; ++j)
    for (SparseMatrix::InnerIterator entry(m.R, j); entry; ++entry)
      is_felt[static_cast<std::size_t>(j)] = true;
  std::vector<bool> is_in_piece(m.is_pinned.size(), false);
  for (const auto& piece : m.unfelt)
    for (const Eigen::Index i : piece) is_in_piece[static_cast<std::size_t>(i)] = true;
  for (Eigen::Index i = 0; i < n; ++i)
    if (!is_felt[static_cast<std::size_t>(i)] && !is_in_piece[static_cast<std::size_t>(i)])
      m.unfelt.push_back({i});
  unfelt_ = DenseMatrix::Zero(n, static_cast<Eigen::Index>(m.unfelt.size()));
  for (std::size_t k = 0; k < m.unfelt.size(); ++k)
    for (const Eigen::Index i : m.unfelt[k]) unfelt_(i, static_cast<Eigen::Index>(k)) = 1;
  std::vector<Eigen::Index> place(m.is_pinned.size(), -1);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (m.is_pinned[static_cast<std::size_t>(i)]) continue;
    place[static_cast<std::size_t>(i)] = static_cast<Eigen::Index>(m.kept.size());
    m.kept.push_back(i);
  }
  std::vector<Eigen::Triplet<double>> kept;
  for (const Eigen::Triplet<double>& entry : m.entries) {
    const Eigen::Index row = place[static_cast<std::size_t>(entry.row())],
                       column = place[static_cast<std::size_t>(entry.col())];
    if (row >= 0 && column >= 0) kept.emplace_back(row, column, entry.value());
  }
  const auto size = static_cast<Eigen::Index>(m.kept.size());
  SparseMatrix free(size, size);
  free.setFromTriplets(kept.begin(), kept.end());
  m.factors.compute(free);
  if (m.factors.info() != Eigen::Success || !(m.factors.vectorD().minCoeff() > 0))
    throw InputError("fit.regularise", "cells with a volume", "some without one",
                     "look at the mesh with resilin check");
}

VectorX FieldPrior::times(const VectorX& u) const { return matrices_->R * u; }

DenseMatrix FieldPrior::inverse_times(const DenseMatrix& X) const {
  const Matrices& m = *matrices_;
  DenseMatrix kept(static_cast<Eigen::Index>(m.kept.size()), X.cols());
  for (std::size_t i = 0; i < m.kept.size(); ++i) kept.row(static_cast<Eigen::Index>(i)) = X.row(m.kept[i]);
  const DenseMatrix solved = m.factors.solve(kept);
  DenseMatrix result = DenseMatrix::Zero(X.rows(), X.cols());
  for (std::size_t i = 0; i < m.kept.size(); ++i)
    result.row(m.kept[i]) = solved.row(static_cast<Eigen::Index>(i));
  return result;
}

VectorX FieldPrior::inverse_diagonal() const {
  const Matrices& m = *matrices_;
  const VectorX kept = diagonal_of_inverse(m.factors);
  VectorX result = VectorX::Zero(static_cast<Eigen::Index>(m.is_pinned.size()));
  for (std::size_t i = 0; i < m.kept.size(); ++i) result[m.kept[i]] = kept[static_cast<Eigen::Index>(i)];
  return result;
}

}  // namespace resilin
