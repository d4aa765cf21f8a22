#include "resilin/optimize/residual.hpp"

#include "resilin/core/parallel.hpp"

namespace resilin {

void set_fixed_to_zero(std::span<const std::uint8_t> is_fixed, VectorX& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (is_fixed[static_cast<std::size_t>(i)] != 0) values[i] = 0;
  }
}

VectorX free_diagonal(const BlockMatrix& hessian, std::span<const std::uint8_t> is_fixed,
                      const ProcessGroup& share) {
  constexpr std::size_t nodes_per_chunk = 2048;
  const int dim = hessian.dim;
  VectorX diagonal(hessian.num_unknowns());
  parallel_for(static_cast<std::size_t>(hessian.num_nodes()), nodes_per_chunk,
               [&](std::size_t first, std::size_t last) {
                 for (std::size_t node = first; node < last; ++node) {
                   const double* block = hessian.block(hessian.pattern->row_begin[node]);
                   for (int d = 0; d < dim; ++d)
                     diagonal[static_cast<Eigen::Index>(node) * dim + d] = block[d * (dim + 1)];
                 }
               });
  share.add_copies(diagonal);
  diagonal = diagonal.cwiseAbs();
  set_fixed_to_zero(is_fixed, diagonal);
  return diagonal;
}

}  // namespace resilin
