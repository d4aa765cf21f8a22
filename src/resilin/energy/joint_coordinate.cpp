#include "resilin/energy/joint_coordinate.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace resilin {

CarriedPoint vector_between(const CarriedPoint& from, const CarriedPoint& to, double length) {
  CarriedPoint vector{.nodes = {}, .place = (to.place - from.place) / length};
  for (const auto& [node, weight] : to.nodes) vector.nodes.push_back({node, weight / length});
  for (const auto& [node, weight] : from.nodes) vector.nodes.push_back({node, -weight / length});
  return vector;
}

JointCoordinate JointCoordinate::travel(int dim, const CarriedPoint& way, const CarriedPoint& direction) {
  return {dim, false, {way, direction}};
}

JointCoordinate JointCoordinate::angle(int dim, const CarriedPoint& turned, const CarriedPoint& along,
                                       const CarriedPoint& across) {
  return {dim, true, {turned, along, across}};
}

JointCoordinate::JointCoordinate(int dim, bool is_angle, const std::vector<CarriedPoint>& vectors)
    : dim_(dim), is_angle_(is_angle) {
  std::map<Index, Vector3> weights;
  for (std::size_t j = 0; j < vectors.size(); ++j) {
    places_[j] = vectors[j].place;
    for (const auto& [node, weight] : vectors[j].nodes)
      weights.try_emplace(node, Vector3::Zero()).first->second[static_cast<Eigen::Index>(j)] += weight;
  }
  for (std::size_t j = vectors.size(); j < 3; ++j) places_[j].setZero();
  for (const auto& [node, of_vectors] : weights) {
    nodes_.push_back(node);
    weights_.push_back(of_vectors);
  }
}

JointCoordinate::Vectors JointCoordinate::vectors(const VectorX& x) const {
  Vectors y = places_;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    for (std::size_t j = 0; j < num_vectors(); ++j)
      y[j] += weights_[i][static_cast<Eigen::Index>(j)] * node_position(dim_, nodes_[i], x);
  return y;
}

JointCoordinate::Vectors JointCoordinate::changes(const VectorX& from, const VectorX& to) const {
  Vectors y{Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    for (std::size_t j = 0; j < num_vectors(); ++j)
      y[j] += weights_[i][static_cast<Eigen::Index>(j)] *
              (node_position(dim_, nodes_[i], to) - node_position(dim_, nodes_[i], from));
  return y;
}

double JointCoordinate::value_of(const Vectors& y) const {
  return is_angle_ ? std::atan2(y[0].dot(y[2]), y[0].dot(y[1])) : y[0].dot(y[1]);
}

// With k = y_0.y_1 and s = y_0.y_2 the angle between two states has the tangent
// (ds k - dk s) / (k k' + s s'), and ds = dy_0.(y_2 + y_2') / 2 + (y_0 + y_0').dy_2 / 2.
double JointCoordinate::change(const VectorX& from, const VectorX& to) const {
  const Vectors a = vectors(from), b = vectors(to), d = changes(from, to);
  const auto change_of_product = [&](std::size_t j) {
    return 0.5 * (d[0].dot(a[j] + b[j]) + d[j].dot(a[0] + b[0]));
  };
  const double dk = change_of_product(1);
  if (!is_angle_) return dk;
  const double ds = change_of_product(2);
  const double k = a[0].dot(a[1]), s = a[0].dot(a[2]);
  return std::atan2(ds * k - dk * s, b[0].dot(b[1]) * k + b[0].dot(b[2]) * s);
}

JointCoordinate::Vector JointCoordinate::slopes_of(const Vectors& y) const {
  Vector slopes(size());
  if (!is_angle_) {
    slopes << y[1], y[0];
    return slopes;
  }
  const double k = y[0].dot(y[1]), s = y[0].dot(y[2]), square = k * k + s * s;
  slopes << (k * y[2] - s * y[1]) / square, -s / square * y[0], k / square * y[0];
  return slopes;
}

JointCoordinate::Square JointCoordinate::curvatures(const VectorX& x) const {
  const Vectors y = vectors(x);
  Square H = Square::Zero(size(), size());
  const auto add = [&H](Eigen::Index i, Eigen::Index j, double value) {
    H.block<3, 3>(3 * i, 3 * j).diagonal().array() += value;
    H.block<3, 3>(3 * j, 3 * i).diagonal().array() += value;
  };
  if (!is_angle_) {
    add(0, 1, 1);
    return H;
  }
  const double k = y[0].dot(y[1]), s = y[0].dot(y[2]), square = k * k + s * s;
  add(0, 1, -s / square);
  add(0, 2, k / square);
  Vector dk(9), ds(9);
  dk << y[1], y[0], Vector3::Zero();
  ds << y[2], Vector3::Zero(), y[0];
  const double twice = 2 * s * k / (square * square), cross = (s * s - k * k) / (square * square);
  H += twice * (dk * dk.transpose() - ds * ds.transpose()) +
       cross * (dk * ds.transpose() + ds * dk.transpose());
  return H;
}

double JointCoordinate::magnitude(const VectorX& x) const {
  Vectors parts;
  for (std::size_t j = 0; j < 3; ++j) parts[j] = places_[j].cwiseAbs();
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    for (std::size_t j = 0; j < num_vectors(); ++j)
      parts[j] +=
          std::abs(weights_[i][static_cast<Eigen::Index>(j)]) * node_position(dim_, nodes_[i], x).cwiseAbs();
  const Vector all = slopes(x).cwiseAbs();
  double sum = 0;
  for (std::size_t j = 0; j < num_vectors(); ++j)
    sum += all.segment<3>(3 * static_cast<Eigen::Index>(j)).dot(parts[j]);
  return sum;
}

double JointCoordinate::rate(const VectorX& x, const VectorX& v) const {
  return rate(x, VectorX::Zero(v.size()), v);
}

double JointCoordinate::rate(const VectorX& shape, const VectorX& from, const VectorX& to) const {
  const Vector all = slopes(shape);
  const Vectors way = changes(from, to);
  double sum = 0;
  for (std::size_t j = 0; j < num_vectors(); ++j)
    sum += all.segment<3>(3 * static_cast<Eigen::Index>(j)).dot(way[j]);
  return sum;
}

void JointCoordinate::add_forces(const Vector& f, VectorX& gradient) const {
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    for (Eigen::Index j = 0; j < size() / 3; ++j)
      gradient.segment(Eigen::Index{nodes_[i]} * dim_, dim_) += weights_[i][j] * f.segment(3 * j, dim_);
}

void JointCoordinate::add_magnitudes(const Vector& f, VectorX& magnitude) const {
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    for (Eigen::Index j = 0; j < size() / 3; ++j)
      magnitude.segment(Eigen::Index{nodes_[i]} * dim_, dim_) +=
          std::abs(weights_[i][j]) * f.segment(3 * j, dim_).cwiseAbs();
}

void JointCoordinate::add_blocks(const Square& K, BlockMatrix& hessian) const {
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 3, 3>;
  for (std::size_t a = 0; a < nodes_.size(); ++a)
    for (std::size_t b = a; b < nodes_.size(); ++b) {
      Block block = Block::Zero(dim_, dim_);
      for (Eigen::Index i = 0; i < size() / 3; ++i)
        for (Eigen::Index j = 0; j < size() / 3; ++j)
          block += weights_[a][i] * weights_[b][j] * K.block(3 * i, 3 * j, dim_, dim_);
      hessian.add_block(nodes_[a], nodes_[b], block.data());
    }
}

}  // namespace resilin
