#include "resilin/mesh/fitted_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/mesh/check.hpp"
#include "resilin/mesh/curved_cells.hpp"
#include "resilin/mesh/delaunay.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/quality.hpp"
#include "resilin/mesh/surface_features.hpp"
#include "resilin/mesh/surface_places.hpp"
#include "resilin/mesh/topology.hpp"
#include "round_skin.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

/// Two surfaces as one.
Mesh joined(Mesh mesh, const Mesh& other, const Vector3& shift = Vector3::Zero(), bool is_turned = false) {
  const auto first = static_cast<Index>(mesh.vertices.size());
  for (const Vector3& X : other.vertices) mesh.vertices.emplace_back(X + shift);
  std::vector<Index> nodes = other.blocks[0].nodes;
  for (std::size_t i = 0; is_turned && i < nodes.size(); i += 3) std::swap(nodes[i], nodes[i + 1]);
  for (const Index node : nodes) mesh.block(CellKind::triangle).nodes.push_back(node + first);
  return mesh;
}

Mesh cuboid(const Vector3& size) {
  Mesh surface = extract_surface(make_box(size, {1, 1, 1})).mesh;
  surface.groups.clear();
  return surface;
}

/// Around the z axis, of a profile in r and z that is a polygon counterclockwise.
Mesh revolved(const std::vector<Vector<2>>& profile, Index around) {
  Mesh mesh;
  const auto across = static_cast<Index>(profile.size());
  for (Index i = 0; i < around; ++i)
    for (const Vector<2>& point : profile) {
      const double angle = 2 * std::numbers::pi * i / around;
      mesh.vertices.emplace_back(point[0] * std::cos(angle), point[0] * std::sin(angle), point[1]);
    }
  std::vector<Index>& nodes = mesh.block(CellKind::triangle).nodes;
  for (Index i = 0; i < around; ++i)
    for (Index j = 0; j < across; ++j) {
      const auto at = [&](Index a, Index b) { return a % around * across + b % across; };
      nodes.insert(nodes.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      nodes.insert(nodes.end(), {at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

Mesh torus(double radius, double tube) {
  std::vector<Vector<2>> profile;
  for (int j = 0; j < 24; ++j) {
    const double angle = 2 * std::numbers::pi * j / 24;
    profile.emplace_back(radius + tube * std::cos(angle), tube * std::sin(angle));
  }
  return revolved(profile, 48);
}

/// A plate with a hole, round outside too: four sharp circles.
Mesh washer(double inner, double outer, double thickness) {
  return revolved({{inner, 0}, {outer, 0}, {outer, thickness}, {inner, thickness}}, 48);
}

double volume_of_cells(const Mesh& mesh) {
  const auto volumes = signed_volumes(mesh, mesh.blocks[0]);
  return std::accumulate(volumes.begin(), volumes.end(), 0.0);
}

struct Expected {
  double volume = 0.01;  ///< error, by the volume
  double angle = 8;      ///< least dihedral [degrees]
  double distance =
      0.15;  ///< distance of the sides of cells and of the surface from each other, by the cell size
  Index parts = 1;
};

/// Promises of fitted cells.
void expect_fitted(const FittedMesh& fitted, const Mesh& surface, const Expected& expected = {}) {
  const MeshReport report = check_mesh(fitted.mesh, 3);
  ASSERT_TRUE(report.errors.empty()) << report.errors[0].text();
  const CellBlock& cells = fitted.mesh.blocks[0];
  const auto num_vertices = static_cast<Index>(fitted.mesh.vertices.size());
  EXPECT_EQ(connected_components(cells, num_vertices).count, expected.parts);
  const Pinches pinches = find_pinches(cells, num_vertices);
  EXPECT_TRUE(pinches.vertices.empty());
  EXPECT_TRUE(pinches.edges.empty());
  const CellBlock rim = boundary(cells).facets;
  EXPECT_TRUE(nonmanifold_edges(rim).empty());
  EXPECT_TRUE(open_edges(fitted.mesh, rim).empty());
  EXPECT_GT(std::ranges::min(smallest_dihedral_angles(fitted.mesh, cells)), expected.angle);
  EXPECT_NEAR(volume_of_cells(fitted.mesh), fitted.volume_ratio * fitted.volume, 1e-9 * fitted.volume);
  EXPECT_NEAR(fitted.volume_ratio, 1, expected.volume);

  const SolidSurface solid = make_solid_surface(surface, "a"),
                     own = make_solid_surface(extract_surface(fitted.mesh).mesh, "b");
  const SurfacePlaces places(solid), own_places(own);
  double farthest = 0;
  for (const SurfacePlace& place : own_places.spread(3000))
    farthest = std::max(farthest, (places.nearest(place.X).X - place.X).norm());
  for (const SurfacePlace& place : places.spread(3000))
    if (!places.has_overlaps() || places.is_rim(place))
      farthest = std::max(farthest, (own_places.nearest(place.X).X - place.X).norm());
  EXPECT_LT(farthest, expected.distance * fitted.cell_size);
}

TEST(FittedMesh, FollowsSmoothSurfacesOfAnySizeAndPlace) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const Mesh& shape : {ball_surface(0.5, {0.1, 0, 0}, 4), torus(1, 0.35)})
    for (const double scale : {1e-3, 1.0, 1e3}) {
      Mesh surface = shape;
      const Eigen::Quaterniond turned(normal(random), normal(random), normal(random), normal(random));
      transform(surface, scale * turned.normalized().toRotationMatrix(),
                scale * Vector3(normal(random), normal(random), 5 * normal(random)));
      const FittedMesh fitted = make_fitted_mesh(surface, "a.stl", {2000});
      EXPECT_NEAR(fitted.mesh.blocks[0].num_cells(), 2000, 400);
      EXPECT_TRUE(fitted.remarks.empty());
      expect_fitted(fitted, surface, {.volume = 0.005});
    }
}

/// Corners are vertices, sharp edges are edges of cells, and the volume is exact up to rounding.
TEST(FittedMesh, KeepsCornersAndSharpEdges) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 3; ++i) {
    Mesh surface = cuboid({1, 0.6, 0.3});
    const Eigen::Quaterniond turned(normal(random), normal(random), normal(random), normal(random));
    if (i > 0) transform(surface, turned.normalized().toRotationMatrix(), Vector3(1, 2, 3));
    const FittedMesh fitted = make_fitted_mesh(surface, "a.stl", {1500});
    expect_fitted(fitted, surface, {.volume = 1e-6, .distance = 1e-5});
    for (const Vector3& corner : surface.vertices)
      EXPECT_TRUE(std::ranges::any_of(fitted.mesh.vertices,
                                      [&](const Vector3& X) { return (X - corner).norm() < 1e-9; }));
  }
}

TEST(FittedMesh, KeepsRoundSharpEdges) {
  const Mesh surface = washer(0.4, 1, 0.3);
  expect_fitted(make_fitted_mesh(surface, "a.stl", {3000}), surface);
}

/// The wall is half as thick as the cells are long.
TEST(FittedMesh, ThinWallsStayWhole) {
  const Mesh plate = cuboid({1, 1, 0.02});
  const FittedMesh flat = make_fitted_mesh(plate, "a.stl", {1500});
  EXPECT_GT(flat.cell_size, 0.04);
  expect_fitted(flat, plate, {.volume = 1e-6, .angle = 4});
  const Mesh tube = washer(0.48, 0.5, 1);
  const FittedMesh round = make_fitted_mesh(tube, "a.stl", {4000});
  EXPECT_GT(round.cell_size, 0.04);
  expect_fitted(round, tube, {.volume = 0.02, .angle = 4});
}

TEST(FittedMesh, IsTheSameForAnyNumberOfThreads) {
  const Mesh surface = torus(1, 0.3);
  const int before = num_threads();
  set_num_threads(1);
  const Mesh one = make_fitted_mesh(surface, "a.stl", {1500}).mesh;
  set_num_threads(3);
  const Mesh three = make_fitted_mesh(surface, "a.stl", {1500}).mesh;
  set_num_threads(before);
  EXPECT_EQ(one.vertices, three.vertices);
  EXPECT_EQ(one.blocks[0].nodes, three.blocks[0].nodes);
}

TEST(FittedMesh, BrokenSurfacesAreFilledToo) {
  const Mesh ball = ball_surface(1, Vector3::Zero(), 4);
  Mesh inverted = ball, partly = ball, open = ball;
  for (std::size_t t = 0; t < ball.blocks[0].nodes.size(); t += 3) {
    std::swap(inverted.blocks[0].nodes[t], inverted.blocks[0].nodes[t + 1]);
    if (t % 9 == 0) std::swap(partly.blocks[0].nodes[t], partly.blocks[0].nodes[t + 1]);
  }
  open.blocks[0].nodes.resize(open.blocks[0].nodes.size() - 3 * 8);
  remove_unused_nodes(open);
  expect_fitted(make_fitted_mesh(inverted, "a.stl", {1000}), ball);
  const FittedMesh of_partly = make_fitted_mesh(partly, "a.stl", {1000});
  expect_fitted(of_partly, ball);
  ASSERT_EQ(of_partly.remarks.size(), 1u);
  EXPECT_THAT(of_partly.remarks[0], HasSubstr("wound against"));
  expect_fitted(make_fitted_mesh(joined(ball, ball), "a.stl", {1000}), ball);
  const FittedMesh of_open = make_fitted_mesh(open, "a.stl", {1000});
  EXPECT_THAT(of_open.remarks.at(0), HasSubstr("open edges"));
  expect_fitted(of_open, ball, {.distance = 0.5});  // a lid over the hole
}

TEST(FittedMesh, CrossingPartsAreOneBodyCavitiesStayEmptyAndPartsApartStayApart) {
  const Mesh ball = ball_surface(1, Vector3::Zero(), 4);
  // Two balls of radius 1 whose centres are d apart: 8/3 pi less the lens pi (4 + d) (2 - d)^2 / 12.
  const Mesh crossing = joined(ball, ball, {1.2, 0, 0});
  const FittedMesh both = make_fitted_mesh(crossing, "a.stl", {3000});
  const double lens = std::numbers::pi * (4 + 1.2) * (2 - 1.2) * (2 - 1.2) / 12;
  EXPECT_NEAR(both.volume, 8.0 / 3 * std::numbers::pi - lens, 0.02 * both.volume);
  expect_fitted(both, crossing, {.volume = 0.02, .distance = 0.4});  // no line where they cross

  const Mesh hollow = joined(ball, ball_surface(0.6, Vector3::Zero(), 4), Vector3::Zero(), true);
  expect_fitted(make_fitted_mesh(hollow, "a.stl", {4000}), hollow);

  const Mesh apart = joined(ball, ball, {5, 0, 0});
  expect_fitted(make_fitted_mesh(apart, "a.stl", {2000}), apart, {.parts = 2});
}

std::string refusal_of_fitting(const Mesh& surface, int cells = 1000) {
  try {
    make_fitted_mesh(surface, "a.stl", {cells});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FittedMesh, WhatEnclosesNothingIsRefusedInWords) {
  Mesh sheet = ball_surface(1, Vector3::Zero(), 4);
  sheet.blocks[0].nodes.resize(sheet.blocks[0].nodes.size() / 2);
  remove_unused_nodes(sheet);
  EXPECT_THAT(refusal_of_fitting(sheet),
              HasSubstr("a.stl: expected a surface that encloses a volume, got an open"));
  Mesh flat;
  flat.vertices = {Vector3::Zero(), Vector3::UnitX(), Vector3::UnitY()};
  flat.block(CellKind::triangle).nodes = {0, 1, 2};
  EXPECT_THAT(refusal_of_fitting(flat), HasSubstr("open sheet"));
  EXPECT_THAT(refusal_of_fitting(Mesh{}), HasSubstr("a surface of triangles, got none"));
  EXPECT_THAT(refusal_of_fitting(ball_surface(1, Vector3::Zero(), 1), 0),
              HasSubstr("from 1 to 2000000, got 0"));
}

TEST(FittedMesh, FewCellsAreEnough) {
  for (const int cells : {1, 60, 200}) {
    const Mesh ball = ball_surface(1, Vector3::Zero(), 3);
    expect_fitted(make_fitted_mesh(ball, "a.stl", {cells}), ball, {.volume = 0.1, .distance = 0.3});
  }
}

/// Remembered sides are those of the winding number, near the surface and far from it.
TEST(SurfacePlaces, KnowTheSameInsideWhetherOrNotPointsAreExpected) {
  const Mesh ball = ball_surface(1, Vector3::Zero(), 3);
  Mesh open = ball, turned = ball;
  open.blocks[0].nodes.resize(open.blocks[0].nodes.size() - 3 * 4);
  remove_unused_nodes(open);
  for (std::size_t t = 0; t < turned.blocks[0].nodes.size(); t += 9)
    std::swap(turned.blocks[0].nodes[t], turned.blocks[0].nodes[t + 1]);
  const Mesh hollow = joined(ball, ball_surface(0.6, Vector3::Zero(), 3), Vector3::Zero(), true);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.3, 1.3);
  for (const Mesh& mesh : {ball, torus(0.8, 0.2), hollow, joined(ball, ball, {0.8, 0.1, 0}), open, turned,
                           cuboid({1, 0.01, 1}), washer(0.9, 1, 0.02)}) {
    const SolidSurface surface = make_solid_surface(mesh, "a");
    const SurfacePlaces plain(surface);
    SurfacePlaces expecting(surface);
    EXPECT_FALSE(expecting.is_known_outside({100, 0, 0}));
    expecting.expect_points(0.1);
    EXPECT_TRUE(expecting.is_known_outside({100, 0, 0}));
    int num_inside = 0, num_different = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vector3 X(uniform(random), i % 2 == 0 ? uniform(random) : 0.005, uniform(random));
      num_inside += plain.is_inside(X) ? 1 : 0;
      num_different += plain.is_inside(X) != expecting.is_inside(X) ? 1 : 0;
    }
    EXPECT_EQ(num_different, 0);
    EXPECT_GT(num_inside, 10);
  }
}

FittedMesh quadratic(const Mesh& surface, int cells) {
  return make_fitted_mesh(surface, "a.stl", {.cells = cells, .is_quadratic = true});
}

/// Nodes of the boundary and the middles of its sides lie on the surface; the volume is that of the surface
/// to a fraction of the error of flat sides, and no cell is folded.
TEST(FittedMesh, QuadraticCellsEndAtTheTrueSurface) {
  for (const Mesh& surface : {ball_surface(1, {3, 0, 0}, 5), torus(1, 0.6), washer(0.4, 1, 0.3)}) {
    const SolidSurface solid = make_solid_surface(surface, "a");
    const SurfacePlaces places(solid);
    const FittedMesh fitted = quadratic(surface, 1500);
    const CellBlock& cells = fitted.mesh.blocks[0];
    ASSERT_EQ(cells.kind, CellKind::tetrahedron10);
    EXPECT_TRUE(cell_signs(fitted.mesh, cells).folded.empty());
    EXPECT_NEAR(fitted.volume_ratio, 1, 2e-3);
    EXPECT_NEAR(exact_volume(fitted.mesh, cells), fitted.volume_ratio * fitted.volume, 1e-9 * fitted.volume);
    std::vector<Index> rim = boundary(cells).facets.nodes;
    std::ranges::sort(rim);
    rim.erase(std::ranges::unique(rim).begin(), rim.end());
    std::size_t num_off = 0;
    for (const Index v : rim) {
      const Vector3& X = fitted.mesh.vertices[static_cast<std::size_t>(v)];
      if ((places.nearest(X).X - X).norm() > 1e-4 * fitted.cell_size) ++num_off;
    }
    EXPECT_LE(num_off, rim.size() / 6);  // those that had to stay, for the cell's sake
  }
}

/// The wall is thinner than the sagitta of the chords: straight cells alone would cross it.
TEST(FittedMesh, QuadraticCellsOfThinCurvedWallsStayValid) {
  const Mesh tube = washer(0.49, 0.5, 0.6);
  const FittedMesh fitted = quadratic(tube, 3000);
  EXPECT_TRUE(cell_signs(fitted.mesh, fitted.mesh.blocks[0]).folded.empty());
  EXPECT_NEAR(fitted.volume_ratio, 1, 0.02);
}

/// A thick plate with a thin web: the web gets cells as short as it is thick, the plate does not.
TEST(FittedMesh, MinSizeGradesCellsToWallsAndCurvature) {
  const double wall = 0.05;
  const Mesh profile =
      revolved({{0.4, 0}, {1, 0}, {1, 0.4}, {0.4 + wall, 0.4}, {0.4 + wall, 1}, {0.4, 1}}, 64);
  const auto shortest_and_longest = [](const FittedMesh& fitted) {
    double shortest = 1e9, longest = 0;
    for (const auto& [a, b] : edges(fitted.mesh.blocks[0])) {
      const double length = (fitted.mesh.vertices[static_cast<std::size_t>(a)] -
                             fitted.mesh.vertices[static_cast<std::size_t>(b)])
                                .norm();
      shortest = std::min(shortest, length);
      longest = std::max(longest, length);
    }
    return std::pair(shortest, longest);
  };
  const FittedMesh even = make_fitted_mesh(profile, "a.stl", {.size = 0.2}),
                   graded = make_fitted_mesh(profile, "a.stl", {.size = 0.2, .min_size = wall}),
                   coarse = make_fitted_mesh(profile, "a.stl", {.size = 0.2, .min_size = 0.2});
  EXPECT_GT(graded.mesh.blocks[0].num_cells(), 3 * even.mesh.blocks[0].num_cells());
  EXPECT_LE(coarse.mesh.blocks[0].num_cells(), even.mesh.blocks[0].num_cells());
  expect_fitted(graded, profile, {.volume = 0.01, .angle = 5});
  const auto [shortest, longest] = shortest_and_longest(graded);
  EXPECT_GT(shortest, 0.2 * wall);
  EXPECT_GT(longest, 0.2);  // inside the plate cells stay large
}

TEST(CurvedCells, BendOnlyAsFarAsTheyStayValid) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0},     {1, 0, 0},   {0, 1, 0},   {0, 0, 1},     {0.5, 0, 0},
                   {0.5, 0.5, 0}, {0, 0.5, 0}, {0, 0, 0.5}, {0, 0.5, 0.5}, {0.5, 0, 0.5}};
  mesh.block(CellKind::tetrahedron10).nodes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  ASSERT_TRUE(cell_signs(mesh, mesh.blocks[0]).folded.empty());
  EXPECT_NEAR(exact_volume(mesh, mesh.blocks[0]), 1.0 / 6, 1e-15);
  Mesh near = mesh, far = mesh;
  const Vector3 bulge(0.6, 0.6, 0);
  EXPECT_EQ(bend_edges(near, std::array{BentEdge{5, bulge}}), 0);
  EXPECT_EQ(near.vertices[5], bulge);
  EXPECT_GT(exact_volume(near, near.blocks[0]), 1.0 / 6);
  // At (0, 0, 0) the middle of the opposite edge would fold the cell; so would one next to a corner.
  for (const Vector3& wanted : {Vector3(0, 0, 0), Vector3(0.95, 0.05, 0), Vector3(0.5, 0.5, 3)}) {
    Mesh folded = mesh;
    folded.vertices[5] = wanted;
    const bool is_folded = !cell_signs(folded, folded.blocks[0]).folded.empty();
    far = mesh;
    EXPECT_EQ(bend_edges(far, std::array{BentEdge{5, wanted}}), is_folded ? 1 : 0) << wanted.transpose();
    EXPECT_TRUE(cell_signs(far, far.blocks[0]).folded.empty());
  }
}

/// The signs are exact, so that a grid, whose cubes are cospherical, is filled without flat cells or
/// overlaps.
TEST(Delaunay, FillsACubeWhateverIsInserted) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int32_t> coordinate(1, Delaunay::extent - 1);
  for (const bool is_grid : {true, false}) {
    Delaunay delaunay;
    std::vector<Delaunay::Point> points;
    for (int i = 0; i < 8; ++i)
      points.push_back({(i & 1) != 0 ? Delaunay::extent : 0, (i & 2) != 0 ? Delaunay::extent : 0,
                        (i & 4) != 0 ? Delaunay::extent : 0});
    for (int i = 0; i < 343; ++i) {
      Delaunay::Point point = {coordinate(random), coordinate(random), coordinate(random)};
      if (is_grid) point = {(i % 7 + 1) << 20, (i / 7 % 7 + 1) << 20, (i / 49 + 1) << 20};
      EXPECT_EQ(delaunay.insert(point), static_cast<Index>(points.size()));
      points.push_back(point);
      EXPECT_EQ(delaunay.insert(point), static_cast<Index>(points.size()) - 1);
    }
    double volume = 0;
    const auto X = [&](Index i) -> Vector3 {
      const Delaunay::Point& p = points[static_cast<std::size_t>(i)];
      return Vector3(p[0], p[1], p[2]) / Delaunay::extent;
    };
    for (const auto& tetrahedron : delaunay.tetrahedra()) {
      if (!tetrahedron.is_there()) continue;
      const auto [a, b, c, d] = tetrahedron.nodes;
      const double part = (X(b) - X(a)).dot((X(c) - X(a)).cross(X(d) - X(a))) / 6;
      EXPECT_GT(part, 0);
      volume += part;
    }
    EXPECT_NEAR(volume, 1, 1e-12);
  }
}

TEST(SurfaceFeatures, AreTheEdgesOfABoxAndNoneOfABall) {
  const SolidSurface box = make_solid_surface(cuboid({3, 2, 1}), "box");
  const SurfaceFeatures features = find_features(box, 0.1);
  EXPECT_EQ(features.corners.size(), 8u);
  EXPECT_EQ(features.lines.size(), 12u);
  double length = 0;
  for (const CreaseLine& line : features.lines) length += line.length();
  EXPECT_NEAR(length, 24, 1e-12);
  EXPECT_TRUE(
      find_features(make_solid_surface(ball_surface(1, Vector3::Zero(), 4), "ball"), 0.1).lines.empty());
  const SurfaceFeatures of_washer = find_features(make_solid_surface(washer(0.4, 1, 0.3), "washer"), 0.1);
  EXPECT_EQ(of_washer.corners.size(), 0u);
  ASSERT_EQ(of_washer.lines.size(), 4u);
  for (const CreaseLine& line : of_washer.lines) EXPECT_TRUE(line.is_closed());
}

}  // namespace
}  // namespace resilin::testing
