// The rest shape that loads deform into what was drawn, for all elements and laws.

#include "resilin/sensitivity/rest_shape.hpp"
#include "every_element.hpp"
#include "resilin/core/error.hpp"
#include "short_bar.hpp"

namespace resilin::testing {
namespace {

/// Runs the scene from the rest shape found, by means of nothing but a mesh with these vertices.
void expect_deforms_into_drawn(const Description& drawn, const RestShape& found, double least_change) {
  Description scene = drawn;
  scene.newton.tolerance = 1e-11;
  const int dim = scene.dimension;
  std::vector<Vector3>& vertices = scene.bodies[0].mesh.vertices;
  const std::vector<Vector3> target = vertices;
  double change = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    vertices[v].head(dim) = found.bodies[0].rest.segment(static_cast<Eigen::Index>(v) * dim, dim);
    change = std::max(change, (vertices[v] - target[v]).norm());
  }
  EXPECT_GT(change, least_change * found.size);
  const Simulation end = converged_end_of(scene);
  for (std::size_t v = 0; v < target.size(); ++v) {
    const Vector3 at = end.world().place_of(static_cast<Index>(v), end.state().positions);
    EXPECT_LT((at - target[v]).norm(), 1e-8 * found.size) << v;
  }
  EXPECT_LE(found.distance, 1e-8 * found.size);
}

Description soft_bar(int dimension, const std::string& element) {
  Description scene = short_bar(dimension, false, element);
  scene.bodies[0].material.constants["youngs_modulus"] = 8e4;
  return scene;
}

using EveryElementsRestShape = OnEveryElement;

TEST_P(EveryElementsRestShape, DeformsIntoWhatWasDrawn) {
  const Description scene = soft_bar(element.dim, std::string(element.name));
  expect_deforms_into_drawn(scene, find_rest_shape(scene), 0.02);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryElementsRestShape, ::testing::ValuesIn(elements()), name_of_element);

TEST(RestShapeOfEveryLaw, DeformsIntoWhatWasDrawn) {
  for (const LawInfo* law : laws()) {
    SCOPED_TRACE(law->name);
    Description scene = short_bar(3, false);
    scene.bodies[0].material = material_of(*law);
    expect_deforms_into_drawn(scene, find_rest_shape(scene), 0.002);
  }
}

TEST(RestShape, IsFoundUnderLoadsThatFollowItAndWithASupportThatMoves) {
  Description scene = soft_bar(3, "P1");
  LoadDescription air;
  air.name = "air";
  air.kind = "pressure";
  air.where.kind = Where::Kind::box;
  air.where.min = {0.4, -1, -1};
  air.where.max = {1, 1, 1};
  air.pressure = 2e3;
  scene.loads.push_back(air);
  scene.fixes[0].displacement = {0.02, 0.01, 0};
  scene.fixes[0].gradient(0, 1) = 0.1;
  const RestShape found = find_rest_shape(scene);
  EXPECT_LE(found.distance, 1e-8 * found.size);
  // Where it was drawn, the support has led it.
  const VectorX& rest = found.bodies[0].rest;
  const Vector3 first = scene.bodies[0].mesh.vertices[0];
  EXPECT_NEAR(rest[0] + 0.02 + 0.1 * rest[1], first[0], 1e-9);
  EXPECT_NEAR(rest[1] + 0.01, first[1], 1e-9);
}

TEST(RestShape, IsFoundFarFromTheOrigin) {
  Description scene = soft_bar(3, "P1");
  const RestShape near = find_rest_shape(scene);
  scene.bodies[0].translate = {0, 1e4, 0};
  const RestShape far = find_rest_shape(scene);
  for (Eigen::Index i = 0; i < near.bodies[0].rest.size(); ++i)
    EXPECT_NEAR(near.bodies[0].rest[i] + (i % 3 == 1 ? 1e4 : 0), far.bodies[0].rest[i], 1e-8);
}

TEST(RestShape, IsTheDrawnOneWithoutLoads) {
  Description scene = soft_bar(3, "P1");
  scene.gravity.setZero();
  EXPECT_EQ(find_rest_shape(scene).distance, 0);
}

/// A beam under its weight.
Description hanging_beam(const std::string& element) {
  Description scene = soft_bar(3, element);
  scene.bodies[0].mesh = make_box({0.8, 0.2, 0.1}, {8, 2, 2});
  scene.fixes[0].where.kind = Where::Kind::group;
  scene.fixes[0].where.group = "x_min";
  scene.gravity = {0, 0, -9.81};
  return scene;
}

/// Where there is none, smaller parts of the loads are soon turned to: it took 39 and 10 iterations.
TEST(RestShape, IsSoonRefusedToBodiesThatAreFarTooSoft) {
  for (const double modulus : {2e4, 5e3}) {
    Description scene = hanging_beam("P2");
    scene.bodies[0].material.constants["youngs_modulus"] = modulus;
    int iterations = 0;
    const auto counts = [&](const RestShapeProgress& progress) {
      EXPECT_FALSE(progress.is_judging);
      iterations = progress.iterations + 1;
      return true;
    };
    EXPECT_THROW(find_rest_shape(scene, {.goes_on = counts}), InputError);
    EXPECT_LE(iterations, 60) << modulus;
  }
}

TEST(RestShape, IsSaidToBeSoughtInPartsOfTheLoads) {
  Description scene = hanging_beam("P1");
  std::vector<RestShapeProgress> told;
  const RestShapeOptions options{.goes_on = [&](const RestShapeProgress& progress) {
    told.push_back(progress);
    return true;
  }};
  scene.bodies[0].material.constants["youngs_modulus"] = 5e5;
  find_rest_shape(scene, options);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.front().text(), "a shape for 0 % of the loads, towards 100 %, iteration 0");
  EXPECT_TRUE(told.back().is_judging);
  EXPECT_EQ(told.back().text().find("a run from the shape found, at "), 0U) << told.back().text();

  told.clear();
  scene.bodies[0].material.constants["youngs_modulus"] = 2e4;  // more than half of the loads is too much
  EXPECT_THROW(find_rest_shape(scene, options), InputError);
  for (std::size_t i = 1; i < told.size(); ++i) {
    EXPECT_GE(told[i].share, told[i - 1].share);
    EXPECT_GT(told[i].towards, told[i].share);
    EXPECT_EQ(told[i].iterations, told[i - 1].iterations + 1);
  }
  EXPECT_GT(told.back().share, 0.5);

  const auto gives_up = [](const RestShapeProgress& progress) { return progress.iterations < 3; };
  EXPECT_THROW(find_rest_shape(scene, {.goes_on = gives_up}), Interrupted);
}

TEST(RestShape, IsRefusedInWords) {
  const auto text_of = [](const Description& scene) {
    try {
      find_rest_shape(scene);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  Description motion = soft_bar(3, "P1");
  motion.is_dynamic = true;
  EXPECT_NE(text_of(motion).find("\"static\""), std::string::npos);
  Description column = soft_bar(2, "P1");  // far beyond what makes it buckle
  column.bodies[0].material.constants["youngs_modulus"] = 3e2;
  column.gravity = {-9.81, 0, 0};
  const std::string text = text_of(column);
  EXPECT_NE(text.find("stress-free shape"), std::string::npos) << text;
  EXPECT_EQ(text.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace resilin::testing
