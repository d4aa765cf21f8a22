#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "resilin/collision/collision_time.hpp"
#include "resilin/collision/pair_distance.hpp"
#include "sample_pairs.hpp"
#include "shared_data.hpp"

namespace resilin {
namespace {

/// Pairs with the numbers of ipctk 1.6.1, an independent code (tests/data/make_pair_reference.py).
struct PairReference : ::testing::TestWithParam<PairKind> {
  nlohmann::json pairs;

  void SetUp() override {
    std::ifstream file(testing::source_folder() / "tests/data/pair_reference.json");
    pairs = nlohmann::json::parse(file).at(testing::name_of(GetParam()));
  }
};

INSTANTIATE_TEST_SUITE_P(Kinds, PairReference, ::testing::ValuesIn(testing::every_pair_kind),
                         [](const auto& entry) { return testing::name_of(entry.param); });

std::vector<Vector3> vertices_of(const nlohmann::json& numbers) {
  std::vector<Vector3> x(numbers.size() / 3);
  for (std::size_t i = 0; i < numbers.size(); ++i) x[i / 3][static_cast<Eigen::Index>(i % 3)] = numbers[i];
  return x;
}

PairVector<3> pair_vector(const nlohmann::json& numbers) {
  PairVector<3> v = PairVector<3>::Zero();
  for (std::size_t i = 0; i < numbers.size(); ++i) v[static_cast<Eigen::Index>(i)] = numbers[i];
  return v;
}

TEST_P(PairReference, HasTheDistancesAndDerivativesOfAnotherCode) {
  int derivatives = 0;
  for (const auto& pair : pairs) {
    if (!pair.contains("squared_distance")) continue;
    const std::vector<Vector3> x = vertices_of(pair.at("x"));
    const double expected = pair.at("squared_distance"), square = squared_distance<3>(GetParam(), x);
    double size = 0;
    for (const Vector3& v : x) size = std::max(size, v.norm());
    // Theirs are squares of products of edges: relative to the size, a few digits less than ours.
    EXPECT_NEAR(std::sqrt(square), std::sqrt(expected), 1e-7 * size) << pair;
    if (!pair.contains("gradient")) continue;
    ++derivatives;
    const PairDistance<3> distance = pair_distance<3>(GetParam(), x);
    RankOneSum<3> sum;
    add_distance_hessian<3>(distance, DistanceSlopes::of_square(distance.distance), 1, sum);
    PairVector<3> v = PairVector<3>::Zero();
    for (Eigen::Index i = 0; i < 3 * static_cast<Eigen::Index>(x.size()); ++i)
      v[i] = 0.1 * static_cast<double>(i + 1) * (i % 2 == 0 ? 1 : -1);
    const PairMatrix<3> H = sum.matrix(Projection::none);
    EXPECT_NEAR(square, expected, 1e-12 * (1 + expected));
    EXPECT_LT((2 * distance.distance * distance.gradient() - pair_vector(pair.at("gradient"))).norm(), 1e-11);
    EXPECT_LT((H * v - pair_vector(pair.at("hessian_times_v"))).norm(), 1e-10 * (1 + H.norm() * H.norm()))
        << pair;
  }
  EXPECT_GE(derivatives, 10);
}

/// The way is free up to just before the first touch, when a hundredth of a percent of the distance is kept.
TEST_P(PairReference, HasTheTimesOfTouchOfAnotherCode) {
  const CollisionTimeOptions nearly_all = {.share_left = 1e-4, .tolerance = 1e-4};
  int touching = 0;
  for (const auto& pair : pairs) {
    if (!pair.contains("p")) continue;
    std::vector<double> x = pair.at("x"), p = pair.at("p");
    std::vector<Index> first, second;
    for (int i = 0; i < num_vertices(GetParam()); ++i)
      (i < num_first(GetParam()) ? first : second).push_back(i);
    const std::vector<Candidate> one = {{0, 0}};
    const double t =
        earliest_collision_time({GetParam(), one, first, second}, moving_points(3, x, p), nearly_all);
    if (pair.at("touch").is_null()) {
      EXPECT_EQ(t, 1) << pair;
      continue;
    }
    ++touching;
    const double expected = pair.at("touch");
    EXPECT_LT(t, expected + 1e-6) << pair;  // theirs to 1e-6
    EXPECT_GT(t, expected - 2e-3) << pair;
  }
  EXPECT_GE(touching, 3);
}

}  // namespace
}  // namespace resilin
