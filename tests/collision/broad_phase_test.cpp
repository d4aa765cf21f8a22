#include "resilin/collision/broad_phase.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

#include "resilin/collision/collision_time.hpp"
#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

/// Bodies of random triangles (edges in 2D) that share vertices, on their ways.
struct RandomBodies {
  CollisionSurface surface;
  std::vector<double> x, p;
  std::mt19937 random;

  RandomBodies(int dim, unsigned seed, int num_bodies, int vertices_each, double size, double way)
      : random(seed) {
    surface.dim = dim;
    for (Index body = 0; body < num_bodies; ++body) {
      const auto first = static_cast<Index>(surface.bodies.size());
      Vector3 center = place(1), motion = place(way);
      for (int v = 0; v < vertices_each; ++v) {
        surface.points.push_back(static_cast<Index>(surface.bodies.size()));
        surface.bodies.push_back(body);
        const Vector3 at = center + place(size), to = motion + place(0.3 * way);
        for (int i = 0; i < dim; ++i) {
          x.push_back(at[i]);
          p.push_back(to[i]);
        }
      }
      std::set<std::pair<Index, Index>> edges;
      std::uniform_int_distribution<Index> any(first, first + vertices_each - 1);
      for (int t = 0; t < 2 * vertices_each; ++t) {
        const Index a = any(random), b = any(random), c = any(random);
        if (a == b || b == c || a == c) continue;
        if (dim == 3) surface.triangles.insert(surface.triangles.end(), {a, b, c});
        edges.insert(std::minmax(a, b));
        edges.insert(std::minmax(b, c));
        if (dim == 3) edges.insert(std::minmax(a, c));
      }
      for (const auto& [a, b] : edges) surface.edges.insert(surface.edges.end(), {a, b});
    }
  }
  Vector3 place(double size) {
    std::uniform_real_distribution<double> uniform(-size, size);
    return {uniform(random), uniform(random), surface.dim == 3 ? uniform(random) : 0};
  }
  std::vector<MovingPoint> points() const { return moving_points(surface.dim, x, p); }
};

constexpr PairKind kinds_in_space[] = {PairKind::point_triangle, PairKind::edge_edge};
constexpr PairKind kinds_in_plane[] = {PairKind::point_edge};

std::span<const PairKind> kinds_of(int dim) {
  return dim == 3 ? std::span<const PairKind>(kinds_in_space) : std::span<const PairKind>(kinds_in_plane);
}

/// Every pair of parts of a kind that may be taken: no shared vertex, bodies that meet.
std::vector<Candidate> all_pairs(PairKind kind, const CollisionSurface& surface,
                                 const BodyMeetings& meetings) {
  const CandidateList none = SurfaceCandidates{}.list(kind, surface);
  const auto count = [](std::span<const Index> vertices, int each) {
    return static_cast<Index>(vertices.size()) / each;
  };
  const Index m = count(none.first_vertices, num_first(kind)),
              n = count(none.second_vertices, num_second(kind));
  std::vector<Candidate> pairs;
  for (Index a = 0; a < m; ++a)
    for (Index b = kind == PairKind::edge_edge ? a + 1 : 0; b < n; ++b) {
      const auto v = none.vertices({a, b});
      const auto split = v.begin() + num_first(kind), end = v.begin() + num_vertices(kind);
      const auto body = [&](Index vertex) { return surface.bodies[static_cast<std::size_t>(vertex)]; };
      if (!meetings.meet(body(v[0]), body(*split))) continue;
      if (std::find_first_of(v.begin(), split, split, end) == split) pairs.push_back({a, b});
    }
  return pairs;
}

/// The least squared distance of each pair on its way, at 33 times.
std::vector<double> least_squares(const CandidateList& list, const RandomBodies& bodies) {
  std::vector<double> least(list.pairs.size(), std::numeric_limits<double>::infinity()),
      now(list.pairs.size());
  for (int k = 0; k <= 32; ++k) {
    std::vector<double> x = bodies.x;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += k / 32.0 * bodies.p[i];
    squared_distances(list, moving_points(bodies.surface.dim, x), now);
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], now[i]);
  }
  return least;
}

std::span<const Candidate> found_pairs(const BroadPhase& broad_phase, PairKind kind) {
  return broad_phase.candidates().list(kind, broad_phase.surface()).pairs;
}

/// Returns how many pairs are near.
std::size_t expect_nothing_missed(const RandomBodies& bodies, const BodyMeetings& meetings, double distance) {
  const int dim = bodies.surface.dim;
  BroadPhase broad_phase(bodies.surface, meetings, moving_points(dim, bodies.x));
  broad_phase.find(bodies.points(), distance);
  std::size_t near = 0;
  for (const PairKind kind : kinds_of(dim)) {
    const std::span<const Candidate> found = found_pairs(broad_phase, kind);
    EXPECT_TRUE(std::ranges::is_sorted(found));
    EXPECT_EQ(std::ranges::adjacent_find(found), found.end());
    const std::vector<Candidate> all = all_pairs(kind, bodies.surface, meetings);
    EXPECT_TRUE(std::ranges::includes(all, found));
    CandidateList list = SurfaceCandidates{}.list(kind, bodies.surface);
    list.pairs = all;
    const std::vector<double> least = least_squares(list, bodies);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!(least[i] <= distance * distance)) continue;
      ++near;
      EXPECT_TRUE(std::ranges::binary_search(found, all[i])) << all[i][0] << " " << all[i][1];
    }
  }
  return near;
}

TEST(BroadPhase, MissesNothingThatBruteForceFinds) {
  std::size_t near = 0;
  for (const int dim : {2, 3}) {
    for (const double size : {0.03, 0.2}) {
      for (const double way : {0.0, 0.1, 3.0}) {
        for (const bool self : {false, true}) {
          const RandomBodies bodies(dim, 5, 7, 30, size, way);
          near += expect_nothing_missed(bodies, BodyMeetings(7, self), 0.05);
        }
      }
    }
  }
  EXPECT_GT(near, 10000U);
}

TEST(BroadPhase, MissesNothingOnAGridNorFarAwayNorAtAnySize) {
  for (const int dim : {2, 3}) {
    RandomBodies on_grid(dim, 6, 3, 60, 0.4, 0.2);
    for (double& value : on_grid.x) value = std::round(8 * value) / 8;  // boxes that just touch, flat ones
    EXPECT_GT(expect_nothing_missed(on_grid, BodyMeetings(3, true), 0.0), 100U);
    expect_nothing_missed(on_grid, BodyMeetings(3, true), 0.125);
    for (const double scale : {1e-6, 1e6}) {
      RandomBodies scaled(dim, 7, 3, 60, 0.3, 0.1);
      for (std::vector<double>* numbers : {&scaled.x, &scaled.p})
        for (double& value : *numbers) value *= scale;
      expect_nothing_missed(scaled, BodyMeetings(3, true), 0.03 * scale);
      for (double& value : scaled.x) value += 1e5 * scale;
      expect_nothing_missed(scaled, BodyMeetings(3, true), 0.03 * scale);
    }
  }
}

/// The found boxes are those that meet: no more than those of boxes larger by the rounding.
TEST(BroadPhase, FindsLittleMoreThanTheBoxesThatMeet) {
  const RandomBodies bodies(3, 8, 5, 60, 0.1, 0.05);
  const BodyMeetings meetings(5, true);
  const std::vector<MovingPoint> points = bodies.points();
  BroadPhase broad_phase(bodies.surface, meetings, points);
  const double distance = 0.01, grown = distance * (1 + 1e-4);
  broad_phase.find(points, distance);
  for (const PairKind kind : kinds_in_space) {
    std::size_t count = 0;
    const CandidateList none = SurfaceCandidates{}.list(kind, bodies.surface);
    for (const Candidate& pair : all_pairs(kind, bodies.surface, meetings)) {
      const auto v = none.vertices(pair);
      bool meets = true;
      for (std::size_t i = 0; i < 3; ++i) {
        double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
        for (int k = 0; k < num_vertices(kind); ++k) {
          const MovingPoint& point = points[static_cast<std::size_t>(v[static_cast<std::size_t>(k)])];
          const int side = k < num_first(kind) ? 0 : 1;
          low[side] = std::min({low[side], point.x[i], point.x[i] + point.p[i]});
          high[side] = std::max({high[side], point.x[i], point.x[i] + point.p[i]});
        }
        meets = meets && low[0] <= high[1] + grown && low[1] <= high[0] + grown;
      }
      if (meets) ++count;
    }
    EXPECT_LE(found_pairs(broad_phase, kind).size(), count);
    EXPECT_GT(count, 100U);
  }
}

TEST(BroadPhase, FindsTheSameForAnyNumberOfThreadsInstructionSetAndOrderOfItsTrees) {
  for (const int dim : {2, 3}) {
    const RandomBodies bodies(dim, 9, 6, 200, 0.3, 0.01);
    const std::vector<MovingPoint> points = bodies.points();
    const int before = num_threads();
    std::vector<SurfaceCandidates> found;
    for (const int threads : {1, 2}) {
      set_num_threads(threads);
      for (const InstructionSet set : available_instruction_sets()) {
        BroadPhase broad_phase(bodies.surface, BodyMeetings(6, true), points, set);
        found.push_back(broad_phase.find(points, 0.01));
        broad_phase.rebuild(std::vector<MovingPoint>(points.size()));  // all in one place: any order
        found.push_back(broad_phase.find(points, 0.01));
      }
    }
    set_num_threads(before);
    for (const SurfaceCandidates& other : found) {
      EXPECT_EQ(other.point_edge, found[0].point_edge);
      EXPECT_EQ(other.point_triangle, found[0].point_triangle);
      EXPECT_EQ(other.edge_edge, found[0].edge_edge);
    }
    EXPECT_GT(found[0].point_edge.size() + found[0].edge_edge.size(), 1000U);
  }
}

TEST(BroadPhase, LeavesOutBodiesThatDoNotMeet) {
  const RandomBodies bodies(3, 10, 4, 40, 0.5, 0.1);
  BodyMeetings meetings(4);
  meetings.set(0, 1, false);
  meetings.set(2, 2, true);
  BroadPhase broad_phase(bodies.surface, meetings, bodies.points());
  broad_phase.find(bodies.points(), 0.1);
  std::set<std::pair<Index, Index>> met;
  for (const PairKind kind : kinds_in_space) {
    const CandidateList list = broad_phase.candidates().list(kind, bodies.surface);
    for (const Candidate& pair : list.pairs) {
      const auto v = list.vertices(pair);
      met.insert(std::minmax(bodies.surface.bodies[static_cast<std::size_t>(v[0])],
                             bodies.surface.bodies[static_cast<std::size_t>(v[num_first(kind)])]));
    }
  }
  EXPECT_EQ(met, (std::set<std::pair<Index, Index>>{{0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 2}, {2, 3}}));
}

TEST(CollisionSurface, HasEachEdgeOfItsBodiesOnce) {
  CollisionSurface tets;
  const std::vector<Index> facets = {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0};
  EXPECT_EQ(add_body(tets, 4, facets), 0);
  EXPECT_EQ(add_body(tets, 4, facets), 4);
  EXPECT_EQ(tets.bodies, (std::vector<Index>{0, 0, 0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(tets.points.size(), 8U);
  EXPECT_EQ(tets.triangles.size(), 24U);
  EXPECT_EQ(tets.triangles[12], 4);
  EXPECT_EQ(tets.edges,
            (std::vector<Index>{0, 1, 0, 2, 0, 3, 1, 2, 1, 3, 2, 3, 4, 5, 4, 6, 4, 7, 5, 6, 5, 7, 6, 7}));
  CollisionSurface line{.dim = 2, .points = {}, .edges = {}, .triangles = {}, .bodies = {}};
  add_body(line, 3, std::vector<Index>{0, 1, 2, 1});
  EXPECT_EQ(line.edges, (std::vector<Index>{0, 1, 1, 2}));
  EXPECT_TRUE(line.triangles.empty());
}

TEST(BroadPhase, OfNothingFindsNothing) {
  BroadPhase nothing({}, BodyMeetings(0), {});
  EXPECT_TRUE(nothing.find({}, 1).edge_edge.empty());
  CollisionSurface points;
  points.points = {0, 1};
  points.bodies = {0, 1};
  const std::vector<MovingPoint> two(2);
  BroadPhase only_points(points, BodyMeetings(2), two);
  EXPECT_TRUE(only_points.find(two, 1).point_triangle.empty());
}

TEST(BroadPhase, RefusesPlacesThatAreNoNumbers) {
  const RandomBodies bodies(3, 11, 2, 20, 0.5, 0.1);
  BroadPhase broad_phase(bodies.surface, BodyMeetings(2), bodies.points());
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    std::vector<MovingPoint> points = bodies.points();
    points[17].p[2] = bad;
    EXPECT_THROW(broad_phase.find(points, 0.1), std::invalid_argument);
  }
  EXPECT_NO_THROW(broad_phase.find(bodies.points(), 0.1));
}

}  // namespace
}  // namespace resilin
