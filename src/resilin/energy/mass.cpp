#include "resilin/energy/mass.hpp"

#include <algorithm>

namespace resilin {

void MassMatrix::multiply(const VectorX& x, VectorX& y) const {
  y.setZero(x.size());
  const auto node = [this](auto& v, Index i) { return v.segment(Eigen::Index{i} * dim, dim); };
  if (is_lumped()) {
    for (Index i = 0; i < nodal.size(); ++i) node(y, i) = nodal[i] * node(x, i);
    return;
  }
  for (Index i = 0; i < pattern->num_nodes(); ++i) {
    for (Offset s = pattern->row_begin[static_cast<std::size_t>(i)];
         s < pattern->row_begin[static_cast<std::size_t>(i) + 1]; ++s) {
      const Index j = pattern->columns[static_cast<std::size_t>(s)];
      const double m = slots[static_cast<std::size_t>(s)];
      node(y, i) += m * node(x, j);
      if (j != i) node(y, j) += m * node(x, i);
    }
  }
}

void MassMatrix::add_to(double factor, BlockMatrix& A) const {
  const int block_size = dim * dim;
  const auto add_scaled_identity = [&](Offset slot, double mass) {
    double* block = A.values.data() + slot * block_size;
    for (int k = 0; k < dim; ++k) block[k * (dim + 1)] += factor * mass;
  };
  if (is_lumped()) {
    for (Index i = 0; i < nodal.size(); ++i) {
      add_scaled_identity(A.pattern->row_begin[static_cast<std::size_t>(i)], nodal[i]);
    }
    return;
  }
  for (Offset s = 0; s < pattern->num_slots(); ++s)
    add_scaled_identity(s, slots[static_cast<std::size_t>(s)]);
}

void add_cell_masses(MassMatrix& mass, std::span<const Index> cells, std::span<const double> rest_volumes,
                     double density, bool is_consistent) {
  if (rest_volumes.empty()) return;
  const std::size_t n = cells.size() / rest_volumes.size();
  const auto corners = static_cast<double>(n);
  const auto add = [&mass](Index i, Index j, double entry) {
    mass.slots[static_cast<std::size_t>(mass.pattern->slot(std::min(i, j), std::max(i, j)))] += entry;
  };
  for (std::size_t cell = 0; cell < rest_volumes.size(); ++cell) {
    const double cell_mass = density * rest_volumes[cell];
    const double entry = cell_mass / (corners * (corners + 1));
    for (std::size_t a = 0; a < n; ++a) {
      const Index i = cells[cell * n + a];
      mass.nodal[i] += cell_mass / corners;
      if (mass.is_lumped()) continue;
      add(i, i, is_consistent ? 2 * entry : cell_mass / corners);
      if (!is_consistent) continue;
      for (std::size_t b = a + 1; b < n; ++b) add(i, cells[cell * n + b], entry);
    }
  }
}

}  // namespace resilin
