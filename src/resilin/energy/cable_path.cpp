#include "resilin/energy/cable_path.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace resilin {

Vector3 CarriedPoint::at(int dim, const VectorX& x) const {
  Vector3 sum = place;
  for (const auto& [node, weight] : nodes) sum += weight * node_position(dim, node, x);
  return sum;
}

std::vector<Vector3> CablePath::pieces(const VectorX& x) const {
  std::vector<Vector3> vectors;
  Vector3 last = points_.front().at(dim_, x);
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const Vector3 next = points_[i].at(dim_, x);
    vectors.emplace_back(next - last);
    last = next;
  }
  return vectors;
}

double CablePath::length(const VectorX& x) const {
  double sum = 0;
  for (const Vector3& piece : pieces(x)) sum += piece.norm();
  return sum;
}

// |b| - |a| = (b - a).(b + a) / (|b| + |a|) keeps its digits when a and b are close.
std::vector<double> CablePath::lengthening(const VectorX& from, const VectorX& to) const {
  const std::vector<Vector3> a = pieces(from), b = pieces(to), way = pieces(to - from);
  std::vector<double> longer(a.size(), 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double sum = a[i].norm() + b[i].norm();
    const bool moves = !points_[i].nodes.empty() && !points_[i + 1].nodes.empty();
    const Vector3 change = moves ? way[i] : Vector3(b[i] - a[i]);
    if (sum > 0) longer[i] = change.dot(b[i] + a[i]) / sum;
  }
  return longer;
}

std::vector<double> CablePath::first_order_lengthening(const VectorX& x, const VectorX& way) const {
  const std::vector<Vector3> vectors = pieces(x);
  const auto way_of = [&](const CarriedPoint& point) {
    Vector3 sum = Vector3::Zero();
    for (const auto& [node, weight] : point.nodes) sum += weight * node_position(dim_, node, way);
    return sum;
  };
  std::vector<double> longer(vectors.size(), 0.0);
  Vector3 last = way_of(points_.front());
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const Vector3 next = way_of(points_[i + 1]);
    const double norm = vectors[i].norm();
    if (norm > 0) longer[i] = vectors[i].dot(next - last) / norm;
    last = next;
  }
  return longer;
}

std::vector<double> CablePath::turns(const VectorX& x) const {
  const std::vector<Vector3> vectors = pieces(x);
  std::vector<double> angles;
  for (std::size_t i = 1; i < vectors.size(); ++i)
    angles.push_back(std::atan2(vectors[i - 1].cross(vectors[i]).norm(), vectors[i - 1].dot(vectors[i])));
  return angles;
}

std::vector<Vector3> CablePath::pulls(const VectorX& x, std::span<const double> factors) const {
  std::vector<Vector3> pulls(points_.size(), Vector3::Zero());
  const std::vector<Vector3> vectors = pieces(x);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const double norm = vectors[i].norm();
    if (!(norm > 0)) continue;
    const Vector3 pull = factors[i] * (vectors[i] / norm);
    pulls[i] -= pull;
    pulls[i + 1] += pull;
  }
  return pulls;
}

void CablePath::add_slopes(const VectorX& x, std::span<const double> factors, VectorX& gradient) const {
  const std::vector<Vector3> all = pulls(x, factors);
  for (std::size_t i = 0; i < points_.size(); ++i)
    for (const auto& [node, weight] : points_[i].nodes)
      gradient.segment(Eigen::Index{node} * dim_, dim_) += weight * all[i].head(dim_);
}

void CablePath::add_slope_magnitudes(const VectorX& x, std::span<const double> factors,
                                     VectorX& magnitude) const {
  const std::vector<Vector3> vectors = pieces(x);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const double norm = vectors[i].norm();
    if (!(norm > 0)) continue;
    for (const std::size_t end : {i, i + 1})
      for (const auto& [node, weight] : points_[end].nodes)
        magnitude.segment(Eigen::Index{node} * dim_, dim_) +=
            std::abs(factors[i] * weight) * (vectors[i] / norm).cwiseAbs().head(dim_);
  }
}

void CablePath::add_blocks(std::size_t i, std::size_t j, const Matrix<3>& block, BlockMatrix& hessian) const {
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 3, 3>;
  for (const auto& [row, row_weight] : points_[i].nodes)
    for (const auto& [column, column_weight] : points_[j].nodes) {
      if (column < row) continue;  // its transpose comes from (j, i)
      const Block part = row_weight * column_weight * block.topLeftCorner(dim_, dim_);
      hessian.add_block(row, column, part.data());
    }
}

void CablePath::add_curvatures(const VectorX& x, std::span<const double> factors,
                               BlockMatrix& hessian) const {
  const std::vector<Vector3> vectors = pieces(x);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const double norm = vectors[i].norm();
    if (!(norm > 0) || factors[i] == 0) continue;
    const Vector3 n = vectors[i] / norm;
    const Matrix<3> across = factors[i] / norm * (Matrix<3>::Identity() - n * n.transpose());
    add_blocks(i, i, across, hessian);
    add_blocks(i + 1, i + 1, across, hessian);
    add_blocks(i, i + 1, -across, hessian);
    add_blocks(i + 1, i, -across, hessian);
  }
}

void CablePath::add_square(const VectorX& x, std::span<const double> weights, double factor,
                           BlockMatrix& hessian) const {
  const std::vector<Vector3> all = pulls(x, weights);
  for (std::size_t i = 0; i < points_.size(); ++i)
    for (std::size_t j = 0; j < points_.size(); ++j)
      add_blocks(i, j, factor * all[i] * all[j].transpose(), hessian);
}

void CablePath::add_pattern(BlockPatternBuilder& builder) const {
  std::vector<Index> nodes;
  for (const CarriedPoint& point : points_)
    for (const WeightedNode& each : point.nodes) nodes.push_back(each.node);
  builder.add_clique(nodes);
}

}  // namespace resilin
