#include "resilin/mesh/surface_lattice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <random>

#include "resilin/core/error.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/mesh/check.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/embedding.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/mesh/quality.hpp"
#include "resilin/mesh/solid_surface.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/mesh/winding_number.hpp"
#include "round_skin.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

/// Around the z axis.
Mesh torus_surface(double radius, double tube) {
  constexpr Index around = 48, across = 24;
  Mesh mesh;
  for (Index i = 0; i < around; ++i)
    for (Index j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double r = radius + tube * std::cos(v);
      mesh.vertices.emplace_back(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
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

Mesh box_surface(const Vector3& size) {
  Mesh surface = extract_surface(make_box(size, {1, 1, 1})).mesh;
  surface.groups.clear();
  return surface;
}

void add(Mesh& mesh, const Mesh& other) {
  const auto first = static_cast<Index>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Index node : other.blocks[0].nodes) mesh.block(CellKind::triangle).nodes.push_back(node + first);
}

void turn(Mesh& mesh, Index triangle) {
  const auto at = static_cast<std::size_t>(3 * triangle);
  std::swap(mesh.blocks[0].nodes[at], mesh.blocks[0].nodes[at + 1]);
}

void remove_triangles(Mesh& mesh, const std::function<bool(const Vector3& middle)>& is_removed) {
  std::vector<Index> kept;
  for (Index t = 0; t < mesh.blocks[0].num_cells(); ++t) {
    Vector3 middle = Vector3::Zero();
    for (const Index node : mesh.blocks[0].cell(t))
      middle += mesh.vertices[static_cast<std::size_t>(node)] / 3;
    const auto nodes = mesh.blocks[0].cell(t);
    if (!is_removed(middle)) kept.insert(kept.end(), nodes.begin(), nodes.end());
  }
  mesh.blocks[0].nodes = kept;
  remove_unused_nodes(mesh);
}

double volume_of(const Mesh& mesh) {
  const auto volumes = signed_volumes(mesh, mesh.blocks[0]);
  return std::accumulate(volumes.begin(), volumes.end(), 0.0);
}

/// Corners and points inside of each triangle.
std::vector<Vector3> points_of(const Mesh& surface) {
  std::vector<Vector3> points = surface.vertices;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (Index t = 0; t < surface.blocks[0].num_cells(); ++t)
    for (int i = 0; i < 3; ++i) {
      const auto X = [&](std::size_t k) -> const Vector3& {
        return surface.vertices[static_cast<std::size_t>(surface.blocks[0].cell(t)[k])];
      };
      const double u = uniform(random), v = uniform(random) * (1 - u);
      points.emplace_back(X(0) + u * (X(1) - X(0)) + v * (X(2) - X(0)));
    }
  return points;
}

/// Promises of every lattice.
void expect_sound(const SurfaceLattice& lattice, const Mesh& surface, bool is_connected = true) {
  const MeshReport report = check_mesh(lattice.mesh, 3);
  EXPECT_TRUE(report.errors.empty()) << report.errors[0].text();
  if (is_connected) {
    EXPECT_TRUE(report.warnings.empty()) << report.warnings[0].text();
  }
  const CellBlock& cells = lattice.mesh.blocks[0];
  const auto angles = smallest_dihedral_angles(lattice.mesh, cells);
  EXPECT_NEAR(*std::ranges::min_element(angles), 60, 1e-5);  // rounding of places by extents
  const std::vector<Vector3> points = points_of(surface);
  VectorX X(static_cast<Eigen::Index>(3 * lattice.mesh.vertices.size()));
  for (std::size_t v = 0; v < lattice.mesh.vertices.size(); ++v)
    X.segment<3>(static_cast<Eigen::Index>(3 * v)) = lattice.mesh.vertices[v];
  const Embedding embedding(*find_element("P1", 3), cells.nodes, X, points);
  EXPECT_EQ(embedding.outside().count, 0);
  for (Index p = 0; p < embedding.num_points(); ++p)
    ASSERT_GE(std::ranges::min(embedding.weights(p)), -1e-8) << "point " << p;
}

struct Shape {
  std::string name;
  Mesh surface;
  double volume;  ///< enclosed volume; of curved surfaces by their divergence
};

double enclosed(const Mesh& mesh) {
  double volume = 0;
  for (Index t = 0; t < mesh.blocks[0].num_cells(); ++t) {
    const auto X = [&](std::size_t k) -> const Vector3& {
      return mesh.vertices[static_cast<std::size_t>(mesh.blocks[0].cell(t)[k])];
    };
    volume += X(0).dot(X(1).cross(X(2))) / 6;
  }
  return volume;
}

std::vector<Shape> shapes() {
  std::vector<Shape> all = {{"ball", ball_surface(0.5, {0.1, 0, 0}, 4), 0},
                            {"torus", torus_surface(1, 0.3), 0},
                            {"box", box_surface({1, 0.5, 0.25}), 0},
                            {"plate", box_surface({1, 1, 0.01}), 0}};
  for (Shape& shape : all) shape.volume = enclosed(shape.surface);
  return all;
}

TEST(SurfaceLattice, HoldsAnySurfaceOfAnySizeAndPlace) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (const Shape& shape : shapes())
    for (const double scale : {1e-3, 1.0, 1e3}) {
      Mesh surface = shape.surface;
      const Eigen::Quaterniond turned(normal(random), normal(random), normal(random), normal(random));
      transform(surface, scale * turned.normalized().toRotationMatrix(),
                scale * Vector3(normal(random), normal(random), 5 * normal(random)));
      SCOPED_TRACE(shape.name + " by " + std::to_string(scale));
      const SurfaceLattice lattice = make_surface_lattice(surface, "a.stl");
      expect_sound(lattice, surface);
      EXPECT_GE(volume_of(lattice.mesh), shape.volume * std::pow(scale, 3));
      EXPECT_NEAR(lattice.volume_ratio, volume_of(lattice.mesh) / (shape.volume * std::pow(scale, 3)), 1e-6);
      EXPECT_TRUE(lattice.remarks.empty());
    }
}

TEST(SurfaceLattice, HasAboutAsManyCellsAsAreWanted) {
  for (const Shape& shape : shapes())
    for (const int wanted : {500, 4000, 20000}) {
      const Index count = make_surface_lattice(shape.surface, "a.stl", {wanted}).mesh.blocks[0].num_cells();
      EXPECT_NEAR(count, wanted, wanted / 3.0) << shape.name;  // flat sides pass whole layers of cells
    }
}

/// The protruding layer is about as thick as a cell: it goes with the spacing.
TEST(SurfaceLattice, VolumeConvergesToThatOfTheSurface) {
  for (const Shape& shape : {shapes()[0], shapes()[1], shapes()[2]}) {
    double excess = 0, spacing = 0;
    for (const int wanted : {1000, 10000, 100000}) {
      const SurfaceLattice lattice = make_surface_lattice(shape.surface, "a.stl", {wanted});
      const double now = volume_of(lattice.mesh) / shape.volume - 1;
      EXPECT_GT(now, 0);
      if (spacing > 0) {
        EXPECT_NEAR(now / excess, lattice.spacing / spacing, 0.35 * lattice.spacing / spacing) << shape.name;
      }
      excess = now;
      spacing = lattice.spacing;
    }
    EXPECT_LT(excess, 0.3) << shape.name;
  }
}

TEST(SurfaceLattice, IsTheSameForAnyNumberOfThreads) {
  const Mesh surface = torus_surface(1, 0.3);
  const int before = num_threads();
  set_num_threads(1);
  const Mesh one = make_surface_lattice(surface, "a.stl").mesh;
  set_num_threads(3);
  const Mesh three = make_surface_lattice(surface, "a.stl").mesh;
  set_num_threads(before);
  EXPECT_EQ(one.vertices, three.vertices);
  EXPECT_EQ(one.blocks[0].nodes, three.blocks[0].nodes);
}

TEST(SurfaceLattice, DoesNotCareHowTrianglesAreWound) {
  const Mesh ball = ball_surface(1, Vector3::Zero(), 4);
  const SurfaceLattice expected = make_surface_lattice(ball, "a.stl");
  Mesh inverted = ball, partly = ball;
  for (Index t = 0; t < ball.blocks[0].num_cells(); ++t) {
    turn(inverted, t);
    if (t % 3 == 0) turn(partly, t);
  }
  const SurfaceLattice of_inverted = make_surface_lattice(inverted, "a.stl");
  EXPECT_EQ(of_inverted.mesh.blocks[0].nodes, expected.mesh.blocks[0].nodes);
  EXPECT_TRUE(of_inverted.remarks.empty());
  const SurfaceLattice of_partly = make_surface_lattice(partly, "a.stl");
  EXPECT_EQ(of_partly.mesh.blocks[0].nodes, expected.mesh.blocks[0].nodes);
  ASSERT_EQ(of_partly.remarks.size(), 1u);
  EXPECT_THAT(of_partly.remarks[0], HasSubstr("a.stl: 683 triangles"));  // a third of 2048
}

/// The hole is wider than a cell: nothing but the winding number keeps the inside.
TEST(SurfaceLattice, SurfacesWithHolesAreFilled) {
  Mesh ball = ball_surface(1, Vector3::Zero(), 5);
  remove_triangles(ball, [](const Vector3& middle) { return middle.z() > 0.92; });
  const SurfaceLattice lattice = make_surface_lattice(ball, "a.stl", {10000});
  EXPECT_LT(lattice.spacing, 0.5 * std::sqrt(1 - 0.92 * 0.92));
  expect_sound(lattice, ball);
  const SurfaceLattice closed = make_surface_lattice(ball_surface(1, Vector3::Zero(), 5), "a.stl", {10000});
  EXPECT_NEAR(volume_of(lattice.mesh), volume_of(closed.mesh), 0.05 * volume_of(closed.mesh));
  ASSERT_EQ(lattice.remarks.size(), 1u);
  EXPECT_THAT(lattice.remarks[0], HasSubstr("open edges"));
}

TEST(SurfaceLattice, TrianglesThatDoNotHangTogetherAreFilledToo) {
  const Mesh ball = ball_surface(1, Vector3::Zero(), 4);
  Mesh soup;
  soup.block(CellKind::triangle);
  for (Index t = 0; t < ball.blocks[0].num_cells(); ++t) {
    Vector3 middle = Vector3::Zero();
    for (const Index node : ball.blocks[0].cell(t))
      middle += ball.vertices[static_cast<std::size_t>(node)] / 3;
    for (const Index node : ball.blocks[0].cell(t)) {
      soup.blocks[0].nodes.push_back(static_cast<Index>(soup.vertices.size()));
      soup.vertices.emplace_back(middle + 0.999 * (ball.vertices[static_cast<std::size_t>(node)] - middle));
    }
  }
  const SurfaceLattice lattice = make_surface_lattice(soup, "a.stl");
  expect_sound(lattice, soup);
  EXPECT_GT(volume_of(lattice.mesh), 4);  // 4/3 pi
}

TEST(SurfaceLattice, CrossingPartsAreOneBodyAndCavitiesStayEmpty) {
  Mesh crossing = ball_surface(1, Vector3::Zero(), 4);
  add(crossing, ball_surface(1, {1.2, 0, 0}, 4));
  const SurfaceLattice both = make_surface_lattice(crossing, "a.stl");
  expect_sound(both, crossing);

  Mesh hollow = ball_surface(1, Vector3::Zero(), 4), cavity = ball_surface(0.7, Vector3::Zero(), 4);
  for (Index t = 0; t < cavity.blocks[0].num_cells(); ++t) turn(cavity, t);
  add(hollow, cavity);
  const SurfaceLattice shell = make_surface_lattice(hollow, "a.stl", {20000});
  expect_sound(shell, hollow);
  for (const Vector3& X : shell.mesh.vertices) EXPECT_GT(X.norm(), 0.5);
}

TEST(SurfaceLattice, PartsApartStayApart) {
  Mesh balls = ball_surface(1, Vector3::Zero(), 3);
  add(balls, ball_surface(1, {5, 0, 0}, 3));
  const SurfaceLattice lattice = make_surface_lattice(balls, "a.stl");
  expect_sound(lattice, balls, false);
  const auto count =
      connected_components(lattice.mesh.blocks[0], static_cast<Index>(lattice.mesh.vertices.size())).count;
  EXPECT_EQ(count, 2);
}

/// Points, edges and faces that parts share would be joints without moment: two cubes at a corner, at an
/// edge.
TEST(SurfaceLattice, NothingHangsByAVertexOrAnEdgeAlone) {
  for (const Vector3& place : {Vector3(1, 1, 1), Vector3(1, 1, 0)})
    for (const int wanted : {200, 1000, 3000, 9000}) {
      Mesh cubes = box_surface({1, 1, 1}), other = box_surface({1, 1, 1});
      transform(other, Matrix<3>::Identity(), place);
      add(cubes, other);
      expect_sound(make_surface_lattice(cubes, "a.stl", {wanted}), cubes);
    }
}

std::string refusal_of(const Mesh& surface, int cells = 4000) {
  try {
    make_surface_lattice(surface, "a.stl", {cells});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SurfaceLattice, WhatEnclosesNothingIsRefusedInWords) {
  Mesh sheet = ball_surface(1, Vector3::Zero(), 4);
  remove_triangles(sheet, [](const Vector3& middle) { return middle.z() < 0; });
  EXPECT_THAT(refusal_of(sheet),
              HasSubstr("a.stl: expected a surface that encloses a volume, got an open sheet"));
  Mesh flat;
  flat.vertices = {Vector3::Zero(), Vector3::UnitX(), Vector3::UnitY()};
  flat.block(CellKind::triangle).nodes = {0, 1, 2};
  EXPECT_THAT(refusal_of(flat), HasSubstr("open sheet"));
  flat.blocks[0].nodes = {0, 1, 2, 0, 2, 1};  // both sides
  EXPECT_THAT(refusal_of(flat), HasSubstr("flat"));
  flat.blocks[0].nodes = {0, 1, 1};
  EXPECT_THAT(refusal_of(flat), HasSubstr("triangles with an area"));
  EXPECT_THAT(refusal_of(Mesh{}), HasSubstr("a surface of triangles, got none"));
  Mesh huge = ball_surface(1e150, Vector3::Zero(), 1);
  EXPECT_THAT(refusal_of(huge), HasSubstr("finite"));
  EXPECT_THAT(refusal_of(ball_surface(1, Vector3::Zero(), 1), 0), HasSubstr("from 1 to 2000000, got 0"));
  EXPECT_THAT(refusal_of(ball_surface(1, Vector3::Zero(), 1), 2000001), HasSubstr("got 2000001"));
}

TEST(SolidSurface, CopiesOfTrianglesCountOnce) {
  const Mesh ball = ball_surface(1, Vector3::Zero(), 1);
  Mesh doubled = ball;
  std::vector<Index>& nodes = doubled.blocks[0].nodes;
  nodes.insert(nodes.end(), {nodes[1], nodes[2], nodes[0], nodes[3], nodes[4], nodes[5]});
  const SolidSurface once = make_solid_surface(ball, "a"), twice = make_solid_surface(doubled, "a");
  EXPECT_DOUBLE_EQ(twice.volume, once.volume);
  EXPECT_DOUBLE_EQ(twice.area, once.area);
}

/// A ball, and one with a cavity, whose walls cancel each other's dipoles.
TEST(WindingNumber, MomentsErrByHundredths) {
  const Vector3 middle(3, 2, 1);
  const Mesh ball = ball_surface(1, middle, 4);
  Mesh hollow = ball;
  std::vector<Index>& nodes = hollow.blocks[0].nodes;
  const auto num_vertices = static_cast<Index>(ball.vertices.size());
  for (const Vector3& X : ball.vertices) hollow.vertices.emplace_back(middle + 0.6 * (X - middle));
  for (std::size_t i = 0, end = nodes.size(); i < end; i += 3)
    for (const std::size_t corner : {0, 2, 1}) nodes.push_back(nodes[i + corner] + num_vertices);
  const WindingNumber winding(ball, ball.blocks[0]), around_cavity(hollow, hollow.blocks[0]);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 5000; ++i) {
    const Vector3 arm(normal(random), normal(random), normal(random));
    const double r = arm.norm();
    if (std::abs(r - 1) < 0.02 || std::abs(r - 0.6) < 0.02) continue;
    EXPECT_NEAR(winding(middle + arm), r < 1 ? 1 : 0, 0.05) << r;
    EXPECT_NEAR(around_cavity(middle + arm), r < 1 && r > 0.6 ? 1 : 0, 0.05) << r;
  }
}

/// Seen from inside the plane of a flat hole the lid would be there.
TEST(WindingNumber, IsOneHalfWhereTheLidOfAHoleWouldBe) {
  Mesh bowl = ball_surface(1, Vector3::Zero(), 5);
  remove_triangles(bowl, [](const Vector3& middle) { return middle.z() > 0; });
  const WindingNumber winding(bowl, bowl.blocks[0]);
  for (const double x : {0.0, 0.3, 0.6}) EXPECT_NEAR(winding({x, 0.1, 0}), 0.5, 0.03);
}

}  // namespace
}  // namespace resilin::testing
