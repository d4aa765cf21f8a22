#include <algorithm>

#include "resilin/core/dense.hpp"
#include "resilin/linear/catalog.hpp"
#include "resilin/linear/conjugate_gradients.hpp"
#include "resilin/linear/decoupled.hpp"
#include "resilin/linear/diagonal_check.hpp"
#include "resilin/linear/merged_pattern.hpp"
#include "resilin/linear/multigrid_level.hpp"
#include "resilin/linear/permuted_pattern.hpp"
#include "resilin/linear/sweep_order.hpp"

namespace resilin {
namespace {

constexpr std::size_t nodes_per_chunk = 2048;

/// Smoothed aggregation with the rigid body modes: a W-cycle with a forward Gauss-Seidel sweep on the way
/// down and a backward one on the way up, in single precision.
///
/// Source: Vanek, Mandel, Brezina 1996. What depends on the pattern, on the positions and on which unknowns
/// are fixed is set up once; new values refill the hierarchy. Positions that follow a large rotation keep the
/// modes near to what the matrix leaves almost unmoved: `analyze` with new positions on the same pattern is
/// cheap.
class SmoothedAggregation : public Preconditioner {
 public:
  void analyze(const BlockMatrix& A, const VectorX& node_positions) override {
    if (positions_.size() != node_positions.size() || positions_ != node_positions) {
      positions_ = node_positions;
      modes_are_current_ = false;
    }
    if (pattern_.update(A, MergedPattern::Keep::same_pairs)) analyze_pattern();
  }

  LinearReport factorize(const BlockMatrix& A) override;
  void apply(const VectorX& r, double norm, VectorX& z) override;
  void release() override { *this = {}; }
  // Measured on bars of tetrahedra of degree 1 and 2 and of triangles; the blocks of the finest level are a
  // quarter of it.
  double bytes_per_coupling(int dim) const override { return dim == 3 ? 135 : 100; }

 private:
  static constexpr Index most_coarse_unknowns = 240;  ///< solved densely

  void analyze_pattern();
  void build_levels(int dim);
  void set_modes();
  void fill_finest(const BlockMatrix& A);
  bool factorize_coarsest();
  void solve_coarsest();
  void cycle(std::size_t depth);
  void visit_coarse(std::size_t depth);

  MergedPattern pattern_;
  PermutedPattern permuted_;
  ColoredChunks sweeps_;  // sweeps of its positions
  std::vector<Index> along_layers_;
  VectorX positions_;
  std::vector<std::uint8_t> is_fixed_;  // by unknown, node by node as in A
  std::vector<MultigridLevel> levels_;
  std::vector<Aggregates> groups_;  // groups of every level but the last
  bool modes_are_current_ = false;
  double scale_ = 1;
  Eigen::MatrixXd coarsest_;  // its Cholesky factor
  VectorX coarse_vector_;
  bool is_coarsest_dense_ = false;
};

void SmoothedAggregation::analyze_pattern() {
  const NodeGraph graph(pattern_);
  SweepOrder order = two_color_order(graph, MultigridLevel().least_couplings());
  permuted_ = PermutedPattern(pattern_, graph, std::move(order.node_at));
  sweeps_ = std::move(order.chunks);
  along_layers_ = std::move(order.along_layers);
  levels_.clear();
}

void SmoothedAggregation::build_levels(int dim) {
  const Index num_nodes = permuted_.num_nodes();
  std::vector<std::uint8_t> is_active(static_cast<std::size_t>(num_nodes), 0);
  for (Index i = 0; i < num_nodes; ++i)
    for (int d = 0; d < dim; ++d)
      if (is_fixed_[permuted_.node_at[i] * dim + d] == 0) is_active[i] = 1;
  groups_.clear();
  // The finest level takes over the pattern, and hands it on when levels are made anew.
  MultigridLevel finest;
  finest.dim = dim;
  finest.row_begin = std::move(levels_.empty() ? permuted_.row_begin : levels_[0].row_begin);
  finest.columns = std::move(levels_.empty() ? permuted_.columns : levels_[0].columns);
  levels_.clear();
  levels_.push_back(std::move(finest));
  levels_[0].sweeps = sweeps_;
  levels_[0].along_layers = along_layers_;
  for (;;) {
    MultigridLevel& fine = levels_.back();
    fine.allocate();
    if (fine.num_nodes() * fine.block_size() <= most_coarse_unknowns) break;
    fine.lower = LowerPattern(fine.row_begin, fine.columns);
    Aggregates groups = aggregate(fine.full(), is_active, fine.along_layers);
    if (groups.count == 0 || groups.count > fine.num_nodes() * 2 / 3) break;
    MultigridLevel coarse;
    coarse.dim = dim;
    coarse.is_given = false;
    if (!fine.connect(groups, coarse)) break;
    is_active.assign(static_cast<std::size_t>(groups.count), 1);
    groups_.push_back(std::move(groups));
    levels_.push_back(std::move(coarse));
  }
  modes_are_current_ = false;
}

/// The near null space of every level, from the positions.
void SmoothedAggregation::set_modes() {
  const RigidModes rigid(levels_.front().dim, positions_, is_fixed_, permuted_.node_at);
  CoarseModes modes;
  for (std::size_t depth = 0; depth < groups_.size(); ++depth) {
    TentativeProlongation tentative =
        depth == 0 ? orthonormalize(rigid, groups_[0]) : orthonormalize(modes, groups_[depth]);
    levels_[depth].set_tentative(tentative.fine);
    levels_[depth + 1].is_absent = std::move(tentative.is_absent);
    modes = std::move(tentative.coarse);
  }
  modes_are_current_ = true;
}

void SmoothedAggregation::fill_finest(const BlockMatrix& A) {
  MultigridLevel& finest = levels_.front();
  const int dim = A.dim;
  pattern_.for_each_block(A, [&](Offset slot, const double* block) {
    const Offset target = permuted_.block_of_slot[slot];
    float* to = finest.blocks.data() + (target >= 0 ? target : ~target) * dim * dim;
    for (int r = 0; r < dim; ++r)
      for (int c = 0; c < dim; ++c)
        to[r * dim + c] =
            static_cast<float>(scale_ * (target >= 0 ? block[r * dim + c] : block[c * dim + r]));
  });
}

LinearReport SmoothedAggregation::factorize(const BlockMatrix& A) {
  if (pattern_.update(A, MergedPattern::Keep::same_pairs)) analyze_pattern();
  LinearReport report;
  const DiagonalCheck diagonal = check_diagonal(A);
  if (diagonal.bad_node >= 0) {
    report.status = LinearReport::Status::indefinite;
    report.worst_node = diagonal.bad_node;
    return report;
  }
  scale_ = 1 / diagonal.largest;
  std::vector<std::uint8_t> is_fixed = decoupled_unknowns(A);
  if (levels_.empty() || is_fixed != is_fixed_) {
    is_fixed_ = std::move(is_fixed);
    build_levels(A.dim);
  }
  if (!modes_are_current_) set_modes();
  fill_finest(A);
  for (std::size_t depth = 0; depth < levels_.size(); ++depth) {
    if (!levels_[depth].invert_diagonal()) report.status = LinearReport::Status::indefinite;
    if (report.status != LinearReport::Status::ok) return report;
    if (depth + 1 < levels_.size()) levels_[depth].project_to(levels_[depth + 1]);
  }
  if (!factorize_coarsest()) report.status = LinearReport::Status::indefinite;
  return report;
}

bool SmoothedAggregation::factorize_coarsest() {
  const MultigridLevel& level = levels_.back();
  const int size = level.block_size();
  is_coarsest_dense_ = level.num_nodes() * size <= most_coarse_unknowns;
  if (!is_coarsest_dense_) return true;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(level.num_nodes() * size, level.num_nodes() * size);
  const auto put = [&](Index i, Index j, Offset block) {
    const float* from = level.blocks.data() + block * level.numbers_per_block();
    for (int r = 0; r < size; ++r)
      for (int c = 0; c < size; ++c)
        matrix(j * size + c, i * size + r) = static_cast<double>(from[r * size + c]);
  };
  for (Index i = 0; i < level.num_nodes(); ++i) {
    put(i, i, i);
    for (Offset k = level.row_begin[i]; k < level.row_begin[i + 1]; ++k)
      put(i, level.columns[k], level.num_nodes() + k);
  }
  // Round-off of single precision may take away definiteness where the matrix is nearly singular.
  const double largest = matrix.diagonal().maxCoeff();
  for (double shift = 1e-7; !dense::cholesky(matrix, coarsest_); shift *= 4) {
    if (!(shift < 1) || !matrix.allFinite()) return false;
    matrix.diagonal().array() += shift * largest;
  }
  coarse_vector_.resize(matrix.rows());
  return true;
}

void SmoothedAggregation::solve_coarsest() {
  MultigridLevel& level = levels_.back();
  const int size = level.block_size(), lanes = level.lanes();
  for (Index i = 0; i < level.num_nodes(); ++i)
    for (int d = 0; d < size; ++d) coarse_vector_[i * size + d] = static_cast<double>(level.r[i * lanes + d]);
  dense::solve_cholesky(coarsest_, coarse_vector_);
  for (Index i = 0; i < level.num_nodes(); ++i)
    for (int d = 0; d < size; ++d) level.x[i * lanes + d] = static_cast<float>(coarse_vector_[i * size + d]);
}

/// Two cycles, the second for what the first has left: cheap, for the coarse levels are small.
void SmoothedAggregation::visit_coarse(std::size_t depth) {
  MultigridLevel& level = levels_[depth];
  if (depth + 1 == levels_.size()) return cycle(depth);
  level.first_r = level.r;
  cycle(depth);
  level.first_x = level.x;
  level.multiply(level.x, level.r);
  for (std::size_t k = 0; k < level.r.size(); ++k) level.r[k] = level.first_r[k] - level.r[k];
  cycle(depth);
  for (std::size_t k = 0; k < level.x.size(); ++k) level.x[k] += level.first_x[k];
}

/// x of the level from its r, which is destroyed.
void SmoothedAggregation::cycle(std::size_t depth) {
  MultigridLevel& level = levels_[depth];
  const bool is_coarsest = depth + 1 == levels_.size();
  if (is_coarsest && is_coarsest_dense_) return solve_coarsest();
  level.pre_smooth();
  if (!is_coarsest) {
    level.restrict_to(levels_[depth + 1]);
    visit_coarse(depth + 1);
    level.prolong_from(levels_[depth + 1]);
  }
  level.post_smooth();
}

void SmoothedAggregation::apply(const VectorX& r, double norm, VectorX& z) {
  MultigridLevel& finest = levels_.front();
  const int dim = finest.dim, lanes = finest.lanes();
  const double into = 1 / norm, back = norm * scale_;
  z.resize(r.size());
  const auto num_nodes = static_cast<std::size_t>(permuted_.num_nodes());
  const Index* node_at = permuted_.node_at.data();
  parallel_for(num_nodes, nodes_per_chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      for (int d = 0; d < dim; ++d)
        finest.r[i * lanes + d] = static_cast<float>(r[node_at[i] * dim + d] * into);
  });
  cycle(0);
  parallel_for(num_nodes, nodes_per_chunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      for (int d = 0; d < dim; ++d)
        z[node_at[i] * dim + d] = back * static_cast<double>(finest.x[i * lanes + d]);
  });
}

}  // namespace

std::unique_ptr<LinearSolver> make_cg_amg(const LinearOptions& options) {
  return std::make_unique<ConjugateGradients>("cg_amg", options.max_iterations,
                                              std::make_unique<SmoothedAggregation>());
}

}  // namespace resilin
