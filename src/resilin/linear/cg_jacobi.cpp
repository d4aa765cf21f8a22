#include "resilin/linear/catalog.hpp"
#include "resilin/linear/conjugate_gradients.hpp"
#include "resilin/linear/small_block.hpp"

namespace resilin {
namespace {

/// M = the diagonal blocks of A.
class BlockJacobi : public Preconditioner {
 public:
  void analyze(const BlockMatrix&, const VectorX&) override {}

  LinearReport factorize(const BlockMatrix& A) override { return A.dim == 3 ? invert<3>(A) : invert<2>(A); }

  void apply(const VectorX& r, double /*norm*/, VectorX& z) override {
    z.resize(r.size());
    dim_ == 3 ? apply_blocks<3>(r, z) : apply_blocks<2>(r, z);
  }

  void release() override { *this = {}; }
  double bytes_per_coupling(int dim) const override { return 8.0 * dim * dim; }

 private:
  template <int dim>
  LinearReport invert(const BlockMatrix& A) {
    dim_ = dim;
    inverse_.resize(static_cast<std::size_t>(A.num_nodes()) * dim * dim);
    LinearReport report;
    for (Index i = 0; i < A.num_nodes(); ++i) {
      const double* block = A.block(A.pattern->row_begin[i]);
      if (invert_positive_definite<dim>(block, 1e-14, &inverse_[static_cast<std::size_t>(i) * dim * dim]))
        continue;
      report.status = LinearReport::Status::indefinite;
      report.worst_node = i;
      return report;
    }
    return report;
  }

  template <int dim>
  void apply_blocks(const VectorX& r, VectorX& z) const {
    using Block = Eigen::Matrix<double, dim, dim, Eigen::RowMajor>;
    for (Offset i = 0; i < r.size() / dim; ++i)
      z.segment<dim>(i * dim) =
          Eigen::Map<const Block>(inverse_.data() + i * dim * dim) * r.segment<dim>(i * dim);
  }

  int dim_ = 3;
  std::vector<double> inverse_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_cg_jacobi(const LinearOptions& options) {
  return std::make_unique<ConjugateGradients>("cg_jacobi", options.max_iterations,
                                              std::make_unique<BlockJacobi>());
}

}  // namespace resilin
