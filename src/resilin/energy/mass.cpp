#include "resilin/energy/mass.hpp"

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

}  // namespace resilin
