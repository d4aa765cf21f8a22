#include "resilin/fields/patch_recovery.hpp"

#include <algorithm>
#include <limits>

#include "resilin/core/dense.hpp"
#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr int max_monomials = 10;
constexpr std::size_t patches_per_chunk = 64;
constexpr int ample_points = 2;  ///< for each monomial; with fewer, a patch is widened
constexpr int max_widenings = 3;
/// Least pivot of a fit. Points may be many and yet all lie on one quadric, as those of a cube of six
/// tetrahedra do.
constexpr double least_pivot = 1e-2;
constexpr double least_variance = 1e-12;  ///< least variance of points, as a share of the largest

using Monomials = Eigen::Matrix<double, 1, max_monomials>;

/// 1, s, t, r, then s^2, t^2, r^2, s t, s r, t r; those of the plane are 1, s, t, s^2, t^2, s t.
Monomials monomials(const Vector3& s, int dim) {
  Monomials m = Monomials::Zero();
  if (dim == 2) {
    m.head<6>() << 1, s[0], s[1], s[0] * s[0], s[1] * s[1], s[0] * s[1];
  } else {
    m << 1, s[0], s[1], s[2], s[0] * s[0], s[1] * s[1], s[2] * s[2], s[0] * s[1], s[0] * s[2], s[1] * s[2];
  }
  return m;
}

}  // namespace

RestPlaces::RestPlaces(const Body& body, const VectorX& rest_positions, const QuadratureRule& rule)
    : body_(body),
      rest_positions_(rest_positions),
      dim_(body.domains.element().dim),
      num_nodes_(static_cast<std::size_t>(body.domains.element().num_nodes)),
      shapes_(rule.points.size() * num_nodes_) {
  for (std::size_t q = 0; q < rule.points.size(); ++q)
    body.domains.element().shape_values(rule.points[q].xi,
                                        std::span(shapes_).subspan(q * num_nodes_, num_nodes_));
}

Vector3 RestPlaces::of(std::size_t cell, std::size_t point) const {
  Vector3 place = Vector3::Zero();
  for (std::size_t a = 0; a < num_nodes_; ++a) {
    const Eigen::Index node = body_.cells[cell * num_nodes_ + a];
    place.head(dim_) += shapes_[point * num_nodes_ + a] * rest_positions_.segment(node * dim_, dim_);
  }
  return place;
}

PatchRecovery::PatchRecovery(const Body& body, const VectorX& rest_positions, int dim,
                             std::span<const Index> materials)
    : dim_(dim),
      degree_(body.domains.element().degree),
      num_corners_(static_cast<std::size_t>(body.domains.element().num_corners())),
      num_points_(static_cast<std::size_t>(body.domains.num_points())),
      around_end_(static_cast<std::size_t>(body.num_nodes) + 1, 0),
      points_(static_cast<std::size_t>(body.num_cells()) * num_points_) {
  const RestPlaces places(body, rest_positions, body.domains.quadrature());
  for (std::size_t i = 0; i < points_.size(); ++i) points_[i] = places.of(i / num_points_, i % num_points_);
  const auto width = static_cast<std::size_t>(body.domains.element().num_nodes);
  for (std::size_t begin = 0; begin < body.cells.size(); begin += width)
    for (std::size_t a = 0; a < num_corners_; ++a)
      corners_.push_back(body.cells[begin + a] - body.first_node);
  for (const Index node : corners_) ++around_end_[static_cast<std::size_t>(node) + 1];
  for (std::size_t i = 1; i < around_end_.size(); ++i) around_end_[i] += around_end_[i - 1];
  around_.resize(corners_.size());
  std::vector<std::size_t> next(around_end_.begin(), around_end_.end() - 1);
  for (std::size_t i = 0; i < corners_.size(); ++i)
    around_[next[static_cast<std::size_t>(corners_[i])]++] = static_cast<Index>(i / num_corners_);
  add_patches(materials);
}

std::span<const Index> PatchRecovery::cells_around(Index vertex) const {
  const auto v = static_cast<std::size_t>(vertex);
  return std::span(around_).subspan(around_end_[v], around_end_[v + 1] - around_end_[v]);
}

int PatchRecovery::num_monomials(int degree) const {
  const int linear = 1 + dim_;
  return degree == 0 ? 1 : degree == 1 ? linear : linear + dim_ * (dim_ + 1) / 2;
}

/// One for each vertex and each material around it.
void PatchRecovery::add_patches(std::span<const Index> materials) {
  patch_of_.resize(corners_.size());
  patches_.reserve(around_end_.size() - 1);
  for (Index vertex = 0; vertex + std::size_t{1} < around_end_.size(); ++vertex) {
    const std::size_t first = patches_.size();
    for (const Index cell : cells_around(vertex)) {
      const auto c = static_cast<std::size_t>(cell);
      std::size_t patch = first;
      while (patch < patches_.size() &&
             materials[static_cast<std::size_t>(patches_[patch].cells.front())] != materials[c])
        ++patch;
      if (patch == patches_.size()) patches_.emplace_back();
      patches_[patch].cells.push_back(cell);
      const auto own = corners_of(c);
      const auto local = static_cast<std::size_t>(std::ranges::find(own, vertex) - own.begin());
      patch_of_[c * num_corners_ + local] = static_cast<Index>(patch);
    }
  }
  parallel_for(patches_.size(), patches_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) widen(patches_[i], materials);
  });
  for (const Patch& patch : patches_) has_enough_points_ = has_enough_points_ || patch.degree > 0;
}

/// Takes in the cells around as long as the points do not tell the polynomial, and says of which degree it
/// can be.
void PatchRecovery::widen(Patch& patch, std::span<const Index> materials) const {
  const auto tells = [&](int degree, int points_per_monomial) {
    Eigen::MatrixXd A = monomials_of(patch, degree);
    if (A.rows() < points_per_monomial * A.cols()) return false;
    A.colwise().normalize();
    return dense::rank(A, least_pivot) == A.cols();
  };
  const Index material = materials[static_cast<std::size_t>(patch.cells.front())];
  place(patch);
  for (int widening = 0; widening < max_widenings && !tells(degree_, ample_points); ++widening) {
    std::vector<Index> wider;
    for (const Index cell : patch.cells)
      for (const Index vertex : corners_of(static_cast<std::size_t>(cell)))
        for (const Index other : cells_around(vertex))
          if (materials[static_cast<std::size_t>(other)] == material) wider.push_back(other);
    std::ranges::sort(wider);
    wider.erase(std::unique(wider.begin(), wider.end()), wider.end());
    patch.cells = std::move(wider);
    place(patch);
  }
  for (patch.degree = degree_; patch.degree > 0 && !tells(patch.degree, 1);) --patch.degree;
}

/// Centre and scale from mean and covariance of the points.
void PatchRecovery::place(Patch& patch) const {
  const auto for_each_patch_point = [&](const auto& visit) {
    for (const Index cell : patch.cells)
      for (std::size_t q = 0; q < num_points_; ++q)
        visit(points_[static_cast<std::size_t>(cell) * num_points_ + q]);
  };
  const auto count = static_cast<double>(patch.cells.size() * num_points_);
  patch.center.setZero();
  for_each_patch_point([&](const Vector3& X) { patch.center += X / count; });
  Matrix<3> covariance = Matrix<3>::Zero();
  for_each_patch_point(
      [&](const Vector3& X) { covariance += (X - patch.center) * (X - patch.center).transpose() / count; });
  if (dim_ == 2) covariance(2, 2) = covariance.trace();
  const dense::Eigenpairs3 eigen = dense::symmetric_eigenpairs3(covariance);
  const double largest = std::max(eigen.values[2], std::numeric_limits<double>::min());
  const Vector3 variances = eigen.values.cwiseMax(least_variance * largest);
  patch.scale = eigen.vectors * variances.cwiseSqrt().cwiseInverse().asDiagonal() * eigen.vectors.transpose();
}

Eigen::MatrixXd PatchRecovery::monomials_of(const Patch& patch, int degree) const {
  const int count = num_monomials(degree);
  Eigen::MatrixXd A(static_cast<Eigen::Index>(patch.cells.size() * num_points_), count);
  Eigen::Index row = 0;
  for (const Index cell : patch.cells) {
    for (std::size_t q = 0; q < num_points_; ++q) {
      const Vector3& X = points_[static_cast<std::size_t>(cell) * num_points_ + q];
      A.row(row++) = monomials(patch.scale * (X - patch.center), dim_).head(count);
    }
  }
  return A;
}

void PatchRecovery::fit(std::span<const SymmetricTensor> point_values) {
  const Eigen::Index count = num_monomials(degree_);
  coefficients_.assign(patches_.size() * static_cast<std::size_t>(6 * count), 0.0);
  parallel_for(patches_.size(), patches_per_chunk, [&](std::size_t begin, std::size_t end) {
    Eigen::MatrixXd b;
    for (std::size_t i = begin; i < end; ++i) {
      const Patch& patch = patches_[i];
      const Eigen::MatrixXd A = monomials_of(patch, patch.degree);
      b.resize(A.rows(), 6);
      Eigen::Index row = 0;
      for (const Index cell : patch.cells)
        for (std::size_t q = 0; q < num_points_; ++q)
          b.row(row++) = point_values[static_cast<std::size_t>(cell) * num_points_ + q].transpose();
      Coefficients(&coefficients_[i * static_cast<std::size_t>(6 * count)], 6, count).leftCols(A.cols()) =
          dense::least_squares(A, b).transpose();
    }
  });
}

SymmetricTensor PatchRecovery::value(std::size_t cell, std::span<const double> corner_shapes,
                                     const Vector3& X) const {
  const Eigen::Index count = num_monomials(degree_);
  SymmetricTensor blended = SymmetricTensor::Zero();
  for (std::size_t a = 0; a < num_corners_; ++a) {
    const auto number = static_cast<std::size_t>(patch_of_[cell * num_corners_ + a]);
    const Patch& patch = patches_[number];
    blended += corner_shapes[a] *
               (ConstCoefficients(&coefficients_[number * static_cast<std::size_t>(6 * count)], 6, count) *
                monomials(patch.scale * (X - patch.center), dim_).head(count).transpose());
  }
  return blended;
}

}  // namespace resilin
