#include "resilin/contact/contact_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "resilin/collision/collision_time.hpp"
#include "resilin/contact/contact_surface.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr double search_distance = 0.02;  // m

/// Two boxes above each other, each cut into 2 n^3 parts on its faces.
struct SearchedBoxes {
  ContactSurface surface;
  VectorX positions;

  SearchedBoxes(int n, double clearance) {
    std::vector<ContactBody> bodies;
    for (const double low : {0.0, 1 + clearance}) {
      const Mesh mesh = make_box({1, 1, 1}, {n, n, n}, {0, 0, low});
      CellBlock facets = boundary(*mesh.find_solid(3)).facets;
      const auto first = static_cast<Index>(positions.size() / 3);
      for (Index& node : facets.nodes) node += first;
      bodies.push_back({std::move(facets), 1e5});
      positions.conservativeResize(3 * (first + static_cast<Eigen::Index>(mesh.vertices.size())));
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        positions.segment<3>(3 * (first + static_cast<Eigen::Index>(v))) = mesh.vertices[v];
    }
    surface = make_contact_surface(3, bodies, positions);
  }
  ContactSearch search() const {
    const VectorX y = places();
    return {
        std::make_shared<const BroadPhase>(surface.parts, BodyMeetings(2),
                                           moving_points(3, {y.data(), static_cast<std::size_t>(y.size())})),
        search_distance};
  }
  VectorX places() const { return surface.places(positions); }
};

TEST(ContactSearch, FindsNothingAndSearchesNothingWhereBoxesOfBodiesAreApart) {
  const SearchedBoxes boxes(4, 0.2);
  ContactSearch search = boxes.search();
  EXPECT_TRUE(search.cover(boxes.places(), boxes.places()));
  EXPECT_TRUE(search.candidates().point_triangle.empty());
  EXPECT_TRUE(search.candidates().edge_edge.empty());
}

TEST(ContactSearch, SearchesAgainOnlyWhenVerticesLeaveTheirRegion) {
  const SearchedBoxes boxes(4, 0.5 * search_distance);
  ContactSearch search = boxes.search();
  const VectorX start = boxes.places();
  VectorX end = start;
  end.tail(end.size() / 2).array() += 3 * search_distance;  // the upper box goes aside and up
  EXPECT_TRUE(search.cover(start, end));
  const std::size_t count = search.candidates().edge_edge.size();
  EXPECT_GT(count, 0U);
  EXPECT_FALSE(search.cover(start, start));
  EXPECT_FALSE(search.cover(0.5 * (start + end), end));
  VectorX beside = end;
  beside[beside.size() - 1] += 0.4 * search_distance;
  EXPECT_FALSE(search.cover(end, beside));
  beside[beside.size() - 1] += 0.2 * search_distance;
  EXPECT_TRUE(search.cover(end, beside));
}

/// The results of earlier searches are always enough.
TEST(ContactSearch, HasAllPairsThatAreNear) {
  const SearchedBoxes boxes(3, 0.5 * search_distance);
  ContactSearch search = boxes.search();
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  VectorX places = boxes.places();
  for (int step = 0; step < 40; ++step) {
    VectorX next = places;
    for (double& coordinate : next) coordinate += 0.3 * search_distance * unit(generator);
    search.cover(places, next);
    ContactSearch fresh = boxes.search();
    fresh.cover(next, next);
    for (const PairKind kind : {PairKind::point_triangle, PairKind::edge_edge}) {
      const std::vector<MovingPoint> points =
          moving_points(3, {next.data(), static_cast<std::size_t>(next.size())});
      const auto num_near = [&](const SurfaceCandidates& candidates) {
        const CandidateList list = candidates.list(kind, boxes.surface.parts);
        std::vector<double> squares(list.pairs.size());
        squared_distances(list, points, squares);
        return std::ranges::count_if(
            squares, [](double square) { return square < search_distance * search_distance; });
      };
      EXPECT_EQ(num_near(search.candidates()), num_near(fresh.candidates())) << step;
    }
    places = next;
  }
}

}  // namespace
}  // namespace resilin
