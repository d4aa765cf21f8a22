#include "resilin/collision/pair_distance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <map>

#include "resilin/collision/edge_mollifier.hpp"
#include "sample_pairs.hpp"

namespace resilin {
namespace {

using testing::SamplePairs;

template <int dim>
std::vector<Vector<dim>> moved(std::vector<Vector<dim>> x, const PairVector<dim>& way) {
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] += way.template segment<dim>(static_cast<Eigen::Index>(i) * dim);
  return x;
}

template <int dim>
PairVector<dim> direction(SamplePairs<dim>& samples, std::size_t count) {
  PairVector<dim> p = PairVector<dim>::Zero();
  for (std::size_t i = 0; i < count; ++i)
    p.template segment<dim>(static_cast<Eigen::Index>(i) * dim) = samples.place();
  return p;
}

/// grad psi for psi = d or d^2, and its Hessian.
template <int dim>
PairVector<dim> gradient(PairKind kind, const std::vector<Vector<dim>>& x, bool is_square) {
  const PairDistance<dim> pair = pair_distance<dim>(kind, x);
  return (is_square ? 2 * pair.distance : 1) * pair.gradient();
}
template <int dim>
PairMatrix<dim> hessian(PairKind kind, const std::vector<Vector<dim>>& x, const DistanceSlopes& psi,
                        Projection projection = Projection::none) {
  RankOneSum<dim> sum;
  add_distance_hessian<dim>(pair_distance<dim>(kind, x), psi, 1, sum);
  return sum.matrix(projection);
}

/// Vertices that have a share: 2^dim corner cases of each kind, and the open one.
template <int dim>
unsigned share_of(PairKind kind, const std::vector<Vector<dim>>& x) {
  const auto weights = pair_distance<dim>(kind, x).weights;
  unsigned code = 0;
  for (std::size_t i = 0; i < 4; ++i) code |= (weights[i] != 0 ? 1U : 0U) << i;
  return code;
}

/// Slope and curvature along a random direction against central differences; pairs whose feature changes on
/// the way are left out. The errors are those of differences of step 1e-5 in shapes of size 1.
template <int dim>
void has_the_slopes_of_its_differences(PairKind kind, std::size_t num_features) {
  SamplePairs<dim> samples(kind, 11);
  std::map<unsigned, int> seen;
  for (int i = 0; i < 4000; ++i) {
    const auto x = samples.plain();
    const PairVector<dim> p = direction<dim>(samples, x.size());
    const double h = 1e-5;
    const auto before = moved<dim>(x, -h * p), after = moved<dim>(x, h * p);
    const unsigned share = share_of<dim>(kind, x);
    const PairDistance<dim> pair = pair_distance<dim>(kind, x);
    if (share_of<dim>(kind, before) != share || share_of<dim>(kind, after) != share || pair.distance < 0.03)
      continue;
    ++seen[share];
    const double slope = (squared_distance<dim>(kind, after) - squared_distance<dim>(kind, before)) / (2 * h);
    const PairVector<dim> g = gradient<dim>(kind, x, true);
    const double bend = hessian<dim>(kind, x, DistanceSlopes::of_square(pair.distance)).norm();
    EXPECT_NEAR(slope, g.dot(p), 1e-8 * (1 + bend * bend));
    for (const bool is_square : {true, false}) {
      const PairVector<dim> difference =
          (gradient<dim>(kind, after, is_square) - gradient<dim>(kind, before, is_square)) / (2 * h);
      const DistanceSlopes psi =
          is_square ? DistanceSlopes::of_square(pair.distance) : DistanceSlopes::of(pair.distance, 1, 0);
      const PairMatrix<dim> H = hessian<dim>(kind, x, psi);
      EXPECT_LT((H * p - difference).norm(), 1e-6 * (1 + H.norm() * H.norm()))
          << testing::name_of(kind) << " " << share << " square " << is_square;
      EXPECT_EQ(H, H.transpose());
    }
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_EQ(seen.size(), num_features) << testing::name_of(kind);
}

TEST(PairDistance, HasTheSlopesOfItsDifferencesInEveryRegion) {
  has_the_slopes_of_its_differences<3>(PairKind::point_point, 1);
  has_the_slopes_of_its_differences<3>(PairKind::point_edge, 3);
  has_the_slopes_of_its_differences<3>(PairKind::point_triangle, 7);
  has_the_slopes_of_its_differences<3>(PairKind::edge_edge, 9);
  has_the_slopes_of_its_differences<2>(PairKind::point_point, 1);
  has_the_slopes_of_its_differences<2>(PairKind::point_edge, 3);
}

TEST(PairDistance, SeesNoRigidMotion) {
  for (const PairKind kind : testing::every_pair_kind) {
    SamplePairs<3> samples(kind, 5);
    for (int i = 0; i < 200; ++i) {
      const auto x = samples.plain();
      const PairVector<3> g = gradient<3>(kind, x, false);
      const Vector3 w = samples.place(), shift = samples.place();
      PairVector<3> rigid = PairVector<3>::Zero();
      for (std::size_t k = 0; k < x.size(); ++k)
        rigid.segment<3>(3 * static_cast<Eigen::Index>(k)) = shift + w.cross(x[k]);
      EXPECT_NEAR(g.dot(rigid), 0, 1e-13) << testing::name_of(kind);
    }
  }
}

/// With psi' < 0 < psi'' as a barrier has them: the projected Hessian is positive semidefinite, not below
/// the exact one, and leaves the push along the normal alone.
TEST(PairDistance, HasAPositiveSemidefiniteHessianOnceProjected) {
  for (const PairKind kind : testing::every_pair_kind) {
    SamplePairs<3> samples(kind, 7);
    for (int i = 0; i < 300; ++i) {
      const auto x = samples.plain();
      const PairDistance<3> pair = pair_distance<3>(kind, x);
      for (const double sign : {-1.0, 1.0}) {
        const DistanceSlopes psi = DistanceSlopes::of(pair.distance, sign * 2.5, 4);
        const PairMatrix<3> exact = hessian<3>(kind, x, psi);
        for (const Projection projection : {Projection::clamp, Projection::absolute}) {
          const PairMatrix<3> H = hessian<3>(kind, x, psi, projection);
          const Eigen::SelfAdjointEigenSolver<PairMatrix<3>> eigen(H), above(H - exact);
          EXPECT_GT(eigen.eigenvalues().minCoeff(), -1e-13 * H.norm());
          EXPECT_GT(above.eigenvalues().minCoeff(), -1e-13 * H.norm());
        }
      }
    }
  }
}

/// A change of 1e-12 is told to 1e-9 of itself, where the difference of two distances has four digits left;
/// what the way bends is of second order.
TEST(PairDistance, KeepsTheDigitsOfSmallChanges) {
  for (const PairKind kind : testing::every_pair_kind) {
    SamplePairs<3> samples(kind, 15);
    for (int i = 0; i < 500; ++i) {
      const auto x = samples.plain();
      const auto y = moved<3>(x, 1e-12 * direction<3>(samples, x.size())), far = samples.plain();
      if (share_of<3>(kind, x) != share_of<3>(kind, y)) continue;
      PairVector<3> p = PairVector<3>::Zero();
      for (std::size_t k = 0; k < x.size(); ++k) p.segment<3>(3 * static_cast<Eigen::Index>(k)) = y[k] - x[k];
      const PairDistance<3> pair = pair_distance<3>(kind, x);
      EXPECT_NEAR(distance_change<3>(kind, x, y), pair.gradient().dot(p),
                  1e-9 * p.norm() * (1 + 1e-2 / pair.distance));
      const double whole = pair_distance<3>(kind, far).distance - pair.distance;
      EXPECT_NEAR(distance_change<3>(kind, x, far), whole, 1e-13);
    }
  }
}

/// Where points coincide the squared distance is still smooth.
TEST(PairDistance, OfItsSquareIsSmoothAtZero) {
  for (const PairKind kind : testing::every_pair_kind) {
    SamplePairs<3> samples(kind, 9);
    auto x = samples.plain();
    Vector3 on = x.back();
    if (kind == PairKind::point_edge || kind == PairKind::edge_edge)
      on = 0.4 * x[x.size() - 2] + 0.6 * x.back();
    if (kind == PairKind::point_triangle) on = 0.2 * x[1] + 0.3 * x[2] + 0.5 * x[3];
    const Vector3 shift = on - (num_first(kind) == 2 ? Vector3(0.5 * (x[0] + x[1])) : x[0]);
    for (int i = 0; i < num_first(kind); ++i) x[static_cast<std::size_t>(i)] += shift;
    const double d = pair_distance<3>(kind, x).distance;
    EXPECT_LT(d, 1e-15);
    const PairMatrix<3> H = hessian<3>(kind, x, DistanceSlopes::of_square(d));
    const PairVector<3> p = direction<3>(samples, x.size());
    const double h = 1e-4;
    const double curvature = (squared_distance<3>(kind, moved<3>(x, h * p)) +
                              squared_distance<3>(kind, moved<3>(x, -h * p)) - 2 * d * d) /
                             (h * h);
    EXPECT_NEAR(p.dot(H * p), curvature, 1e-3 * H.norm()) << testing::name_of(kind);
  }
}

struct Mollified {
  EdgeMollifier mollifier;

  double value(const std::vector<Vector3>& x) const {
    return mollifier.value(EdgeCross(std::span<const Vector3, 4>(x)).squared());
  }
  PairVector<3> gradient(const std::vector<Vector3>& x) const {
    const EdgeCross cross(std::span<const Vector3, 4>{x});
    return mollifier.slope(cross.squared()) * cross.gradient();
  }
  PairMatrix<3> hessian(const std::vector<Vector3>& x, Projection projection) const {
    const EdgeCross cross(std::span<const Vector3, 4>{x});
    RankOneSum<3> sum;
    sum.add(mollifier.curvature(cross.squared()), cross.gradient());
    cross.add_hessian(mollifier.slope(cross.squared()), sum);
    return sum.matrix(projection);
  }
};

TEST(EdgeMollifier, FadesFromOneToZeroAsEdgesBecomeParallel) {
  const EdgeMollifier mollifier = EdgeMollifier::of_rest_edges({2, 0, 0}, {0, 3, 0});
  EXPECT_DOUBLE_EQ(mollifier.threshold, 36e-3);
  EXPECT_EQ(mollifier.value(0), 0);
  EXPECT_EQ(mollifier.value(mollifier.threshold), 1);
  EXPECT_EQ(mollifier.value(1), 1);
  EXPECT_EQ(mollifier.slope(mollifier.threshold), 0);
  EXPECT_NEAR(mollifier.value(36e-3 * (1 - 1e-6)), 1, 2e-12);
  EXPECT_NEAR(mollifier.slope(36e-3 * (1 - 1e-6)), 0, 1e-4);
}

TEST(EdgeMollifier, HasTheSlopesOfItsDifferencesAndIsSemidefiniteOnceProjected) {
  SamplePairs<3> samples(PairKind::edge_edge, 13);
  for (int i = 0; i < 500; ++i) {
    auto x = samples.plain();
    if (i % 2 == 0) x[3] = x[2] + samples.uniform(-2, 2) * (x[1] - x[0]) + 0.01 * samples.place();
    if (i % 10 == 0) x[3] = x[2] - 0.5 * (x[1] - x[0]);
    const EdgeCross cross(std::span<const Vector3, 4>{x});
    const Mollified m{{2 * cross.squared() + 0.01}};
    const PairVector<3> p = direction<3>(samples, 4);
    const double h = 1e-6;
    EXPECT_NEAR(cross.squared(), (x[1] - x[0]).cross(x[3] - x[2]).squaredNorm(), 1e-14);
    EXPECT_NEAR((m.value(moved<3>(x, h * p)) - m.value(moved<3>(x, -h * p))) / (2 * h), m.gradient(x).dot(p),
                1e-7 * (1 + m.gradient(x).norm()));
    const PairVector<3> difference =
        (m.gradient(moved<3>(x, h * p)) - m.gradient(moved<3>(x, -h * p))) / (2 * h);
    const PairMatrix<3> H = m.hessian(x, Projection::none);
    EXPECT_LT((H * p - difference).norm(), 1e-6 * (1 + H.norm()));
    for (const Projection projection : {Projection::clamp, Projection::absolute}) {
      const PairMatrix<3> projected = m.hessian(x, projection);
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<PairMatrix<3>>(projected).eigenvalues().minCoeff(),
                -1e-13 * projected.norm());
    }
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace resilin
