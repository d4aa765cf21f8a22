// Scenes with contact of embedded surfaces: refused ones, and the choices for the others.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "resilin/world/meeting_surface.hpp"
#include "round_skin.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Cubes of 1 m with balls of 0.5 m as skins, the second moved by `way`.
Description two_balls(const Vector3& way, int num_cuts = 2) {
  Description scene;
  scene.is_dynamic = true;
  scene.gravity = {0, 0, -9.81};
  for (const char* name : {"first", "second"}) {
    BodyDescription body;
    body.place = name;
    body.name = name;
    body.element = "P1";
    body.mesh = make_box({1, 1, 1}, {2, 2, 2});
    body.skin = SkinDescription{.place = std::string(name) + ".skin",
                                .surface = ball_surface(0.5, {0.5, 0.5, 0.5}, num_cuts),
                                .surface_name = "ball.obj"};
    body.contact_surface = MeetingSurface::skin;
    scene.bodies.push_back(body);
  }
  scene.bodies[1].translate = way;
  return scene;
}

TEST(ABodyWithoutASkin, CannotMeetOthersWithIt) {
  for (const int dimension : {2, 3}) {
    Description scene = small_bar(dimension, true);
    scene.bodies[0].contact_surface = MeetingSurface::skin;
    EXPECT_THAT(refusal_of(scene),
                AllOf(HasSubstr("body.contact_surface: expected \"boundary\" for a body without a skin"),
                      HasSubstr("got \"skin\"")));
  }
}

TEST(SkinsThatMeet, AreRefusedWhereTheyGoThroughEachOtherAndNotWhereOnlyCellsDo) {
  EXPECT_THAT(refusal_of(two_balls({0.75, 0.75, 0})),
              IsEmpty());  // cells share space, balls are 0.06 m apart
  EXPECT_THAT(refusal_of(two_balls({0.6, 0.6, 0})),
              AllOf(HasSubstr("\"first\" and \"second\""), HasSubstr("move \"second\" by (")));
  Description inside = two_balls({0.3, 0.3, 0.3});
  inside.bodies[1].scale = 0.3;
  EXPECT_THAT(refusal_of(inside), AllOf(HasSubstr("overlap near"), HasSubstr("move \"second\" by (")));
  EXPECT_THAT(refusal_of(two_balls({1, 0, 0})), HasSubstr("\"first\" and \"second\" touch near"));
  EXPECT_THAT(refusal_of(two_balls({1.001, 0, 0})), IsEmpty());
}

TEST(SkinsThatMeet, MayStandOutOfTheirCells) {
  Description scene = two_balls({1.05, 0, 0});
  for (BodyDescription& body : scene.bodies) body.skin->surface = ball_surface(0.6, {0.5, 0.5, 0.5}, 2);
  EXPECT_THAT(refusal_of(scene), AllOf(HasSubstr("\"first\" and \"second\""), HasSubstr("move \"second\"")));
  scene.bodies[1].translate.x() = 1.21;
  EXPECT_THAT(refusal_of(scene), IsEmpty());
}

TEST(AnOpenSkin, HasNoInside) {
  Description scene = two_balls({0.3, 0.3, 0.3}, 3);
  scene.bodies[1].scale = 0.3;
  std::vector<Index>& facets = scene.bodies[0].skin->surface.block(CellKind::triangle).nodes;
  facets.resize(facets.size() - 3);
  EXPECT_THAT(refusal_of(scene), IsEmpty());
  const World world(scene);
  EXPECT_FALSE(has_inside(world, world.bodies[0]));
  EXPECT_TRUE(has_inside(world, world.bodies[1]));
}

TEST(AFlatOpenSkin, TakesTheThicknessOfItsCells) {
  Description scene = two_balls({0, 0, 1.2});
  scene.bodies.resize(1);
  Mesh& sheet = scene.bodies[0].skin->surface;
  sheet = make_rectangle({1, 1}, {8, 8});
  EXPECT_THAT(refusal_of(scene), IsEmpty());
  const World world(scene);
  EXPECT_EQ(thinnest_extent(world, world.bodies[0]), 1);
  EXPECT_EQ(default_activation_distance(world), 0.005);
}

TEST(ASkin, ThatIsVeryFineIsFeltFromNoFartherThanItsSides) {
  const World coarse(two_balls({1.1, 0, 0}, 2)), fine(two_balls({1.1, 0, 0}, 7));
  // A box with the second moments of a ball has sides of sqrt(0.6) diameters.
  const double of_ball = 0.005 * std::sqrt(0.6);
  EXPECT_NEAR(default_activation_distance(coarse), of_ball, 0.05 * of_ball);
  // 8 * 4^7 triangles share the ball's area.
  const double side = std::sqrt(4 / std::sqrt(3.0) * 4 * 3.14159265 * 0.25 / (8 * std::pow(4, 7)));
  EXPECT_NEAR(default_activation_distance(fine), std::min(of_ball, side), 0.1 * side);
}

TEST(ASkin, WithATriangleWithoutAreaIsRefusedOnlyWhereItMeets) {
  Description scene = two_balls({1.1, 0, 0});
  Mesh& surface = scene.bodies[1].skin->surface;
  const Index a = surface.block(CellKind::triangle).nodes[0], b = surface.block(CellKind::triangle).nodes[1];
  const auto corner = [&](Index v) { return surface.vertices[static_cast<std::size_t>(v)]; };
  surface.vertices.push_back(0.5 * (corner(a) + corner(b)));
  const auto middle = static_cast<Index>(surface.vertices.size() - 1);
  auto& facets = surface.block(CellKind::triangle).nodes;
  facets.insert(facets.end(), {a, b, middle});
  EXPECT_THAT(refusal_of(scene), AllOf(HasSubstr("second.skin: ball.obj: expected triangles with an area")));
  scene.bodies[1].contact_surface = MeetingSurface::boundary;
  EXPECT_THAT(refusal_of(scene), IsEmpty());
}

TEST(ASkinWithASeam, CannotMeetItself) {
  Description scene = two_balls({1.1, 0, 0});
  Mesh& surface = scene.bodies[0].skin->surface;
  auto& facets = surface.block(CellKind::triangle).nodes;
  for (std::size_t k = 0; k < facets.size() / 2; ++k) {  // half of the triangles have vertices of their own
    surface.vertices.push_back(surface.vertices[static_cast<std::size_t>(facets[k])]);
    facets[k] = static_cast<Index>(surface.vertices.size() - 1);
  }
  EXPECT_THAT(refusal_of(scene), IsEmpty());
  scene.contact.with_themselves = true;
  EXPECT_THAT(refusal_of(scene),
              AllOf(HasSubstr("parts of \"first\" touch near"), HasSubstr("merge coincident vertices")));
}

TEST(AColliderThatASkinStartsIn, IsRefusedWithTheVertexOfTheSkin) {
  for (const char* kind : {"half_space", "box"}) {
    Description scene = two_balls({1.1, 0, 0});
    ColliderDescription collider;
    collider.place = "ground";
    collider.name = "ground";
    collider.kind = kind;
    collider.shape.center = {0.5, 0.5, -0.9};
    collider.shape.size = {8, 8, 2};
    collider.shape.point = {0, 0, 0.1};
    collider.shape.normal = Vector3::UnitZ();
    scene.colliders = {collider};
    EXPECT_THAT(refusal_of(scene),
                AllOf(HasSubstr("ground: "), HasSubstr(" of ball.obj, the skin of \""), HasSubstr("0.1 m")))
        << kind;
    scene.colliders[0].shape.point.z() = -0.01;  // through the cells alone it would be on them
    scene.colliders[0].shape.center.z() = -1.01;
    EXPECT_THAT(refusal_of(scene), IsEmpty()) << kind;
  }
}

TEST(ASkinInThePlane, MayBeACurveOrATriangulation) {
  Description scene = small_bar(2, true);
  Mesh fine = make_rectangle({1, 0.25}, {20, 5});
  scene.bodies[0].skin = SkinDescription{.place = "skin", .surface = fine, .surface_name = "fine.msh"};
  scene.bodies[0].contact_surface = MeetingSurface::skin;
  const World world(scene);
  EXPECT_EQ(meeting_body(world.bodies[0], 2, 1.0).facets.num_cells(), 50);
  EXPECT_TRUE(has_inside(world, world.bodies[0]));
}

}  // namespace
}  // namespace resilin::testing
