#include "resilin/view/surface_fields.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "resilin/core/error.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/mesh/edit.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

State state_at(const VectorX& x) {
  State state;
  state.positions = x;
  state.velocities = VectorX::Zero(x.size());
  return state;
}

std::vector<float> field_of(const World& world, const State& state, std::string_view name) {
  const ShownSurface surface(world);
  std::vector<float> values(static_cast<std::size_t>(surface.num_vertices()));
  SurfaceFields(world, surface).evaluate(world, state, name, values);
  return values;
}

TEST(SurfaceFields, OfAUniformStrainAreThoseOfTheCells) {
  for (const int dim : {2, 3}) {
    const World world(small_bar(dim, true));
    const State state = state_at(1.1 * world.rest_positions);
    for (const ScalarField& field : vertex_fields(dim)) {
      if (field.field->kind == FieldInfo::Kind::vector) continue;
      const std::vector<double> values =
          FieldEvaluator(world).evaluate(state, {&field.field->name, 1}).front().values;
      // Rounding of floats; entries that vanish are sums of such that do not.
      const double scale =
          std::abs(*std::ranges::max_element(values, {}, [](double v) { return std::abs(v); }));
      for (const float value : field_of(world, state, field.name))
        ASSERT_NEAR(value, field.at(values, 0), 1e-6 * std::max(scale, 1e-3)) << field.name;
    }
  }
}

TEST(SurfaceFields, OfNodesAreLengths) {
  const World world(small_bar(3, true));
  const Vector3 shift(0.3, -0.4, 1.2);
  VectorX x = world.rest_positions;
  for (Index node = 0; node < world.num_nodes(); ++node) x.segment<3>(3 * node) += shift;
  for (const float value : field_of(world, state_at(x), "displacement")) EXPECT_NEAR(value, 1.3, 1e-6);
  for (int i = 0; i < 3; ++i)
    for (const float value : field_of(world, state_at(x), std::string("displacement.") + "xyz"[i]))
      EXPECT_NEAR(value, shift[i], 1e-6);
}

/// Several at once are those one by one.
TEST(SurfaceFields, ShareWhatTheyAreComputedFrom) {
  const World world(small_bar(3, true));
  VectorX x = world.rest_positions;
  for (Index node = 0; node < world.num_nodes(); ++node) x[3 * node] *= 1 + 0.2 * x[3 * node];
  const std::vector<ScalarField> fields = vertex_fields(3);
  std::vector<std::vector<float>> together(fields.size());
  const ShownSurface surface(world);
  FieldEvaluator evaluator(world);
  SurfaceFields(world, surface).evaluate(evaluator, state_at(x), fields, together);
  for (std::size_t i = 0; i < fields.size(); ++i)
    EXPECT_EQ(together[i], field_of(world, state_at(x), fields[i].name)) << fields[i].name;
}

TEST(ScalarFields, AreAllThatAFieldConsistsOf) {
  for (const int dim : {2, 3}) {
    std::vector<std::string> names;
    for (const ScalarField& field : scalar_fields(dim)) names.push_back(field.name);
    for (const char* name :
         {"displacement", "displacement.x", "velocity.y", "von_mises", "principal_stress.3",
          "cauchy_stress.xy", "cauchy_stress.zz", "first_piola_kirchhoff_stress.yx", "nodal_pressure",
          "nodal_green_strain.xx", "energy_density", "volume_ratio"})
      EXPECT_THAT(names, ::testing::Contains(name)) << dim;
    for (const char* name : {"cauchy_stress", "cauchy_stress.yx", "principal_direction_1.x", "von_mises.x"})
      EXPECT_THAT(names, ::testing::Not(::testing::Contains(name))) << dim;
    EXPECT_EQ(std::ranges::count(names, "displacement.z"), dim == 3 ? 1 : 0);
    EXPECT_EQ(std::ranges::count(names, "cauchy_stress.xz"), dim == 3 ? 1 : 0);
    std::ranges::sort(names);
    EXPECT_EQ(std::ranges::adjacent_find(names), names.end()) << "each once";
  }
}

/// Where the volume ratio is linear along the bar, a vertex has the mean of its cells' by volume.
TEST(SurfaceFields, AreMeansOfTheCellsAroundAVertexByVolume) {
  const World world(small_bar(3, true));
  VectorX x = world.rest_positions;
  for (Index node = 0; node < world.num_nodes(); ++node) x[3 * node] *= 1 + 0.2 * x[3 * node];
  const State state = state_at(x);
  const std::vector<double> cells =
      FieldEvaluator(world).evaluate(state, std::vector<std::string>{"volume_ratio"}).front().values;
  const Body& body = world.bodies[0];
  const std::vector<double> volumes = body.domains.front().energy->rest_volumes();
  const ShownSurface surface(world);
  std::vector<float> values(static_cast<std::size_t>(surface.num_vertices()));
  SurfaceFields(world, surface).evaluate(world, state, "averaged_volume_ratio", values);
  for (Index v = 0; v < surface.num_vertices(); ++v) {
    double sum = 0, volume = 0;
    for (std::size_t i = 0; i < body.cells.size(); ++i)
      if (body.cells[i] == surface.nearest_node(v)) {
        sum += volumes[i / 4] * cells[i / 4];
        volume += volumes[i / 4];
      }
    EXPECT_NEAR(values[static_cast<std::size_t>(v)], sum / volume, 1e-6);
  }
}

TEST(SurfaceFields, OfASkinAreCarriedByItsWeights) {
  Description scene = small_bar(3, true);
  scene.bodies[0].skin = SkinDescription{
      .surface = extract_surface(make_box({1, 0.25, 0.25}, {32, 8, 8})).mesh, .surface_name = "fine"};
  const World world(scene);
  VectorX x = world.rest_positions;
  for (Index node = 0; node < world.num_nodes(); ++node) x[3 * node] *= 1.5;  // u is linear along the bar
  const std::vector<float> values = field_of(world, state_at(x), "displacement");
  const Skin& skin = *world.bodies[0].skin;
  for (Index v = 0; v < skin.num_vertices(); ++v)
    EXPECT_NEAR(values[static_cast<std::size_t>(v)], 0.5 * skin.rest_positions[3 * v], 1e-6);
}

TEST(SurfaceFields, AreNotANumberWhereACellHasNone) {
  Description scene = small_bar(3, true);
  scene.bodies[0].material.law = "neo_hookean";
  const World world(scene);
  const std::vector<float> values =
      field_of(world, state_at(-1.0 * world.rest_positions), "averaged_energy_density");
  EXPECT_THAT(values, ::testing::Each(::testing::IsNan()));  // turned inside out: the logarithm has no value
}

TEST(SurfaceFields, RefuseOthersByName) {
  const World world(small_bar(3, true));
  const State state = state_at(world.rest_positions);
  EXPECT_THROW(field_of(world, state, "von_misses"), InputError);
  EXPECT_THROW(field_of(world, state, "cauchy_stress"), InputError);
  EXPECT_THROW(field_of(world, state, "displacement.w"), InputError);
}

/// Its control nodes lie elsewhere than its vertices, and lengths are not linear.
TEST(SurfaceFields, OfARigidBodyAreThoseOfItsMotion) {
  Description scene = small_bar(3, true);
  scene.fixes.clear();
  scene.bodies[0].rigid = RigidDescription{.density = 1000};
  const World world(scene);
  VectorX x = world.rest_positions;
  for (Index node = 0; node < world.num_nodes(); ++node)
    x.segment<3>(3 * node) = Vector3(-x[3 * node + 1], x[3 * node], x[3 * node + 2]);
  const std::vector<float> lengths = field_of(world, state_at(x), "displacement");
  const ShownSurface surface(world);
  for (std::size_t v = 0; v < lengths.size(); ++v) {
    const float* X = surface.rest_positions().data() + 3 * v;
    EXPECT_NEAR(lengths[v], std::sqrt(2) * std::hypot(X[0], X[1]), 1e-6);
  }
  for (const char* name : {"averaged_von_mises", "nodal_pressure", "contact_pressure"})
    for (const float value : field_of(world, state_at(x), name)) EXPECT_TRUE(std::isnan(value)) << name;
}

}  // namespace
}  // namespace resilin::testing
