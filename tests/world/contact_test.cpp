// Scenes that contact between bodies refuses, and its choices for the others.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "resilin/world/body_overlap.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// The small bar and another one, moved by `way`.
Description two_bars(int dimension, const Vector3& way) {
  Description scene = small_bar(dimension, true);
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[1].name = "other";
  scene.bodies[1].translate = way;
  scene.fixes[0].body = scene.probes[0].body = "body";
  return scene;
}

TEST(BodiesThatMeet, AreRefusedWhereTheyShareSpaceOrTouchAtTheStart) {
  for (const int dimension : {2, 3})
    for (const double scale : {1e-3, 1.0, 1e3})
      for (const double x : {0.5, 0.999, 1.0, 1.001, 1.3}) {
        Description scene = two_bars(dimension, {scale * x, 0, 0});
        for (BodyDescription& body : scene.bodies) body.scale = scale;
        const std::string words = refusal_of(scene);
        const std::string what = std::to_string(dimension) + " " + std::to_string(x);
        if (x < 1) {
          EXPECT_THAT(words, AllOf(HasSubstr("contact: expected bodies that start apart"),
                                   HasSubstr("overlap"), HasSubstr("move \"other\" by (")))
              << what;
        } else if (x == 1) {
          EXPECT_THAT(words,
                      AllOf(HasSubstr("\"body\" and \"other\" touch"), HasSubstr("move \"other\" by (")))
              << what;
        } else {
          EXPECT_THAT(words, IsEmpty()) << what;
        }
      }
}

/// The words of a message are enough to mend the scene.
TEST(BodiesThatMeet, AreApartWhereTheCureMovesThem) {
  for (const int dimension : {2, 3})
    for (const double x : {-0.95, -0.5, 0.2, 0.999, 1.0}) {
      Description scene = two_bars(dimension, {x, 0.03, dimension == 3 ? 0.02 : 0});
      const std::string words = refusal_of(scene), before = "move \"other\" by (";
      ASSERT_THAT(words, HasSubstr(before));
      Vector3 way = Vector3::Zero();
      const char* text = words.c_str() + words.find(before) + before.size();
      for (int k = 0; k < dimension; ++k) {
        char* end = nullptr;
        way[k] = std::strtod(text, &end);
        text = end + 2;
      }
      scene.bodies[1].translate += way;
      EXPECT_THAT(refusal_of(scene), IsEmpty()) << x;
    }
}

TEST(BodiesThatMeet, AreRefusedWhereOneIsInTheOther) {
  for (const int dimension : {2, 3}) {
    Description scene = two_bars(dimension, {0.5, 0.1, dimension == 3 ? 0.1 : 0});
    scene.bodies[1].scale = 0.01;
    EXPECT_THAT(refusal_of(scene), HasSubstr("overlap"));
  }
}

TEST(BodiesThatPass, AreWarnedOfInstead) {
  Description scene = two_bars(3, {0.5, 0, 0});
  const auto warnings = [&] { return ::testing::PrintToString(World(scene).warnings); };
  scene.contact.is_enabled = false;
  EXPECT_THAT(warnings(), HasSubstr("pass through each other"));
  EXPECT_EQ(World(scene).contact, nullptr);
  scene.contact.is_enabled = true;
  scene.contact.pairs = {{.bodies = {"other", "body"}, .is_enabled = false, .friction = {}}};
  EXPECT_THAT(warnings(), HasSubstr("pass through each other"));
  EXPECT_EQ(World(scene).contact, nullptr);
}

TEST(PairsOfBodies, AreThoseOfTheScene) {
  Description scene = two_bars(3, {0, 0.5, 0});
  scene.contact.pairs = {{.place = "scene: contact.pair[0]", .bodies = {"body", "othr"}, .friction = {}}};
  EXPECT_THAT(refusal_of(scene),
              AllOf(HasSubstr("contact.pair[0].bodies"), HasSubstr("did you mean \"other\"")));
  scene.contact.pairs = {{.bodies = {"body", "body"}, .friction = {}}};
  const World world(scene);
  EXPECT_TRUE(world.meet(0, 0));
  EXPECT_TRUE(world.meet(0, 1));
  EXPECT_FALSE(world.meet(1, 1));
}

TEST(AnActivationDistance, IsRefusedWhereItReachesAcrossABody) {
  for (const int dimension : {2, 3}) {
    Description scene = two_bars(dimension, {0, 0.5, 0});
    for (const double distance : {0.13, 1.0}) {
      scene.contact.activation_distance = distance;
      EXPECT_THAT(refusal_of(scene), HasSubstr("half the thickness of every body, 0.125 m"));
    }
    for (const double distance : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
      scene.contact.activation_distance = distance;
      EXPECT_THAT(refusal_of(scene), HasSubstr("contact.activation_distance: expected a finite number > 0"));
    }
    scene.contact.activation_distance = 0.12;
    EXPECT_THAT(refusal_of(scene), IsEmpty());
    scene.contact.stiffness = 0;
    EXPECT_THAT(refusal_of(scene), HasSubstr("contact.stiffness"));
  }
}

/// Thin sheets are felt from nearer by.
TEST(AnActivationDistance, FitsThinBodiesByItself) {
  for (const int dimension : {2, 3})
    for (const double thickness : {0.1, 1e-2, 1e-3}) {
      Description scene = two_bars(dimension, {0, 2 * thickness, 0});
      for (BodyDescription& body : scene.bodies)
        for (Vector3& vertex : body.mesh.vertices) vertex.y() *= thickness / 0.25;
      scene.fixes.clear();
      scene.probes.clear();
      const World world(scene);
      EXPECT_NEAR(world.contact->activation_distance(), std::min(5e-3, 0.1 * thickness), 1e-12);
    }
}

/// A ring that is almost closed: its ends are `gap` apart.
Description open_ring(double gap) {
  Description scene = small_bar(2, true);
  Mesh& mesh = scene.bodies[0].mesh;
  mesh = make_rectangle({1, 0.1}, {40, 2});
  for (Vector3& vertex : mesh.vertices) {
    const double radius = 1 + vertex.y(), angle = (2 * std::acos(-1.0) - gap) * vertex.x();
    vertex = {radius * std::cos(angle), radius * std::sin(angle), 0};
  }
  scene.fixes.clear();
  scene.contact.with_themselves = true;
  return scene;
}

TEST(ABodyThatMeetsItself, FeelsNothingAtRest) {
  for (const double gap : {0.1, 1e-2, 1e-3}) {
    Description scene = open_ring(gap);
    const World world(scene);
    ASSERT_NE(world.contact, nullptr);
    EXPECT_EQ(world.contact->value(world.rest_positions, {}), 0);
    EXPECT_GT(world.contact->activation_distance(), 0.4 * std::min(gap, 0.01)) << gap;
    scene.contact.activation_distance = 0.02;
    if (gap < 0.02) {
      EXPECT_THAT(refusal_of(scene),
                  HasSubstr("the thinnest gap of self-contact in the reference configuration"));
    } else {
      EXPECT_THAT(refusal_of(scene), IsEmpty());
    }
  }
}

}  // namespace
}  // namespace resilin::testing
