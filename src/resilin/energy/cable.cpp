#include "resilin/energy/cable.hpp"

#include <cmath>
#include <utility>

namespace resilin {

namespace {

/// Whether it is a spring of rest length 0: its energy k/2 |p_2 - p_1|^2 is smooth where the ends coincide.
bool is_linear_spring(const std::vector<CarriedPoint>& points, const Cable::Law& law) {
  return points.size() == 2 && law.rest_length == 0 && law.shortening == 0 && !law.tension;
}

}  // namespace

Vector3 CarriedPoint::at(int dim, const VectorX& x) const {
  Vector3 sum = place;
  for (const auto& [node, weight] : nodes) sum += weight * node_position(dim, node, x);
  return sum;
}

Cable::Cable(std::string name, int dim, std::vector<CarriedPoint> points, Law law)
    : name_(std::move(name)), dim_(dim), points_(std::move(points)), law_(std::move(law)) {}

std::vector<Vector3> Cable::pieces(const VectorX& x) const {
  std::vector<Vector3> vectors;
  Vector3 last = points_.front().at(dim_, x);
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const Vector3 next = points_[i].at(dim_, x);
    vectors.emplace_back(next - last);
    last = next;
  }
  return vectors;
}

double Cable::length(const VectorX& x) const {
  double sum = 0;
  for (const Vector3& piece : pieces(x)) sum += piece.norm();
  return sum;
}

Vector3 Cable::first_direction(const VectorX& x) const { return -pulls(x).front(); }

double Cable::stretch(double length, const Conditions& c) const {
  const double shortened = law_.shortening == 0 ? 0 : law_.function.factor(c.time, c.load) * law_.shortening;
  const double stretch = length - law_.rest_length + shortened;
  return law_.tension_only && stretch < 0 ? 0 : stretch;
}

double Cable::slope(double length, const Conditions& c) const {
  if (law_.tension) return law_.function.factor(c.time, c.load) * *law_.tension;
  return law_.stiffness * stretch(length, c);
}

double Cable::curvature(double length, const Conditions& c) const {
  if (law_.tension || (law_.tension_only && stretch(length, c) == 0)) return 0;
  return law_.stiffness;
}

double Cable::value(const VectorX& x, const Conditions& c) const {
  const double l = length(x);
  if (law_.tension) return slope(l, c) * (l - law_.rest_length);
  const double s = stretch(l, c);
  return 0.5 * law_.stiffness * s * s;
}

// |b| - |a| = (b - a).(b + a) / (|b| + |a|) keeps its digits when a and b are close.
double Cable::difference(const VectorX& from, const VectorX& to, const Conditions& c) const {
  const std::vector<Vector3> a = pieces(from), b = pieces(to), way = pieces(to - from);
  double longer = 0, length_from = 0, length_to = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double sum = a[i].norm() + b[i].norm();
    const bool moves = !points_[i].nodes.empty() && !points_[i + 1].nodes.empty();
    const Vector3 change = moves ? way[i] : Vector3(b[i] - a[i]);
    if (sum > 0) longer += change.dot(b[i] + a[i]) / sum;
    length_from += a[i].norm();
    length_to += b[i].norm();
  }
  if (law_.tension) return slope(length_to, c) * longer;
  const double s_from = stretch(length_from, c), s_to = stretch(length_to, c);
  const bool is_taut = !law_.tension_only || (s_from > 0 && s_to > 0);
  return 0.5 * law_.stiffness * (is_taut ? longer : s_to - s_from) * (s_to + s_from);
}

std::vector<Vector3> Cable::pulls(const VectorX& x) const {
  std::vector<Vector3> pulls(points_.size(), Vector3::Zero());
  const std::vector<Vector3> vectors = pieces(x);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const double norm = vectors[i].norm();
    if (!(norm > 0)) continue;
    pulls[i] -= vectors[i] / norm;
    pulls[i + 1] += vectors[i] / norm;
  }
  return pulls;
}

void Cable::add_gradient(const VectorX& x, const Conditions& c, VectorX& gradient) const {
  const double tension = slope(length(x), c);
  const std::vector<Vector3> all = pulls(x);
  for (std::size_t i = 0; i < points_.size(); ++i)
    for (const auto& [node, weight] : points_[i].nodes)
      gradient.segment(Eigen::Index{node} * dim_, dim_) += tension * weight * all[i].head(dim_);
}

void Cable::add_gradient_magnitude(const VectorX& x, const Conditions& c, VectorX& magnitude) const {
  const double l = length(x);
  const double shortened = std::abs(law_.shortening * law_.function.factor(c.time, c.load));
  const double tension =
      law_.tension ? std::abs(slope(l, c)) : law_.stiffness * (l + std::abs(law_.rest_length) + shortened);
  const std::vector<Vector3> vectors = pieces(x);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const double norm = vectors[i].norm();
    if (!(norm > 0)) continue;
    for (const std::size_t end : {i, i + 1})
      for (const auto& [node, weight] : points_[end].nodes)
        magnitude.segment(Eigen::Index{node} * dim_, dim_) +=
            tension * std::abs(weight) * (vectors[i] / norm).cwiseAbs().head(dim_);
  }
}

void Cable::add_blocks(std::size_t i, std::size_t j, const Matrix<3>& block, BlockMatrix& hessian) const {
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 3, 3>;
  for (const auto& [row, row_weight] : points_[i].nodes)
    for (const auto& [column, column_weight] : points_[j].nodes) {
      if (column < row) continue;  // its transpose comes from (j, i)
      const Block part = row_weight * column_weight * block.topLeftCorner(dim_, dim_);
      hessian.add_block(row, column, part.data());
    }
}

void Cable::add_hessian(const VectorX& x, const Conditions& c, Projection projection,
                        BlockMatrix& hessian) const {
  const double l = length(x), k = curvature(l, c);
  if (l == 0 && is_linear_spring(points_, law_)) {
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j)
        add_blocks(i, j, (i == j ? law_.stiffness : -law_.stiffness) * Matrix<3>::Identity(), hessian);
    return;
  }
  double tension = slope(l, c);
  if (tension < 0 && projection == Projection::clamp) tension = 0;
  if (projection == Projection::absolute) tension = std::abs(tension);
  const std::vector<Vector3> all = pulls(x);
  if (k != 0)
    for (std::size_t i = 0; i < points_.size(); ++i)
      for (std::size_t j = 0; j < points_.size(); ++j)
        add_blocks(i, j, k * all[i] * all[j].transpose(), hessian);
  if (tension == 0) return;
  const std::vector<Vector3> vectors = pieces(x);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const double norm = vectors[i].norm();
    if (!(norm > 0)) continue;
    const Vector3 n = vectors[i] / norm;
    const Matrix<3> across = tension / norm * (Matrix<3>::Identity() - n * n.transpose());
    add_blocks(i, i, across, hessian);
    add_blocks(i + 1, i + 1, across, hessian);
    add_blocks(i, i + 1, -across, hessian);
    add_blocks(i + 1, i, -across, hessian);
  }
}

void Cable::add_pattern(BlockPatternBuilder& builder) const {
  std::vector<Index> nodes;
  for (const CarriedPoint& point : points_)
    for (const WeightedNode& each : point.nodes) nodes.push_back(each.node);
  builder.add_clique(nodes);
}

std::optional<double> Cable::driven_work(const VectorX& from, const Conditions& before, const VectorX& to,
                                         const Conditions& after) const {
  if (law_.function.is_constant()) return std::nullopt;
  return larger_work(*this, from, before, to, after);
}

void Cable::add_held_directions(const VectorX& x, std::vector<HeldDirection>& held) const {
  if (law_.tension || points_.size() != 2 || law_.tension_only) return;
  const Vector3 along = first_direction(x);
  std::vector<Vector3> directions;
  if (along.norm() > 0)
    directions.push_back(along);
  else if (is_linear_spring(points_, law_))
    for (int axis = 0; axis < dim_; ++axis) directions.push_back(Vector3::Unit(axis));
  for (const Vector3& each : directions) {
    HeldDirection direction{.nodes = {}, .direction = each};
    for (int end = 0; end < 2; ++end)
      for (const auto& [node, weight] : points_[static_cast<std::size_t>(end)].nodes)
        direction.nodes.push_back({node, end == 0 ? weight : -weight});
    held.push_back(std::move(direction));
  }
}

}  // namespace resilin
