#include "resilin/sensitivity/stress_at_place.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/material/plane_stress.hpp"
#include "resilin/mesh/cell_positions.hpp"
#include "resilin/mesh/embedding.hpp"
#include "resilin/sensitivity/constant_slopes.hpp"

namespace resilin {
namespace {

struct Component {
  std::string_view name;
  int row, column;
};
constexpr Component components[] = {{"xx", 0, 0}, {"yy", 1, 1}, {"zz", 2, 2},
                                    {"xy", 0, 1}, {"yz", 1, 2}, {"zx", 2, 0}};

/// A : B
double contracted(const Matrix<3>& A, const Matrix<3>& B) { return A.cwiseProduct(B).sum(); }

/// sum_a v_a (x) g_a, in 2D with zeros, of dim numbers of each node.
Matrix<3> gradient_of(int dim, std::span<const double> values, std::span<const double> dN_dX) {
  Matrix<3> sum = Matrix<3>::Zero();
  const auto d = static_cast<std::size_t>(dim);
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t k = 0; k < d; ++k)
      sum(static_cast<int>(i % d), static_cast<int>(k)) += values[i] * dN_dX[i / d * d + k];
  return sum;
}

/// M g_a for each node.
std::vector<double> at_nodes(int dim, const Matrix<3>& M, std::span<const double> dN_dX) {
  const auto d = static_cast<std::size_t>(dim);
  std::vector<double> values(dN_dX.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t k = 0; k < d; ++k)
      values[i] += M(static_cast<int>(i % d), static_cast<int>(k)) * dN_dX[i / d * d + k];
  return values;
}

Matrix<3> cofactor(const Matrix<3>& F) { return F.determinant() * F.inverse().transpose(); }

/// dP/dc for the constant of this place.
Matrix<3> constant_stress(const Material& material, const Matrix<3>& H, std::size_t constant) {
  using RowMatrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const RowMatrix rows = H;
  StateBatch<double> state{.law = material.law,
                           .dim = 3,
                           .count = 1,
                           .deformation_gradients = rows.data(),
                           .holds_displacement_gradients = true,
                           .constants = {}};
  for (const double& number : material.constants) state.constants.push_back({&number, 0});
  if (!material.fibres.empty()) state.fibres = material.fibres.front().data();
  state.num_fibres = material.fibres.size();
  RowMatrix dP;
  constant_derivatives<double>(state, constant, nullptr, dP.data());
  return dP;
}

}  // namespace

StressAtPlace::StressAtPlace(const World& world, const Body& body, const Vector3& at,
                             const std::string& place)
    : world_(world), body_(body), material_{nullptr, {}, {}} {
  const int dim = world.dimension;
  const ElementInfo& element = body.domains.element();
  while (&world.bodies[body_number_] != &body) ++body_number_;
  std::vector<Vector3> points = {at - world.origin};
  if (dim == 2) points[0][2] = 0;
  const Embedding embedding(element, body.cells, world.rest_positions, points);
  if (const Embedding::Outside& outside = embedding.outside(); outside.count > 0)
    throw InputError(place, "a point inside " + body.name + " in the reference configuration",
                     format_point(at, dim) + ", " + format_short(outside.distance) + " m outside",
                     "give the points by their reference positions");
  cell_ = embedding.cell(0);
  material_ = body.domains.material(cell_);
  if (is_plane_stress(*material_.law))
    throw InputError(place, "a stress in 3D or plane strain", "one in plane stress",
                     "take displacements, forces or energies there");
  nodes_.assign(embedding.nodes(0).begin(), embedding.nodes(0).end());
  cell_positions(dim, nodes_, world.rest_positions, rest_);
  // Shape functions reproduce the reference coordinates.
  QuadraturePoint here{.xi = Vector3::Zero(), .weight = 1};
  for (std::size_t a = 0; a < nodes_.size(); ++a) here.xi += embedding.weights(0)[a] * element.nodes[a];
  gradients_ = point_geometry(element, here, rest_).gradients;
  if (!element.has_mean_volume) return;
  for (const QuadraturePoint& point : body.domains.quadrature().points)
    points_.push_back(point_geometry(element, point, rest_));
}

Matrix<3> StressAtPlace::displacement_gradient(const VectorX& x) const {
  std::vector<double> u;
  cell_positions(world_.dimension, nodes_, x, u);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] -= rest_[i];
  return gradient_of(world_.dimension, u, gradients_);
}

/// J_mean = sum_q W J / sum_q W. The deformed volume, above, does not depend on the rest places.
StressAtPlace::MeanVolume StressAtPlace::mean_volume(const VectorX& x) const {
  const int dim = world_.dimension;
  std::vector<double> u;
  cell_positions(dim, nodes_, x, u);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] -= rest_[i];
  double volume = 0, change = 0;
  MeanVolume mean{.j = 0, .by_x = std::vector<double>(u.size()), .by_X = std::vector<double>(u.size())};
  for (const PointGeometry& point : points_) {
    const Matrix<3> H = gradient_of(dim, u, point.gradients), F = Matrix<3>::Identity() + H;
    volume += point.weight;
    change += point.weight * (F.determinant() - 1);
    const std::vector<double> by_x = at_nodes(dim, cofactor(F), point.gradients),
                              by_X = at_nodes(dim, Matrix<3>::Identity(), point.gradients);
    for (std::size_t i = 0; i < u.size(); ++i) {
      mean.by_x[i] += point.weight * by_x[i];
      mean.by_X[i] -= point.weight * by_X[i];
    }
  }
  mean.j = change / volume;
  for (std::size_t i = 0; i < u.size(); ++i) {
    mean.by_x[i] /= volume;
    mean.by_X[i] *= (1 + mean.j) / volume;
  }
  return mean;
}

Matrix<3> StressAtPlace::stress(const VectorX& x) const {
  const Matrix<3> H = displacement_gradient(x);
  Matrix<3> sigma = from_displacement_gradient::cauchy_stress<3>(material_, H);
  if (points_.empty()) return sigma;
  const double j = (Matrix<3>::Identity() + H).determinant() - 1;
  const double pressure =
      volume_energy(material_, mean_volume(x).j).first - volume_energy(material_, j).first;
  return sigma + pressure * Matrix<3>::Identity();
}

// With S = by, sigma = P F^T / J and Y the slopes by F:
//   Y = A : (S F / J) + S P / J - (S : sigma) F^-T,   by x_a: Y g_a,   by X_a: -F^T Y g_a,
//   by c: S F / J : dP/dc. Of a small-strain law sigma = P. The pressure adds tr S (U'(J_mean) - U'(J)).
void StressAtPlace::add_slopes(const Matrix<3>& by, const VectorX& x, VectorX& by_positions,
                               WorldChange& slopes) const {
  const int dim = world_.dimension;
  const Matrix<3> H = displacement_gradient(x), F = Matrix<3>::Identity() + H;
  const bool is_small = material_.law->kind == LawKind::small_strain;
  const double J = F.determinant();
  const Matrix<3> by_P = is_small ? by : Matrix<3>(by * F / J);
  const TangentMatrix<3> A = from_displacement_gradient::stress_tangent<3>(material_, H);
  const Eigen::Matrix<double, 9, 1> product = A.transpose() * by_P.reshaped();
  Matrix<3> Y = product.reshaped(3, 3);
  if (!is_small) {
    const Matrix<3> P = from_displacement_gradient::first_piola_kirchhoff_stress<3>(material_, H);
    Y += by * P / J - contracted(by, P * F.transpose() / J) * F.inverse().transpose();
  }
  const double trace = by.trace();
  const MeanVolume mean = points_.empty() ? MeanVolume{} : mean_volume(x);
  double second_of_mean = 0;
  if (!points_.empty()) {
    second_of_mean = volume_energy(material_, mean.j).second;
    Y -= trace * volume_energy(material_, J - 1).second * cofactor(F);
  }
  const auto add = [&](const Matrix<3>& M, const std::vector<double>& of_mean, VectorX& to) {
    std::vector<double> values = at_nodes(dim, M, gradients_);
    for (std::size_t i = 0; i < of_mean.size(); ++i) values[i] += trace * second_of_mean * of_mean[i];
    add_cell_values(dim, nodes_, 1, values, to);
  };
  add(Y, mean.by_x, by_positions);
  if (slopes.rest_positions.size() > 0) add(-F.transpose() * Y, mean.by_X, slopes.rest_positions);
  const auto [domain, own_cell] = body_.domains.place_of(cell_);
  VectorX& constants = slopes.bodies[body_number_].domains[domain].constants;
  if (constants.size() == 0) return;
  const auto n = static_cast<Eigen::Index>(material_.constants.size());
  const bool is_uniform = body_.domains[domain].energy->parameters().front().size == n;
  for (Eigen::Index p = 0; p < n; ++p) {
    double slope = contracted(by_P, constant_stress(material_, H, static_cast<std::size_t>(p)));
    if (!points_.empty())
      slope += trace * (pressure_slope(material_, mean.j, static_cast<std::size_t>(p)) -
                        pressure_slope(material_, J - 1, static_cast<std::size_t>(p)));
    constants[(is_uniform ? 0 : own_cell * n) + p] += slope;
  }
}

std::vector<std::string> stress_components() {
  std::vector<std::string> names = {"von_mises"};
  for (const Component& component : components) names.emplace_back(component.name);
  return names;
}

double component_of_stress(std::string_view component, const Matrix<3>& stress, Matrix<3>& slopes) {
  slopes.setZero();
  for (const auto& [name, row, column] : components) {
    if (name != component) continue;
    slopes(row, column) += 0.5;
    slopes(column, row) += 0.5;
    return stress(row, column);
  }
  if (component != "von_mises") refuse_word("stress.component", std::string(component), stress_components());
  const double value = von_mises(stress);
  if (value == 0)
    throw InputError("stress.component", "a stress that is not zero", "von Mises' stress of zero",
                     "it has a kink there: ask for components, such as \"xx\"");
  slopes = 1.5 / value * (stress - stress.trace() / 3 * Matrix<3>::Identity());
  return value;
}

}  // namespace resilin
