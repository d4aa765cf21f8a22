#include "resilin/live/fold_barrier.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "resilin/core/dense.hpp"
#include "resilin/core/determinant.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/core/simd.hpp"
#include "resilin/element/catalog.hpp"

namespace resilin {
namespace {

/// Some points of cells, by their numbers in the rows of ElementBlocks::weights; ascending.
struct PointList {
  std::vector<std::size_t> points;
  PointList& operator+=(const PointList& other) {
    points.insert(points.end(), other.points.begin(), other.points.end());
    return *this;
  }
};

dense::Matrix projected_square(const dense::Matrix& matrix, Projection projection) {
  if (projection == Projection::none) return matrix;
  dense::Eigenpairs eigen = dense::symmetric_eigenpairs(matrix);
  const dense::Matrix rows = eigen.vectors.transpose();
  for (Eigen::Index k = 0; k < eigen.values.size(); ++k) {
    const double value = eigen.values[k];
    eigen.vectors.col(k) *= value < 0 && projection == Projection::clamp ? 0 : std::abs(value);
  }
  return dense::product(eigen.vectors, rows);
}

}  // namespace

/// A quadrature point as its cell's nodes make it.
template <int dim>
struct FoldBarrier::PointShape {
  std::size_t num_nodes;
  std::array<Index, max_element_nodes> nodes;               ///< in the world's numbering
  Eigen::Matrix<double, max_element_nodes, dim> gradients;  ///< dN_a/dX [1/m]
  Matrix<dim> F = Matrix<dim>::Identity();
};

FoldBarrier::FoldBarrier(std::shared_ptr<const ElasticEnergy> body, std::vector<double> stiffness)
    : body_(std::move(body)), stiffness_(std::move(stiffness)) {}

std::unique_ptr<Energy> FoldBarrier::begin_stage(const Stage&) const {
  auto own = std::make_unique<FoldBarrier>(*this);
  own->memory_.emplace();
  return own;
}

std::size_t FoldBarrier::lane_place(std::size_t point) const {
  return point / (body_->tiles().blocks.num_points * block_size) * block_size + point % block_size;
}

double FoldBarrier::stiffness_of(std::size_t point) const {
  const ElementBlocks& blocks = body_->tiles().blocks;
  const auto cell = static_cast<std::size_t>(blocks.cells[lane_place(point)]);
  return blocks.weights[point] * stiffness_[stiffness_.size() == 1 ? 0 : cell];
}

FoldBarrier::Points FoldBarrier::find_flat_points(const VectorX& x) const {
  const ElasticTiles& tiles = body_->tiles();
  const ElementBlocks& blocks = tiles.blocks;
  const std::vector<double> u = blocks.local_displacements(x);
  std::vector<Index> numbers(blocks.num_blocks);
  std::iota(numbers.begin(), numbers.end(), 0);
  Points points =
      parallel_sum<PointList>(numbers.size(), blocks_per_chunk, [&](std::size_t begin, std::size_t end) {
        PointList flat;
        ElasticTiles::Scratch scratch(tiles);
        for_tiles(tiles, numbers.data() + begin, end - begin, [&](const ElasticTiles::Tile& tile) {
          tiles.gradients(tile, u.data(), scratch, scratch.H);
          tiles.volume_cubics(tile, scratch.H, scratch.H, scratch.law);  // J is the first number
          const std::size_t first = static_cast<std::size_t>(tile.blocks[0]) * blocks.num_points;
          for (std::size_t entry = 0; entry < tiles.num_entries(tile); ++entry) {
            const double* J = scratch.law + entry * 4 * block_size;
            const auto is_roomy = [](double ratio) { return ratio >= activation_ratio; };
            if (std::all_of(J, J + block_size, is_roomy)) continue;
            for (std::size_t lane = 0; lane < block_size; ++lane)
              if (!is_roomy(J[lane])) flat.points.push_back((first + entry) * block_size + lane);
          }
        });
        return flat;
      }).points;
  std::erase_if(points, [&](std::size_t point) { return blocks.cells[lane_place(point)] < 0; });
  return points;
}

FoldBarrier::Points FoldBarrier::flat_points(const VectorX& x) const {
  if (is_resting_) return {};
  if (known_.is_of(x)) return known_.points;
  if (!memory_) return find_flat_points(x);
  auto& [newer, older] = *memory_;
  if (newer.is_of(x)) return newer.points;
  std::swap(newer, older);
  if (!newer.is_of(x)) newer = {x, find_flat_points(x)};
  return newer.points;
}

template <int dim>
FoldBarrier::PointShape<dim> FoldBarrier::shape_of(std::size_t point, const VectorX& x) const {
  const ElementBlocks& blocks = body_->tiles().blocks;
  const auto n = static_cast<std::size_t>(blocks.num_nodes), d = static_cast<std::size_t>(dim);
  const std::size_t lane = point % block_size, entry = point / block_size;
  const std::size_t block = entry / blocks.num_points, q = entry % blocks.num_points;
  PointShape<dim> shape{.num_nodes = n, .nodes = {}, .gradients = {}};
  shape.gradients.setZero();
  for (std::size_t a = 0; a < n; ++a) {
    const auto row = static_cast<Eigen::Index>(a);
    for (std::size_t k = 0; k < d; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      double& slope = shape.gradients(row, column);
      if (!blocks.is_linear_simplex()) {
        for (std::size_t m = 0; m < d; ++m)
          slope += blocks.reference_gradients[(q * n + a) * d + m] *
                   blocks.gradients[(entry * d * d + m * d + k) * block_size + lane];
      } else if (a > 0) {
        slope = blocks.gradients[((block * (n - 1) + a - 1) * d + k) * block_size + lane];
        shape.gradients(0, column) -= slope;
      }
    }
  }
  for (std::size_t a = 0; a < n; ++a) {
    const auto row = static_cast<Eigen::Index>(a);
    const auto local = static_cast<std::size_t>(blocks.nodes[(block * n + a) * block_size + lane]);
    shape.nodes[a] = blocks.world_nodes[local];
    const Vector<dim> u =
        x.segment<dim>(Eigen::Index{shape.nodes[a]} * dim) -
        Eigen::Map<const Vector<dim>>(blocks.rest_positions.data() + local * blocks.stride());
    shape.F += u * shape.gradients.row(row);
  }
  return shape;
}

double FoldBarrier::volume_ratio(std::size_t point, const VectorX& x) const {
  return body_->tiles().blocks.dim == 2 ? shape_of<2>(point, x).F.determinant()
                                        : shape_of<3>(point, x).F.determinant();
}

/// J on the way: det(F + t G).
VolumeCubic FoldBarrier::volume_cubic(std::size_t point, const VectorX& x, const VectorX& end) const {
  const auto cubic = [](const auto& F, const auto& F_end) {
    const auto G = (F_end - F).eval();
    const double a = F.determinant(), b = cofactor(F).cwiseProduct(G).sum(), d = G.determinant();
    if (F.rows() == 2) return VolumeCubic{a, b, d, 0};
    return VolumeCubic{a, b, F.cwiseProduct(cofactor(G)).sum(), d};
  };
  return body_->tiles().blocks.dim == 2 ? cubic(shape_of<2>(point, x).F, shape_of<2>(point, end).F)
                                        : cubic(shape_of<3>(point, x).F, shape_of<3>(point, end).F);
}

double FoldBarrier::value(const VectorX& x, const Conditions&) const {
  double sum = 0;
  for (const std::size_t point : flat_points(x))
    sum += stiffness_of(point) * barrier_.value(volume_ratio(point, x));
  return sum;
}

double FoldBarrier::difference(const VectorX& from, const VectorX& to, const Conditions&) const {
  const Points before = flat_points(from), after = flat_points(to);
  Points points;
  std::ranges::set_union(before, after, std::back_inserter(points));
  double sum = 0;
  for (const std::size_t point : points) {
    const double J = volume_ratio(point, from);
    sum += stiffness_of(point) * barrier_.difference(J, volume_ratio(point, to) - J);
  }
  return sum;
}

template <int dim>
void FoldBarrier::add_forces(const VectorX& x, bool is_magnitude, VectorX& forces) const {
  for (const std::size_t point : flat_points(x)) {
    const PointShape<dim> shape = shape_of<dim>(point, x);
    const Matrix<dim> P = stiffness_of(point) * barrier_.slope(shape.F.determinant()) * cofactor(shape.F);
    for (std::size_t a = 0; a < shape.num_nodes; ++a) {
      const Vector<dim> force = P * shape.gradients.row(static_cast<Eigen::Index>(a)).transpose();
      forces.segment<dim>(Eigen::Index{shape.nodes[a]} * dim) +=
          is_magnitude ? Vector<dim>(force.cwiseAbs()) : force;
    }
  }
}

void FoldBarrier::add_gradient(const VectorX& x, const Conditions&, VectorX& gradient) const {
  body_->tiles().blocks.dim == 2 ? add_forces<2>(x, false, gradient) : add_forces<3>(x, false, gradient);
}

void FoldBarrier::add_gradient_magnitude(const VectorX& x, const Conditions&, VectorX& magnitude) const {
  body_->tiles().blocks.dim == 2 ? add_forces<2>(x, true, magnitude) : add_forces<3>(x, true, magnitude);
}

// d2/dF2 V k b(J) = V k (b'' c c^T + b' d2J/dF2), c = dJ/dF; the first term is never negative.
template <int dim>
void FoldBarrier::add_point_hessians(const VectorX& x, Projection projection, BlockMatrix& hessian) const {
  using Tangent = Eigen::Matrix<double, dim * dim, dim * dim>;
  for (const std::size_t point : flat_points(x)) {
    const PointShape<dim> shape = shape_of<dim>(point, x);
    const double J = shape.F.determinant();
    const Matrix<dim> C = cofactor(shape.F);
    const Eigen::Map<const Eigen::Matrix<double, dim * dim, 1>> c(C.data());
    Tangent A = projected_square(barrier_.slope(J) * determinant_hessian<dim>(shape.F), projection);
    A += barrier_.curvature(J) * c * c.transpose();
    A *= stiffness_of(point);
    for (std::size_t a = 0; a < shape.num_nodes; ++a)
      for (std::size_t b = a; b < shape.num_nodes; ++b) {
        Eigen::Matrix<double, dim, dim, Eigen::RowMajor> block;
        block.setZero();
        for (int j = 0; j < dim; ++j)
          for (int l = 0; l < dim; ++l)
            block += shape.gradients(static_cast<Eigen::Index>(a), j) *
                     shape.gradients(static_cast<Eigen::Index>(b), l) *
                     A.template block<dim, dim>(dim * j, dim * l);
        hessian.add_block(shape.nodes[a], shape.nodes[b], block.data());
      }
  }
}

void FoldBarrier::add_hessian(const VectorX& x, const Conditions&, Projection projection,
                              BlockMatrix& hessian) const {
  body_->tiles().blocks.dim == 2 ? add_point_hessians<2>(x, projection, hessian)
                                 : add_point_hessians<3>(x, projection, hessian);
}

double FoldBarrier::max_step(const VectorX& x, const VectorX& p, const Conditions&) const {
  if (is_resting_) return 1;
  const VectorX end = x + p;
  const Points before = flat_points(x), after = flat_points(end);
  double step = 1;
  for (const Points& points : {before, after})
    for (const std::size_t point : points) step = inversion_free_step(volume_cubic(point, x, end), step);
  // Cells that turn are flat on the way alone.
  while (step > 0 && step < 1 && !is_upright(flat_points(x + step * p), x + step * p)) step *= 0.9;
  return step;
}

bool FoldBarrier::is_upright(const Points& points, const VectorX& x) const {
  return std::ranges::all_of(points, [&](std::size_t point) { return volume_ratio(point, x) > 0; });
}

void FoldBarrier::look_at(const VectorX& x) {
  known_ = {x, find_flat_points(x)};
  if (known_.points.empty()) is_resting_ = false;
  if (!is_upright(known_.points, x)) is_resting_ = true;
}

}  // namespace resilin
