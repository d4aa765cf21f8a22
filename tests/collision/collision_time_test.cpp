#include "resilin/collision/collision_time.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "resilin/collision/pair_distance.hpp"
#include "resilin/core/parallel.hpp"
#include "sample_pairs.hpp"

namespace resilin {
namespace {

using testing::SamplePairs;

/// Pairs that share no vertex, with their ways.
struct MovingPairs {
  PairKind kind;
  std::vector<double> x, p;
  std::vector<Candidate> pairs;
  std::vector<Index> first, second;

  explicit MovingPairs(PairKind pair_kind) : kind(pair_kind) {}

  void add(const std::vector<Vector3>& places, const std::vector<Vector3>& ways) {
    const auto part = static_cast<Index>(pairs.size());
    pairs.push_back({part, part});
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto vertex = static_cast<Index>(x.size() / 3);
      (i < static_cast<std::size_t>(num_first(kind)) ? first : second).push_back(vertex);
      x.insert(x.end(), places[i].begin(), places[i].end());
      p.insert(p.end(), ways[i].begin(), ways[i].end());
    }
  }
  CandidateList list() const { return {kind, pairs, first, second}; }
  std::vector<MovingPoint> points() const { return moving_points(3, x, p); }
  std::vector<double> times(InstructionSet set, const CollisionTimeOptions& options = {}) const {
    std::vector<double> t(pairs.size(), -1);
    collision_times(list(), points(), t, options, set);
    return t;
  }
  /// The vertices of a pair as a caller moves them, in rounded sums.
  std::vector<Vector3> at(std::size_t pair, double t) const {
    std::vector<Vector3> places;
    for (const Index vertex : list().vertices(pairs[pair])) {
      if (vertex < 0) continue;
      const Eigen::Index v = 3 * Eigen::Index{vertex};
      places.emplace_back(Eigen::Map<const Vector3>(&x[static_cast<std::size_t>(v)]) +
                          t * Eigen::Map<const Vector3>(&p[static_cast<std::size_t>(v)]));
    }
    return places;
  }
  double distance(std::size_t pair, double t) const {
    return std::sqrt(squared_distance<3>(kind, at(pair, t)));
  }
  double size(std::size_t pair) const {
    double largest = 0;
    for (const double t : {0.0, 1.0})
      for (const Vector3& v : at(pair, t)) largest = std::max(largest, v.norm());
    return largest;
  }
};

struct EveryPairKind : ::testing::TestWithParam<std::tuple<PairKind, InstructionSet>> {
  const PairKind kind = std::get<0>(GetParam());
  const InstructionSet set = std::get<1>(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Kinds, EveryPairKind,
                         ::testing::Combine(::testing::ValuesIn(testing::every_pair_kind),
                                            ::testing::ValuesIn(available_instruction_sets())),
                         [](const auto& entry) {
                           return testing::name_of(std::get<0>(entry.param)) + "_" +
                                  std::string(name(std::get<1>(entry.param)));
                         });

/// On all of [0, t] the parts keep a tenth of their distance: sampled closely, with the distances of another
/// code. What round-off may take is 1e-14 of the coordinates; a sliver's distance is known to 1e-10 of its
/// size.
void expect_no_lateness(const MovingPairs& all, const std::vector<double>& times) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    ASSERT_GE(times[i], 0) << i;
    ASSERT_LE(times[i], 1) << i;
    if (times[i] == 0) continue;
    const double least = 0.1 * all.distance(i, 0);
    ASSERT_GT(least, 0);
    for (int k = 0; k <= 32; ++k) {
      const double t = times[i] * k / 32;
      ASSERT_GT(all.distance(i, t), least * (1 - 1e-9) - 2e-14 * all.size(i))
          << i << " at " << t << " of " << times[i];
      ASSERT_GT(all.distance(i, t), 0);
    }
  }
}

TEST_P(EveryPairKind, IsNeverLateForRandomWays) {
  SamplePairs<3> samples(kind, 21);
  MovingPairs all(kind);
  for (int i = 0; i < 4000; ++i)
    all.add(samples.plain(), i % 3 == 0 ? samples.degenerate() : samples.plain());
  const std::vector<double> times = all.times(set);
  expect_no_lateness(all, times);
  EXPECT_GT(std::ranges::count(times, 1.0), 250);
}

TEST_P(EveryPairKind, IsNeverLateForDegeneratePairs) {
  SamplePairs<3> samples(kind, 22);
  MovingPairs all(kind);
  for (int i = 0; i < 4000; ++i) {
    const std::vector<Vector3> x = samples.degenerate();
    double size = 1e-300;
    for (const Vector3& v : x) size = std::max(size, (v - x[0]).norm());
    std::vector<Vector3> p;
    const double speed = size * std::pow(10, samples.uniform(-3, 3));
    const Vector3 common = samples.place(speed);
    for (std::size_t k = 0; k < x.size(); ++k)
      p.push_back(i % 4 == 0   ? common
                  : i % 4 == 1 ? Vector3::Zero()
                               : Vector3(samples.place(speed) + common));
    all.add(x, p);
  }
  const std::vector<double> times = all.times(set);
  expect_no_lateness(all, times);
  // Pairs that move together, or stay, are free all the way unless they touch.
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i % 4 < 2 && all.distance(i, 0) > 1e-9 * all.size(i)) {
      EXPECT_EQ(times[i], 1) << i << " of size " << all.size(i) << " apart by " << all.distance(i, 0) << [&] {
        std::ostringstream o;
        o.precision(17);
        for (auto& v : all.at(i, 0)) o << "\n" << v.transpose();
        return o.str();
      }();
    }
  }
}

/// Straight at each other the parts lose nine tenths of their distance at nine tenths of the time of the
/// first touch; found to the tolerance.
TEST_P(EveryPairKind, IsNotEarlyEither) {
  SamplePairs<3> samples(kind, 23);
  MovingPairs all(kind);
  for (int i = 0; i < 5000; ++i) {
    const std::vector<Vector3> x = samples.plain();
    const PairDistance<3> pair = pair_distance<3>(kind, x);
    std::vector<Vector3> p(x.size(), samples.place());
    for (std::size_t k = 0; k < x.size(); ++k)
      if (k < static_cast<std::size_t>(num_first(kind))) p[k] -= 2 * pair.distance * pair.normal;
    all.add(x, p);
  }
  for (const double t : all.times(set)) {
    EXPECT_LE(t, 0.45 + 1e-9);
    EXPECT_GE(t, 0.45 - 0.03);
  }
}

/// The remaining way after many steps: no pair is given up early, however it turns.
TEST_P(EveryPairKind, GoesOnUntilLittleIsLeft) {
  SamplePairs<3> samples(kind, 24);
  MovingPairs all(kind);
  for (int i = 0; i < 4000; ++i) all.add(samples.plain(), samples.plain());
  const std::vector<double> times = all.times(set);
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] < 1) {
      EXPECT_LE(all.distance(i, times[i]), 0.1501 * all.distance(i, 0)) << i;
    }
  }
}

TEST_P(EveryPairKind, TakesWhatIsNoNumberForATouch) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    for (const bool is_way : {false, true}) {
      SamplePairs<3> samples(kind, 25);
      std::vector<Vector3> x = samples.plain(), p = samples.plain();
      (is_way ? p : x)[1].z() = bad;
      MovingPairs one(kind);
      one.add(x, p);
      EXPECT_EQ(one.times(set)[0], 0) << bad;
    }
  }
}

TEST_P(EveryPairKind, LosesItsDigitsFarFromTheOriginOnTheSafeSide) {
  SamplePairs<3> samples(kind, 26);
  MovingPairs all(kind);
  for (int i = 0; i < 5000; ++i) {
    std::vector<Vector3> x = samples.plain();
    const Vector3 far = samples.place(std::pow(10, samples.uniform(0, 12)));
    for (Vector3& v : x) v += far;
    all.add(x, samples.plain());
  }
  const std::vector<double> times = all.times(set);
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (int k = 0; k <= 32 && times[i] > 0; ++k) {
      ASSERT_GT(all.distance(i, times[i] * k / 32), 0) << i;
    }
  }
}

TEST_P(EveryPairKind, GivesTheEarliestOfAllWithTheSameBitsForAnyNumberOfThreads) {
  SamplePairs<3> samples(kind, 27);
  MovingPairs all(kind);
  for (int i = 0; i < 10001; ++i) all.add(samples.plain(), samples.plain());
  const std::vector<double> times = all.times(set);
  const int before = num_threads();
  set_num_threads(1);
  const double one = earliest_collision_time(all.list(), all.points(), {}, set);
  set_num_threads(2);
  const double two = earliest_collision_time(all.list(), all.points(), {}, set);
  set_num_threads(before);
  EXPECT_EQ(one, two);
  EXPECT_NEAR(one, *std::ranges::min_element(times), 1e-12);
  all.pairs.clear();
  EXPECT_EQ(earliest_collision_time(all.list(), all.points(), {}, set), 1);
}

TEST_P(EveryPairKind, HasTheSquaredDistancesOfSinglePairs) {
  SamplePairs<3> samples(kind, 28);
  MovingPairs all(kind);
  for (int i = 0; i < 1003; ++i) all.add(samples.degenerate(), samples.plain());
  std::vector<double> squares(all.pairs.size());
  squared_distances(all.list(), all.points(), squares, set);
  for (std::size_t i = 0; i < squares.size(); ++i)
    EXPECT_NEAR(std::sqrt(squares[i]), all.distance(i, 0), 1e-13 * all.size(i)) << i;
}

/// A face that comes down flat on another: each candidate is settled by its first slab.
TEST(CollisionTime, OfFlatFacesMovingInParallelIsExact) {
  MovingPairs all(PairKind::point_triangle);
  const Vector3 down(0.3, 0.2, -2);
  for (int i = 0; i < 1000; ++i) {
    const double s = 0.01 * i;
    all.add({Vector3(s, 0.5, 1), Vector3(0, 0, 0), Vector3(20, 0, 0), Vector3(0, 20, 0)},
            {down, Vector3::Zero(), Vector3::Zero(), Vector3::Zero()});
  }
  for (const double t : all.times(preferred_instruction_set(), {.max_iterations = 1}))
    EXPECT_NEAR(t, 0.45, 1e-12);
}

/// Edges at small angles and slivers, turned and shifted at random, as near as 1e-9 of their size: coming at
/// each other they are neither late nor stuck.
TEST(CollisionTime, IsNotMisledBySmallAnglesNorBySlivers) {
  std::mt19937 random(31);
  std::normal_distribution<double> normal;
  for (const double small : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-13, 0.0}) {
    for (const double gap : {1e-3, 1e-6, 1e-9}) {
      MovingPairs edges(PairKind::edge_edge), slivers(PairKind::point_triangle);
      for (int i = 0; i < 50; ++i) {
        const Eigen::Quaterniond turn =
            Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
        const Vector3 shift(normal(random), normal(random), normal(random));
        const auto placed = [&](double x, double y, double z) -> Vector3 {
          return turn * Vector3(x, y, z) + shift;
        };
        const Vector3 down = turn * Vector3(0, 0, -2 * gap), none = Vector3::Zero();
        edges.add({placed(-1, -small, gap), placed(1, small, gap), placed(-1, 0, 0), placed(1, 0, 0)},
                  {down, down, none, none});
        slivers.add({placed(0.5, 0.3 * small, gap), placed(0, 0, 0), placed(1, 0, 0), placed(0.4, small, 0)},
                    {down, none, none, none});
      }
      for (const MovingPairs* all : {&edges, &slivers}) {
        for (const double t : all->times(preferred_instruction_set())) {
          EXPECT_LT(t, 0.5) << small << " " << gap;
          EXPECT_GT(t, 0.42 - 1e-14 / gap) << small << " " << gap;
        }
      }
    }
  }
}

/// A point that turns about a triangle's corner with the plane: motion along the slab costs nothing.
TEST(CollisionTime, IsOneForSlidingAlongAFace) {
  MovingPairs all(PairKind::point_triangle);
  all.add({Vector3(0.1, 0.1, 1e-6), Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0)},
          {Vector3(5, 7, 0), Vector3(-3, 0, 0), Vector3(-3, 0, 0), Vector3(-3, 0, 0)});
  EXPECT_EQ(all.times(preferred_instruction_set())[0], 1);
}

/// Parts that turn together, as edges do that roll about each other, do not meet, however near they are: by
/// slabs that stand still each would need as many of them as what it turns by is times the distance.
TEST(CollisionTime, IsOneForPartsThatTurnTogether) {
  for (const PairKind kind : {PairKind::point_edge, PairKind::point_triangle, PairKind::edge_edge}) {
    SamplePairs<3> samples(kind, 41);
    for (const double gap : {1e-2, 1e-3, 1e-4, 1e-5}) {
      MovingPairs all(kind);
      for (int i = 0; i < 500; ++i) {
        std::vector<Vector3> places = samples.plain(), ways;
        const PairDistance<3> pair = pair_distance<3>(kind, places);
        for (std::size_t k = 0; k < places.size(); ++k)
          if (k < static_cast<std::size_t>(num_first(kind))) places[k] += (gap - pair.distance) * pair.normal;
        const double angle = samples.uniform(-0.05, 0.05);
        const Eigen::AngleAxisd turn(angle, samples.place().normalized());
        for (const Vector3& x : places) ways.emplace_back(turn * x - x);
        all.add(places, ways);
      }
      const std::vector<double> times = all.times(preferred_instruction_set());
      expect_no_lateness(all, times);
      EXPECT_EQ(std::ranges::count(times, 1.0), std::ssize(times)) << testing::name_of(kind) << " " << gap;
    }
  }
}

TEST(CollisionTime, IsMetInThePlaneToo) {
  const std::vector<double> x = {0, 1, -1, 0, 1, 0}, p = {0.2, -4, 0, 0, 0, 0};
  const std::vector<Candidate> pairs = {{0, 0}};
  const std::vector<Index> points = {0}, edges = {1, 2};
  const CandidateList list = {PairKind::point_edge, pairs, points, edges};
  EXPECT_NEAR(earliest_collision_time(list, moving_points(2, x, p)), 0.225, 1e-12);
}

}  // namespace
}  // namespace resilin
