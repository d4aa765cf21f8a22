#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "resilin/core/error.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/fields/extremes.hpp"
#include "resilin/fields/tensors.hpp"
#include "resilin/material/derive.hpp"
#include "resilin/mesh/facet.hpp"
#include "shared_data.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

/// A state of the bar with the same F everywhere.
State uniform_state(const World& world, const Matrix<3>& F) {
  State state;
  state.positions = world.rest_positions;
  state.velocities = VectorX::Zero(state.positions.size());
  for (Index i = 0; i < world.num_nodes(); ++i)
    state.positions.segment(Eigen::Index{i} * world.dimension, world.dimension) =
        (F * node_position(world.dimension, i, world.rest_positions)).head(world.dimension);
  return state;
}

Matrix<3> sample_F(int dim) {
  Matrix<3> F;
  F << 1.2, 0.1, 0, -0.2, 0.9, 0, 0, 0, 1;
  if (dim == 3) F(0, 2) = 0.15, F(2, 1) = -0.1, F(2, 2) = 1.1;
  return F;
}

std::vector<double> values_of(const World& world, const State& state, const std::string& name) {
  return FieldEvaluator(world).evaluate(state, std::vector{name}).front().values;
}

/// Every cell and, smoothed, every vertex has the tensor.
void expect_everywhere(const World& world, const State& state, const std::string& name,
                       const Matrix<3>& expected) {
  for (const std::string prefix : {"", "nodal_"}) {
    const std::vector<double> values = values_of(world, state, prefix + name);
    ASSERT_GT(values.size(), 0u);
    for (std::size_t i = 0; i < values.size(); i += 9) {
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> value(values.data() + i);
      // Displacements of the vertices carry round-offs of F; the fit is solved to 1e-13.
      ASSERT_LT((value - expected).norm(), 1e-11 * std::max(expected.norm(), 1e-3))
          << prefix << name << " in " << world.bodies[0].domains.front().law;
    }
  }
}

TEST(Fields, OfAUniformStateAreExactForEveryLawInTwoAndThreeDimensions) {
  for (const LawInfo* law : laws())
    for (const int dim : {2, 3}) {
      Description scene = small_bar(dim, false);
      scene.bodies[0].material = material_of(*law);
      const World world(scene);
      const Matrix<3> F = sample_F(dim);
      const State state = uniform_state(world, F);
      const Material material = world.bodies[0].domains.front().energy->material(0);
      const Matrix<3> P = first_piola_kirchhoff_stress<3>(material, F);
      const bool is_small = law->kind == LawKind::small_strain;
      expect_everywhere(world, state, "cauchy_stress", cauchy_stress<3>(material, F));
      expect_everywhere(world, state, "first_piola_kirchhoff_stress", P);
      expect_everywhere(world, state, "second_piola_kirchhoff_stress",
                        is_small ? P : Matrix<3>(F.inverse() * P));
      expect_everywhere(world, state, "green_strain", 0.5 * (F.transpose() * F - Matrix<3>::Identity()));
    }
}

TEST(Fields, ThatAreReadOffAStressAgreeWithIt) {
  const World world(small_bar(3, false));
  const Matrix<3> F = sample_F(3);
  const State state = uniform_state(world, F);
  const Matrix<3> sigma = cauchy_stress<3>(world.bodies[0].domains.front().energy->material(0), F);
  const Principal expected = principal(sigma);
  const double tolerance = 1e-11 * sigma.norm();  // as above
  for (const std::string prefix : {"", "nodal_"}) {
    EXPECT_NEAR(values_of(world, state, prefix + "von_mises")[3], von_mises(sigma), tolerance);
    EXPECT_NEAR(values_of(world, state, prefix + "pressure")[3], -sigma.trace() / 3, tolerance);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(values_of(world, state, prefix + "principal_stress")[9 + i], expected.values[i], tolerance);
      const auto direction = values_of(world, state, prefix + "principal_direction_" + std::to_string(i + 1));
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(direction[9 + static_cast<std::size_t>(k)], expected.directions(k, static_cast<int>(i)),
                    1e-9);
    }
    EXPECT_NEAR(values_of(world, state, prefix + "volume_ratio")[5], F.determinant(), 1e-12);
  }
}

TEST(Fields, OnTheNodesKeepTheMeanOfTheCells) {
  Simulation simulation = run_all(small_bar(3, false));
  const World& world = simulation.world();
  const std::vector<double> cells = values_of(world, simulation.state(), "volume_ratio");
  const std::vector<double> nodes = values_of(world, simulation.state(), "nodal_volume_ratio");
  const std::vector<double> volumes = world.bodies[0].domains.front().energy->rest_volumes();
  double of_cells = 0, of_nodes = 0;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    of_cells += volumes[cell] * (cells[cell] - 1);
    for (std::size_t a = 0; a < 4; ++a)
      of_nodes +=
          volumes[cell] / 4 * (nodes[static_cast<std::size_t>(world.bodies[0].cells[4 * cell + a])] - 1);
  }
  EXPECT_NEAR(of_nodes, of_cells,
              1e-11 * world.bodies[0].domains.front().energy->total_rest_volume());  // solved to 1e-13
}

TEST(Fields, OfTwoBodiesAreSmoothedEachForItself) {
  Description scene = small_bar(3, true);
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[1].name = "other";
  scene.contact.is_enabled = false;
  scene.fixes.clear();
  scene.probes.clear();
  const World world(scene);
  State state = uniform_state(world, Matrix<3>::Identity());
  const Body& other = world.bodies[1];  // lies in the first one, twice as long
  for (Index i = other.first_node; i < other.first_node + other.num_nodes; ++i)
    state.positions[3 * Eigen::Index{i}] *= 2;
  const std::vector<double> ratios = values_of(world, state, "nodal_volume_ratio");
  for (Index i = 0; i < world.num_nodes(); ++i)
    EXPECT_NEAR(ratios[static_cast<std::size_t>(i)], i < other.first_node ? 1 : 2, 1e-12);
}

/// Three names for three things, each with a label of its own; averages stay within the cells' range.
TEST(Fields, OfTheCellsHaveANameForEachWayToBringThemToTheVertices) {
  std::set<std::string> labels;
  for (const FieldInfo& field : fields()) EXPECT_TRUE(labels.insert(field.label).second) << field.label;
  EXPECT_EQ(require_field("von_mises", "it").label, "von Mises stress, by cell");
  EXPECT_EQ(require_field("averaged_von_mises", "it").label, "von Mises stress, averaged");
  EXPECT_EQ(require_field("nodal_von_mises", "it").label, "von Mises stress, smooth");
  Simulation simulation = run_all(small_bar(3, false));
  const World& world = simulation.world();
  const std::vector<double> cells = values_of(world, simulation.state(), "von_mises");
  const std::vector<double> averages = values_of(world, simulation.state(), "averaged_von_mises");
  const Body& body = world.bodies[0];
  const std::vector<double> volumes = body.domains.front().energy->rest_volumes();
  for (Index node = 0; node < world.num_nodes(); ++node) {
    double sum = 0, volume = 0;
    for (std::size_t i = 0; i < body.cells.size(); ++i)
      if (body.cells[i] == node) sum += volumes[i / 4] * cells[i / 4], volume += volumes[i / 4];
    EXPECT_NEAR(averages[static_cast<std::size_t>(node)], sum / volume, 1e-12 * sum / volume);
  }
  EXPECT_LT(std::ranges::max(averages), std::ranges::max(cells));
  EXPECT_GT(std::ranges::min(averages), std::ranges::min(cells));
}

/// A bar bent to a curvature of 1e-3 / m by quadratic displacements, whose fibres have the stress E kappa z.
/// A cell under the surface ends a quarter of the height below it.
TEST(Fields, SmoothStressMeetsTheBendingStressThatAveragesMiss) {
  Description scene = small_bar(3, false);
  scene.bodies[0].element = "P2";
  scene.bodies[0].mesh = make_box({1, 0.25, 0.25}, {8, 4, 4}, {0, 0, -0.125});
  scene.bodies[0].material.law = "linear_elastic";
  scene.bodies[0].material.constants = {{"youngs_modulus", 1e6}, {"poissons_ratio", 0}};
  const World world(scene);
  State state = uniform_state(world, Matrix<3>::Identity());
  constexpr double curvature = 1e-3;  // [1/m]
  for (Index i = 0; i < world.num_nodes(); ++i) {
    const Vector3 X = node_position(3, i, world.rest_positions);
    state.positions.segment<3>(Eigen::Index{3} * i) +=
        curvature * Vector3(X.x() * X.z(), 0, -0.5 * X.x() * X.x());
  }
  const double largest = 1e6 * curvature * 0.125;
  EXPECT_NEAR(std::ranges::max(values_of(world, state, "nodal_von_mises")), largest, 1e-9 * largest);
  EXPECT_LT(std::ranges::max(values_of(world, state, "averaged_von_mises")), 0.9 * largest);
}

TEST(Fields, ThatAreUnknownAreRefusedWithTheNearestName) {
  const World world(small_bar(2, false));
  const State state = uniform_state(world, Matrix<3>::Identity());
  try {
    values_of(world, state, "nodal_von_misses");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("did you mean \"nodal_von_mises\"?"));
  }
}

TEST(Fields, AreAllOnThePageAboutResults) {
  std::ifstream file(source_folder() / "docs" / "results.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  for (const FieldInfo& field : fields()) {
    std::string name = field.name;
    if (field.source == FieldInfo::Source::fit) name = name.substr(std::string("nodal_").size());
    if (field.source == FieldInfo::Source::averages) name = name.substr(std::string("averaged_").size());
    EXPECT_THAT(page, ::testing::HasSubstr("| `" + name + "` |")) << "docs/results.md";
  }
}

TEST(Extremes, NameTheValueAndThePlace) {
  const World world(small_bar(2, false));
  State state = uniform_state(world, Matrix<3>::Identity());
  state.positions[7] -= 0.01;  // y of vertex 3
  const std::vector<std::string> names = {"displacement", "volume_ratio", "cauchy_stress"};
  const std::vector<FieldValues> values = FieldEvaluator(world).evaluate(state, names);
  const auto displacement = extremes(world, state, values[0]);
  ASSERT_TRUE(displacement);
  EXPECT_NEAR(displacement->max.value, 0.01, 1e-15);
  EXPECT_EQ(displacement->max.number, 3);
  EXPECT_EQ(displacement->max.position, node_position(2, 3, state.positions));
  EXPECT_EQ(displacement->min.value, 0);
  const auto ratio = extremes(world, state, values[1]);
  ASSERT_TRUE(ratio);
  EXPECT_EQ(ratio->min.value, std::ranges::min(values[1].values));
  EXPECT_EQ(ratio->max.value, values[1].values[static_cast<std::size_t>(ratio->max.number)]);
  EXPECT_FALSE(extremes(world, state, values[2]));  // a tensor has no order
}

/// The farthest corner of a turned bar moves most, not a control node.
TEST(Extremes, OfARigidBodyAreAmongItsVertices) {
  Description scene = small_bar(2, true);
  scene.fixes.clear();
  scene.probes.clear();
  scene.bodies[0].rigid = RigidDescription{.density = 1000};
  const World world(scene);
  State state;
  state.positions = state.velocities = VectorX::Zero(world.rest_positions.size());
  for (Index node = 0; node < world.num_nodes(); ++node)
    state.positions.segment<2>(2 * node) = -world.rest_positions.segment<2>(2 * node);
  const std::vector<std::string> names = {"displacement", "von_mises"};
  const std::vector<FieldValues> values = FieldEvaluator(world).evaluate(state, names);
  const auto displacement = extremes(world, state, values[0]);
  ASSERT_TRUE(displacement);
  EXPECT_NEAR(displacement->max.value, 2 * std::hypot(1, 0.25), 1e-12);
  EXPECT_LT((displacement->max.position - Vector3(-1, -0.25, 0)).norm(), 1e-12);
  EXPECT_NEAR(displacement->min.value, 0, 1e-12);
  EXPECT_FALSE(extremes(world, state, values[1]));  // its stress is no number
}

}  // namespace
}  // namespace resilin::testing
