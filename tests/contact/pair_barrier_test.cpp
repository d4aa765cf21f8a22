#include "resilin/contact/pair_barrier.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

namespace resilin {
namespace {

constexpr double gap = 0.1;  // m
constexpr ClampedLogBarrier pair_layer{gap};
constexpr PairKind pair_kinds[] = {PairKind::point_point, PairKind::point_edge, PairKind::point_triangle,
                                   PairKind::edge_edge};

/// Random pairs of parts of size 1, `share` of the activation distance apart; some edges nearly parallel.
template <int dim>
struct NearPairs {
  std::mt19937 random{3};

  Vector<dim> place(double size) {
    std::uniform_real_distribution<double> uniform(-size, size);
    Vector<dim> x;
    for (double& value : x) value = uniform(random);
    return x;
  }
  std::vector<Vector<dim>> make(PairKind kind, double share, bool is_parallel) {
    std::vector<Vector<dim>> x;
    for (int i = 0; i < num_vertices(kind); ++i) x.push_back(place(1));
    if (is_parallel && kind == PairKind::edge_edge) x[3] = x[2] + 1.3 * (x[1] - x[0]) + place(0.01);
    const PairDistance<dim> pair = pair_distance<dim>(kind, x);
    for (int i = 0; i < num_first(kind); ++i)
      x[static_cast<std::size_t>(i)] += (share * gap - pair.distance) * pair.normal;
    return x;
  }
};

template <int dim>
std::vector<Vector<dim>> pair_moved(std::vector<Vector<dim>> x, const PairVector<dim>& way) {
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] += way.template segment<dim>(static_cast<Eigen::Index>(i) * dim);
  return x;
}

template <int dim>
PairBarrier<dim> barrier_of(PairKind kind, const std::vector<Vector<dim>>& x, double stiffness = 7) {
  return PairBarrier<dim>(
      pair_layer, kind, x, stiffness,
      dim == 3 && kind == PairKind::edge_edge ? std::optional(EdgeMollifier{0.05}) : std::nullopt);
}

template <int dim>
void expect_slopes_of_differences(PairKind kind) {
  NearPairs<dim> samples;
  int fading = 0;
  for (int i = 0; i < 400; ++i) {
    const auto x = samples.make(kind, 0.3 + 0.002 * (i % 300), i % 2 == 0);
    PairVector<dim> p = PairVector<dim>::Zero();
    for (std::size_t k = 0; k < x.size(); ++k)
      p.template segment<dim>(static_cast<Eigen::Index>(k) * dim) = samples.place(1);
    const double h = 1e-7;
    const auto before = pair_moved<dim>(x, -h * p), after = pair_moved<dim>(x, h * p);
    const auto share = [&](const auto& y) { return pair_distance<dim>(kind, y).num_free; };
    if (share(before) != share(after)) continue;
    const PairBarrier<dim> pair = barrier_of<dim>(kind, x);
    if constexpr (dim == 3)
      if (kind == PairKind::edge_edge && EdgeCross(std::span<const Vector3, 4>(x)).squared() < 0.05) ++fading;
    ASSERT_GT(pair.value(), 0);
    const PairVector<dim> g = pair.gradient();
    const PairMatrix<dim> H = pair.hessian(Projection::none);
    EXPECT_NEAR((barrier_of<dim>(kind, after).value() - barrier_of<dim>(kind, before).value()) / (2 * h),
                g.dot(p), 1e-6 * (g.norm() + h * H.norm()));
    const PairVector<dim> difference =
        (barrier_of<dim>(kind, after).gradient() - barrier_of<dim>(kind, before).gradient()) / (2 * h);
    EXPECT_LT((H * p - difference).norm(), 1e-4 * H.norm()) << static_cast<int>(kind);
    if (::testing::Test::HasFailure()) return;
  }
  if (kind == PairKind::edge_edge) {
    EXPECT_GT(fading, 50);
  }
}

TEST(PairBarrier, HasTheSlopesOfItsDifferences) {
  for (const PairKind kind : pair_kinds) expect_slopes_of_differences<3>(kind);
  expect_slopes_of_differences<2>(PairKind::point_point);
  expect_slopes_of_differences<2>(PairKind::point_edge);
}

TEST(PairBarrier, IsPositiveSemidefiniteOnceProjectedAndNeverBelowItself) {
  NearPairs<3> samples;
  for (const PairKind kind : pair_kinds) {
    for (int i = 0; i < 400; ++i) {
      const auto x = samples.make(kind, 0.05 + 0.002 * i, i % 2 == 0);
      for (const double stiffness : {7.0, -7.0}) {  // those taken away are projected, too
        const PairBarrier<3> pair = barrier_of<3>(kind, x, stiffness);
        const PairMatrix<3> exact = pair.hessian(Projection::none);
        for (const Projection projection : {Projection::clamp, Projection::absolute}) {
          const PairMatrix<3> H = pair.hessian(projection);
          const double size = H.norm() + exact.norm();
          EXPECT_GE(Eigen::SelfAdjointEigenSolver<PairMatrix<3>>(H).eigenvalues().minCoeff(), -1e-12 * size);
          EXPECT_GE(Eigen::SelfAdjointEigenSolver<PairMatrix<3>>(H - exact).eigenvalues().minCoeff(),
                    -1e-12 * size);
        }
      }
    }
  }
}

TEST(PairBarrier, KeepsTheDigitsOfSmallDifferences) {
  NearPairs<3> samples;
  for (const PairKind kind : pair_kinds) {
    for (int i = 0; i < 200; ++i) {
      const auto x = samples.make(kind, 0.3 + 0.003 * i, i % 2 == 0);
      const auto mollifier = kind == PairKind::edge_edge ? std::optional(EdgeMollifier{0.05}) : std::nullopt;
      const auto difference = [&](const auto& to) {
        return pair_barrier_difference<3>(pair_layer, kind, x, to, 7, mollifier);
      };
      PairVector<3> p = PairVector<3>::Zero();
      for (std::size_t k = 0; k < x.size(); ++k)
        p.segment<3>(3 * static_cast<Eigen::Index>(k)) = samples.place(1e-12);
      auto y = pair_moved<3>(x, p);
      for (std::size_t k = 0; k < x.size(); ++k) p.segment<3>(3 * static_cast<Eigen::Index>(k)) = y[k] - x[k];
      const PairBarrier<3> pair = barrier_of<3>(kind, x);
      if (pair_distance<3>(kind, y).num_free != pair.distance().num_free) continue;
      const PairVector<3> g = pair.gradient();
      EXPECT_NEAR(difference(y), g.dot(p), 1e-8 * g.norm() * p.norm() + 1e-28);
      y = pair_moved<3>(x, 1e10 * p);  // 1 % of the size
      const double whole = barrier_of<3>(kind, y).value() - pair.value();
      EXPECT_NEAR(difference(y), whole, 1e-10 * (pair.value() + std::abs(whole)) + 1e-16);
    }
  }
}

TEST(PairBarrier, PushesPartsApartAndIsInBalance) {
  NearPairs<3> samples;
  for (const PairKind kind : pair_kinds) {
    const auto x = samples.make(kind, 0.5, false);
    const PairVector<3> force = -barrier_of<3>(kind, x).gradient();
    Vector3 first = Vector3::Zero(), sum = Vector3::Zero(), torque = Vector3::Zero();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vector3 f = force.segment<3>(3 * static_cast<Eigen::Index>(i));
      if (i < static_cast<std::size_t>(num_first(kind))) first += f;
      sum += f;
      torque += x[i].cross(f);
    }
    EXPECT_GT(first.dot(pair_distance<3>(kind, x).normal), 0);
    EXPECT_LT(sum.norm(), 1e-14 * force.norm());
    EXPECT_LT(torque.norm(), 1e-13 * force.norm());
  }
}

TEST(PairBarrier, IsZeroBeyondItsDistanceAndInfiniteAtATouch) {
  const std::array<Vector3, 2> far = {Vector3(0, 0, 0), Vector3(gap, 0, 0)};
  const PairBarrier<3> beyond(pair_layer, PairKind::point_point, far, 1);
  EXPECT_FALSE(beyond.is_active());
  EXPECT_EQ(beyond.value(), 0);
  EXPECT_EQ(beyond.gradient(), PairVector<3>::Zero());
  EXPECT_EQ(beyond.hessian(Projection::none), PairMatrix<3>::Zero());
  const std::array<Vector3, 2> same = {Vector3(1, 2, 3), Vector3(1, 2, 3)};
  EXPECT_EQ(PairBarrier<3>(pair_layer, PairKind::point_point, same, 1).value(),
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(PairBarrier<3>(pair_layer, PairKind::point_point, same, -1).value(),
            std::numeric_limits<double>::infinity());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::array<Vector3, 2> none = {Vector3(nan, 2, 3), Vector3(1, 2, 3)};
  EXPECT_FALSE(std::isfinite(PairBarrier<3>(pair_layer, PairKind::point_point, none, 1).value()));
}

}  // namespace
}  // namespace resilin
