// A manufactured solution: the errors on given meshes and the orders of convergence of linear elements.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "reference_case.hpp"
#include "resilin/energy/dead_load.hpp"
#include "resilin/mesh/generators.hpp"

namespace resilin::testing {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double a = 0.15;
constexpr double b = 0.2;
constexpr double mu = 1;
constexpr double lambda = 2;

Vector3 exact_displacement(const Vector3& X) {
  return {a * std::sin(pi * X.x()), b * std::sin(pi * X.x()), 0};
}

Vector3 body_force(const Vector3& X) {
  const double J = 1 + a * pi * std::cos(pi * X.x());
  const double scale = pi * pi * std::sin(pi * X.x());
  return {(mu * (1 + 1 / (J * J)) + lambda * (1 - std::log(J)) / (J * J)) * a * scale, mu * b * scale, 0};
}

/// Integrates f(X, shape values) over a simplex with Gauss-Legendre points on the collapsed cube: exact far
/// beyond what the smooth integrands here need.
void integrate_over_simplex(
    int dim, const std::array<Vector3, 4>& corners,
    const std::function<void(const Vector3&, const std::array<double, 4>&, double)>& visit) {
  // 8 points on [0, 1], exact to degree 15 (Abramowitz & Stegun, table 25.4).
  constexpr std::array<double, 4> points = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                            0.9602898564975363};
  constexpr std::array<double, 4> weights = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                             0.1012285362903763};
  const auto point = [&](int i) {
    const auto k = static_cast<std::size_t>(i / 2);
    return 0.5 + (i % 2 == 0 ? 0.5 : -0.5) * points[k];
  };
  const auto weight = [&](int i) { return 0.5 * weights[static_cast<std::size_t>(i / 2)]; };
  Eigen::Matrix3d edges = Eigen::Matrix3d::Identity();
  for (int k = 0; k < dim; ++k) edges.col(k) = corners[static_cast<std::size_t>(k + 1)] - corners[0];
  const double determinant = std::abs(edges.determinant());
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      for (int k = 0; k < (dim == 3 ? 8 : 1); ++k) {
        const double r = point(i);
        const double s = (1 - r) * point(j);
        const double t = dim == 3 ? (1 - r - s) * point(k) : 0;
        double w = determinant * weight(i) * weight(j) * (1 - r);
        if (dim == 3) w *= weight(k) * (1 - r - s);
        const std::array<double, 4> shape = {1 - r - s - t, r, s, t};
        Vector3 X = Vector3::Zero();
        for (int c = 0; c <= dim; ++c)
          X += shape[static_cast<std::size_t>(c)] * corners[static_cast<std::size_t>(c)];
        visit(X, shape, w);
      }
    }
  }
}

struct Errors {
  double l2 = 0;
  double h1 = 0;
  Vector3 center = Vector3::Zero();
};

Errors solve(int dim, int n) {
  const Mesh mesh = dim == 2 ? make_rectangle({1, 1}, {n, n}) : make_box({1, 1, 1}, {n, n, n});
  Description description = one_body(dim, mesh, reference_law("nh_log", mu, lambda));
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    const Vector3& X = mesh.vertices[static_cast<std::size_t>(v)];
    const auto on_side = [](double c) { return c == 0 || c == 1; };
    if (!on_side(X.x()) && !on_side(X.y()) && !(dim == 3 && on_side(X.z()))) continue;
    FixDescription held;
    held.where.kind = Where::Kind::vertices;
    held.where.vertices = {v};
    held.displacement = exact_displacement(X);
    description.fixes.push_back(held);
  }
  description.probes = {probe("center", {0.5, 0.5, 0.5})};
  World world(description);
  const Body& body = world.bodies[0];
  const auto for_each_cell = [&](const auto& visit) {
    for (Index cell = 0; cell < body.num_cells(); ++cell) {
      std::array<Vector3, 4> corners{};
      std::array<Index, 4> nodes{};
      for (int c = 0; c <= dim; ++c) {
        nodes[static_cast<std::size_t>(c)] = body.cells[static_cast<std::size_t>(cell * (dim + 1) + c)];
        corners[static_cast<std::size_t>(c)] =
            node_position(dim, nodes[static_cast<std::size_t>(c)], world.rest_positions);
      }
      visit(cell, nodes, corners);
    }
  };
  VectorX forces = VectorX::Zero(world.rest_positions.size());
  for_each_cell([&](Index, const std::array<Index, 4>& nodes, const std::array<Vector3, 4>& corners) {
    integrate_over_simplex(dim, corners, [&](const Vector3& X, const std::array<double, 4>& shape, double w) {
      for (int c = 0; c <= dim; ++c) {
        forces.segment(nodes[static_cast<std::size_t>(c)] * dim, dim) +=
            w * shape[static_cast<std::size_t>(c)] * body_force(X).head(dim);
      }
    });
  });
  world.terms.push_back(std::make_shared<DeadLoad>("manufactured", forces, world.rest_positions));
  Simulation simulation(world);
  const Frame frame = run_to_end(simulation);

  Errors errors;
  errors.center = frame.probes[0].displacement;
  const VectorX displacement = simulation.state().positions - world.rest_positions;
  for_each_cell([&](Index, const std::array<Index, 4>& nodes, const std::array<Vector3, 4>& corners) {
    Eigen::Matrix3d edges = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d motions = Eigen::Matrix3d::Zero();
    for (int k = 0; k < dim; ++k) {
      edges.col(k) = corners[static_cast<std::size_t>(k + 1)] - corners[0];
      motions.col(k) = node_position(dim, nodes[static_cast<std::size_t>(k + 1)], displacement) -
                       node_position(dim, nodes[0], displacement);
    }
    const Eigen::Matrix3d gradient = motions * edges.inverse();
    integrate_over_simplex(dim, corners, [&](const Vector3& X, const std::array<double, 4>& shape, double w) {
      Vector3 u = Vector3::Zero();
      for (int c = 0; c <= dim; ++c) {
        u += shape[static_cast<std::size_t>(c)] *
             node_position(dim, nodes[static_cast<std::size_t>(c)], displacement);
      }
      errors.l2 += w * (u - exact_displacement(X)).head(2).squaredNorm() + (dim == 3 ? w * u.z() * u.z() : 0);
      Eigen::Matrix2d difference = gradient.topLeftCorner<2, 2>();
      difference(0, 0) -= a * pi * std::cos(pi * X.x());
      difference(1, 0) -= b * pi * std::cos(pi * X.x());
      errors.h1 += w * difference.squaredNorm();
    });
  });
  errors.l2 = std::sqrt(errors.l2);
  errors.h1 = std::sqrt(errors.h1);
  return errors;
}

TEST(Manufactured, LinearElementsGiveTheReferenceErrorsAndOrders) {
  const nlohmann::json reference = read_reference("manufactured");
  for (const int dim : {2, 3}) {
    Errors coarser;
    for (const int n : dim == 2 ? std::vector{4, 8, 16, 32} : std::vector{2, 4, 8}) {
      const std::string key = "mms" + std::to_string(dim) + "d_p1_n" + std::to_string(n);
      SCOPED_TRACE(key);
      const auto& row = reference["exact_mesh_values"][key];
      const Errors errors = solve(dim, n);
      EXPECT_NEAR(errors.l2, row["L2"], exact_mesh_tolerance * row["L2"].get<double>());
      EXPECT_NEAR(errors.h1, row["H1semi_xy"], exact_mesh_tolerance * row["H1semi_xy"].get<double>());
      EXPECT_LT(relative_error(errors.center, row["u_center"]), exact_mesh_tolerance);
      if (n >= 8) {
        EXPECT_GT(std::log2(coarser.l2 / errors.l2), 1.9);
        EXPECT_GT(std::log2(coarser.h1 / errors.h1), 0.95);
      }
      coarser = errors;
    }
  }
}

}  // namespace
}  // namespace resilin::testing
