#include "resilin/energy/mass.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/parallel.hpp"
#include "resilin/mesh/cell_positions.hpp"
#include "resilin/mesh/shape_integrals.hpp"

namespace resilin {
namespace {

constexpr std::size_t nodes_per_chunk = 8192, slots_per_chunk = 32768;

/// Volumes that the nodes of a cell stand for, from integral N_a N_b dV.
void lump(const ElementInfo& element, std::span<const double> products, std::span<double> volumes) {
  const std::size_t n = volumes.size();
  double volume = 0, diagonal = 0;
  for (std::size_t a = 0; a < n; ++a) {
    volumes[a] = 0;
    for (std::size_t b = 0; b < n; ++b) volumes[a] += products[a * n + b];
    volume += volumes[a];
    diagonal += products[a * (n + 1)];
  }
  if (element.degree == 1) return;
  for (std::size_t a = 0; a < n; ++a) volumes[a] = volume * products[a * (n + 1)] / diagonal;
}

}  // namespace

template <class Entry>
void MassMatrix::multiply_with(const Entry& entry, const VectorX& x, VectorX& y) const {
  y.setZero(x.size());
  const auto node = [this](auto& v, Index i) { return v.segment(Eigen::Index{i} * dim, dim); };
  if (is_lumped()) {
    parallel_for(static_cast<std::size_t>(nodal.size()), nodes_per_chunk,
                 [&](std::size_t first, std::size_t last) {
                   for (auto i = static_cast<Index>(first); i < static_cast<Index>(last); ++i)
                     node(y, i) = nodal[i] * node(x, i);
                 });
    return;
  }
  for (Index i = 0; i < pattern->num_nodes(); ++i) {
    for (Offset s = pattern->row_begin[static_cast<std::size_t>(i)];
         s < pattern->row_begin[static_cast<std::size_t>(i) + 1]; ++s) {
      const Index j = pattern->columns[static_cast<std::size_t>(s)];
      const double m = entry(slots[static_cast<std::size_t>(s)]);
      node(y, i) += m * node(x, j);
      if (j != i) node(y, j) += m * node(x, i);
    }
  }
}

void MassMatrix::multiply(const VectorX& x, VectorX& y) const {
  multiply_with([](double m) { return m; }, x, y);
}

void MassMatrix::multiply_magnitude(const VectorX& x, VectorX& y) const {
  multiply_with([](double m) { return std::abs(m); }, x, y);
}

void MassMatrix::add_to(double factor, BlockMatrix& A) const {
  const int block_size = dim * dim;
  const auto add_scaled_identity = [&](Offset slot, double mass) {
    double* block = A.values.data() + slot * block_size;
    for (int k = 0; k < dim; ++k) block[k * (dim + 1)] += factor * mass;
  };
  if (is_lumped()) {
    parallel_for(static_cast<std::size_t>(nodal.size()), nodes_per_chunk,
                 [&](std::size_t first, std::size_t last) {
                   for (std::size_t i = first; i < last; ++i)
                     add_scaled_identity(A.pattern->row_begin[i], nodal[static_cast<Eigen::Index>(i)]);
                 });
    return;
  }
  parallel_for(slots.size(), slots_per_chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t s = first; s < last; ++s) add_scaled_identity(static_cast<Offset>(s), slots[s]);
  });
}

MassMatrix MassMatrix::times(double factor) const {
  MassMatrix product = *this;
  product.nodal *= factor;
  for (double& slot : product.slots) slot *= factor;
  return product;
}

void add_cell_masses(MassMatrix& mass, const ElementInfo& element, std::span<const Index> cells,
                     const VectorX& rest_positions, double density, bool is_consistent) {
  const auto n = static_cast<std::size_t>(element.num_nodes);
  ShapeIntegrals integrals(element);
  std::vector<double> X, products(n * n), lumped(n);
  const auto add = [&mass](Index i, Index j, double entry) {
    mass.slots[static_cast<std::size_t>(mass.pattern->slot(std::min(i, j), std::max(i, j)))] += entry;
  };
  for (std::size_t first = 0; first < cells.size(); first += n) {
    const std::span<const Index> nodes = cells.subspan(first, n);
    cell_positions(element.dim, nodes, rest_positions, X);
    integrals.of_products(X, products);
    lump(element, products, lumped);
    for (std::size_t a = 0; a < n; ++a) {
      mass.nodal[nodes[a]] += density * lumped[a];
      if (mass.is_lumped()) continue;
      if (!is_consistent) add(nodes[a], nodes[a], density * lumped[a]);
      for (std::size_t b = a; b < n && is_consistent; ++b)
        add(nodes[a], nodes[b], density * products[a * n + b]);
    }
  }
}

}  // namespace resilin
