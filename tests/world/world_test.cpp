// Errors and warnings of a world, and reports of a step.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "resilin/core/error.hpp"
#include "resilin/world/resultants.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string message_of(const std::function<void()>& function) {
  try {
    function();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "no error";
}

TEST(World, NamesTheFreeRigidMotionsOfAStaticBody) {
  Description scene = small_bar(3, false);
  scene.fixes.clear();
  EXPECT_THAT(refusal_of(scene), AllOf(HasSubstr("6 of 6 rigid-body motions"), HasSubstr("[[fix]]")));
  scene = small_bar(2, false);
  scene.fixes[0].components = {true, false, false};
  EXPECT_THAT(refusal_of(scene),
              AllOf(HasSubstr("1 of 3 rigid-body motions"), HasSubstr("translation along y")));
}

TEST(World, ChoosesTheElementByPoissonsRatioAtRestAndInMotionAlike) {
  const auto chosen = [](double poissons_ratio, bool is_dynamic) {
    Description scene = small_bar(3, is_dynamic);
    scene.bodies[0].element = "auto";
    scene.bodies[0].material.law = "stable_neo_hookean";
    scene.bodies[0].material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", poissons_ratio}};
    return World(scene).bodies[0].element;
  };
  for (const bool is_dynamic : {false, true}) {
    EXPECT_EQ(chosen(0.45, is_dynamic), "P2");  // the limit itself, whatever rounding makes of it
    EXPECT_EQ(chosen(0.46, is_dynamic), "P2P0");
  }
}

TEST(World, WarnsOfLinearElementsThatLock) {
  Description scene = small_bar(3, true);
  scene.bodies[0].element = "P1";
  scene.bodies[0].material.law = "stable_neo_hookean";
  scene.bodies[0].material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.49}};
  EXPECT_THAT(World(scene).warnings, ::testing::Contains(HasSubstr("P2P0")));
  scene.bodies[0].element = "P2P0";
  EXPECT_THAT(World(scene).warnings, ::testing::Not(::testing::Contains(HasSubstr("lock"))));
}

TEST(World, SaysInWordsHowABodyCanMove) {
  Description scene = small_bar(3, false);
  const auto message = [&](const char* components, const std::vector<Index>& vertices) {
    scene.fixes[0].where.kind = vertices.empty() ? Where::Kind::plane : Where::Kind::vertices;
    scene.fixes[0].where.vertices = vertices;
    for (std::size_t k = 0; k < 3; ++k)
      scene.fixes[0].components[k] = std::string(components).find("xyz"[k]) != std::string::npos;
    return refusal_of(scene);
  };
  const auto vertex_at = [&](const Vector3& X) {
    const auto& vertices = scene.bodies[0].mesh.vertices;
    for (std::size_t v = 0; v < vertices.size(); ++v)
      if ((vertices[v] - X).norm() < 1e-12) return static_cast<Index>(v);
    return Index{-1};
  };
  EXPECT_THAT(
      message("x", {}),
      AllOf(HasSubstr("3 of 6"), HasSubstr("translation along y, translation along z, rotation about x;")));
  // One vertex held, at a corner: it can turn about any axis through it.
  EXPECT_THAT(
      message("xyz", {vertex_at({1, 0.25, 0})}),
      AllOf(HasSubstr("3 of 6"), HasSubstr("rotation about x through (1, 0.25, 0)"),
            HasSubstr("rotation about z through (1, 0.25, 0)"), ::testing::Not(HasSubstr("translation"))));
  // A hinge along an oblique line.
  EXPECT_THAT(message("xyz", {vertex_at({0, 0, 0}), vertex_at({1, 0.25, 0.25})}),
              AllOf(HasSubstr("1 of 6"), HasSubstr("rotation about (0.943, 0.236, 0.236)"),
                    HasSubstr("away from the axis")));
  scene = small_bar(2, false);
  EXPECT_THAT(message("xy", {vertex_at({1, 0, 0})}),
              AllOf(HasSubstr("1 of 3"), HasSubstr("rotation about (1, 0)")));
}

TEST(World, NamesTheComponentThatIsNotHeld) {
  Description scene = small_bar(3, false);
  Mesh& mesh = scene.bodies[0].mesh;
  const Mesh other = make_box({1, 0.25, 0.25}, {1, 1, 1}, {3, 0, 0});
  const auto offset = static_cast<Index>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Index node : other.find_block(CellKind::tetrahedron)->nodes) {
    mesh.block(CellKind::tetrahedron).nodes.push_back(offset + node);
  }
  EXPECT_THAT(refusal_of(scene), HasSubstr("component 2"));
}

TEST(World, SpringsHoldABodyToo) {
  Description scene = small_bar(3, false);
  scene.fixes.clear();
  LoadDescription spring;
  spring.kind = "spring";
  spring.stiffness = 1e4;
  spring.where.kind = Where::Kind::plane;
  scene.loads.push_back(spring);
  EXPECT_TRUE(run_all(scene).is_finished());
}

TEST(World, NamesVertexAndBothSupportsThatDisagree) {
  Description scene = small_bar(3, false);
  scene.fixes.push_back(scene.fixes[0]);
  scene.fixes[0].place = "scene.toml: fix[0]";
  scene.fixes[1].place = "scene.toml: fix[1]";
  scene.fixes[1].displacement = {0.1, 0, 0};
  EXPECT_THAT(refusal_of(scene), AllOf(HasSubstr("fix[0]"), HasSubstr("fix[1]"), HasSubstr("vertex 0")));
}

TEST(World, ListsTheGroupsThatThereAre) {
  Description scene = small_bar(3, false);
  scene.fixes[0].where.kind = Where::Kind::group;
  scene.fixes[0].where.group = "x_mim";
  EXPECT_THAT(refusal_of(scene),
              AllOf(HasSubstr("x_max"), HasSubstr("did you mean \"x_min\"?"), HasSubstr("x_mim")));
}

TEST(World, RefusesASelectionWithoutVertices) {
  Description scene = small_bar(3, false);
  scene.fixes[0].where.at = 7;
  EXPECT_THAT(refusal_of(scene), HasSubstr("x = 0 to 1"));
}

TEST(World, RefusesABodyForceThatFillsNoCell) {
  Description scene = small_bar(3, false);
  LoadDescription force;
  force.where.kind = Where::Kind::vertices;
  force.where.vertices = {0};
  force.value = {0, 0, 1};
  scene.loads.push_back(force);
  EXPECT_THAT(refusal_of(scene), HasSubstr("1 vertices that fill no cell"));
}

TEST(World, RefusesMotionWithoutMass) {
  Description scene = small_bar(3, true);
  scene.bodies[0].material.density = 0;
  EXPECT_THAT(refusal_of(scene), HasSubstr("density"));
  scene = small_bar(3, false);
  scene.bodies[0].material.density = 0;
  scene.gravity.setZero();
  EXPECT_TRUE(run_all(scene).is_finished());
}

TEST(World, LeavesAVertexOfNoCellWhereItIs) {
  Description scene = small_bar(3, false);
  scene.bodies[0].mesh.vertices.emplace_back(9, 9, 9);
  const Simulation simulation = run_all(scene);
  EXPECT_TRUE(simulation.is_finished());
  EXPECT_EQ(simulation.state().positions.tail(3), Vector3(9, 9, 9));
}

TEST(World, TurnsInvertedCellsAroundAndSaysSo) {
  Description scene = small_bar(3, false);
  std::swap(scene.bodies[0].mesh.block(CellKind::tetrahedron).nodes[0],
            scene.bodies[0].mesh.block(CellKind::tetrahedron).nodes[1]);
  const Simulation simulation = run_all(scene);
  ASSERT_EQ(simulation.world().warnings.size(), 1U);
  EXPECT_THAT(simulation.world().warnings[0], HasSubstr("inverted"));
  const Simulation expected = run_all(small_bar(3, false));
  EXPECT_LT((simulation.state().positions - expected.state().positions).norm(), 1e-9);
}

/// Bodies that do not touch do not feel each other, whatever their laws.
TEST(World, HoldsBodiesOfSeveralLaws) {
  const std::vector<std::string> laws = {"neo_hookean", "linear_elastic", "corotated"};
  Description all = small_bar(3, false);
  std::vector<Vector3> alone;
  for (std::size_t b = 0; b < laws.size(); ++b) {
    Description one = small_bar(3, false);
    one.newton.tolerance = 1e-11;
    one.bodies[0].material.law = laws[b];
    one.bodies[0].name = laws[b];
    one.bodies[0].translate = {0, static_cast<double>(b), 0};
    one.probes[0].at.y() += static_cast<double>(b);
    one.fixes[0].body = one.probes[0].body = laws[b];
    alone.push_back(run_all(one).frame().probes[0].displacement);
    if (b == 0) {
      all = one;
      continue;
    }
    all.bodies.push_back(one.bodies[0]);
    all.fixes.push_back(one.fixes[0]);
    all.probes.push_back(one.probes[0]);
  }
  const Simulation together = run_all(all);
  ASSERT_TRUE(together.is_finished());
  for (std::size_t b = 0; b < laws.size(); ++b)
    EXPECT_LT((together.frame().probes[b].displacement - alone[b]).norm(), 1e-8 * alone[b].norm()) << laws[b];
  EXPECT_GT((alone[0] - alone[1]).norm(), 0.01);
}

/// A bar pulled by a dead traction, one half four times as stiff as the other: the halves stretch like
/// springs in a row.
TEST(CellConstants, MakeOnePartOfABodyStiffer) {
  Description scene = small_bar(3, false);
  scene.gravity.setZero();
  BodyDescription& body = scene.bodies[0];
  body.material.law = "linear_elastic";
  body.material.constants = {{"youngs_modulus", 1e5}, {"poissons_ratio", 0.0}};
  const CellBlock& cells = *body.mesh.find_block(CellKind::tetrahedron);
  std::vector<double>& young = body.material.cell_constants["youngs_modulus"];
  for (Index i = 0; i < cells.num_cells(); ++i) {
    double x = 0;
    for (const Index node : cells.cell(i)) x += body.mesh.vertices[static_cast<std::size_t>(node)].x() / 4;
    young.push_back(x < 0.5 ? 1e5 : 4e5);
  }
  LoadDescription pull;
  pull.kind = "traction";
  pull.where.kind = Where::Kind::plane;
  pull.where.at = 1;
  pull.value = {100, 0, 0};
  scene.loads.push_back(pull);
  const Simulation simulation = run_all(scene);
  EXPECT_NEAR(simulation.frame().probes[0].displacement.x(), 0.5 * 100 / 1e5 + 0.5 * 100 / 4e5, 1e-9);
  EXPECT_NEAR(simulation.world().bodies[0].domains.front().constants[0].second, 0.5 * 2.5e5,
              1e-6);  // the mean shear modulus

  young.pop_back();
  EXPECT_THAT(refusal_of(scene), HasSubstr("a value for each of"));
}

/// The same total whatever the area, and the traction of that force over the area.
TEST(AForce, IsSpreadOverItsArea) {
  for (const int dim : {2, 3}) {
    Description scene = small_bar(dim, false);
    scene.gravity.setZero();
    LoadDescription pull;
    pull.where.kind = Where::Kind::plane;
    pull.where.at = 1;
    pull.kind = "force";
    pull.value = {7, -2, 0};
    scene.loads.push_back(pull);
    const Simulation simulation = run_all(scene);
    const Vector3 reaction = simulation.frame().reactions[0].second;
    EXPECT_LT((reaction + pull.value).norm(), 1e-6 * pull.value.norm()) << dim;  // Newton's tolerance
  }
}

TEST(AForce, HasTheMomentOfItsPointOfAttack) {
  for (const int dim : {2, 3}) {
    Description scene = small_bar(dim, false);
    LoadDescription pull;
    pull.name = "pull";
    pull.where.normal = Vector3(1, 0, 0);
    pull.kind = "force";
    pull.value = {0, -2, 0};
    pull.point = Vector3(1.5, 0, 0);
    LoadDescription twist = pull;
    twist.name = "twist";
    twist.kind = "moment";
    twist.point.reset();
    twist.value = {0, 0, 4};
    twist.pressure = 4;
    scene.loads = {pull, twist};
    const std::vector<Resultant> loads = load_resultants(World(scene));
    ASSERT_GE(loads.size(), 2U);
    EXPECT_GT(loads[0].num_facets, 0);
    EXPECT_NEAR(loads[0].center.x(), 1, 1e-12);
    EXPECT_LT((loads[0].force.value() - pull.value).norm(), 1e-12);
    EXPECT_LT((loads[0].moment - (*pull.point - loads[0].center).cross(pull.value)).norm(), 1e-12);
    EXPECT_LT(loads[1].force.value().norm(), 1e-12);
    EXPECT_LT((loads[1].moment - Vector3(0, 0, 4)).norm(), 1e-12);
  }
}

TEST(AFaceAtAPoint, EndsAtSharpEdges) {
  for (const int dim : {2, 3}) {
    Description scene = small_bar(dim, false);
    LoadDescription push;
    push.name = "push";
    push.kind = "traction";
    push.value = {-1, 0, 0};
    push.where.kind = Where::Kind::face;
    push.where.face_at = {1, 0.1, dim == 3 ? 0.1 : 0};
    LoadDescription by_group = push;
    by_group.name = "by group";
    by_group.where = {};
    by_group.where.kind = Where::Kind::group;
    by_group.where.group = "x_max";
    scene.loads = {push, by_group};
    const std::vector<Resultant> loads = load_resultants(World(scene));
    EXPECT_EQ(loads[0].num_facets, loads[1].num_facets);
    EXPECT_EQ(loads[0].num_nodes, loads[1].num_nodes);
    EXPECT_NEAR(loads[0].area, loads[1].area, 1e-12);
    scene.loads[0].where.angle = 100;  // over every edge of the bar
    EXPECT_GT(load_resultants(World(scene))[0].num_facets, loads[1].num_facets);
    scene.loads[0].where.face_at.x() = 3;
    EXPECT_THAT(refusal_of(scene),
                HasSubstr("face_at: expected a point on the surface of the body, got a point 2"));
  }
}

TEST(ALoadOnOppositeSides, IsTold) {
  Description scene = small_bar(3, false);
  LoadDescription push;
  push.name = "push";
  push.kind = "traction";
  push.value = {0, 0, -1};
  scene.loads = {push};
  EXPECT_THAT(World(scene).warnings, Contains(HasSubstr("load push: where selects opposite sides")));
  scene.loads[0].where.normal = Vector3(0, 0, 1);
  EXPECT_THAT(World(scene).warnings, IsEmpty());
  scene.loads[0].where.normal.reset();
  scene.loads[0].kind = "pressure";
  EXPECT_THAT(World(scene).warnings, IsEmpty());
}

TEST(LoadSteps, AreHalvedUntilTheyConvergeAndTheLoadReachedIsNamed) {
  Description scene = small_bar(3, false);
  // A hydrostatic pull beyond the largest Cauchy stress that the law has, lambda / e: no equilibrium exists.
  scene.bodies[0].material.law = "neo_hookean";
  LoadDescription pull;
  pull.kind = "pressure";
  pull.pressure = -1e6;
  scene.loads.push_back(pull);
  scene.newton.max_iterations = 30;
  Simulation simulation(scene);
  StepReport report;
  int failed_attempts = 0;
  do {
    report = simulation.step();
    failed_attempts += report.failed_attempts;
  } while (report.status == StepReport::Status::converged && !simulation.is_finished());
  EXPECT_EQ(report.status, StepReport::Status::not_converged);
  EXPECT_LT(simulation.state().load, 1);
  EXPECT_GT(failed_attempts, 3);
  EXPECT_THAT(report.reason, HasSubstr("load factor"));
}

TEST(Reactions, BalanceTheWeight) {
  for (const int dimension : {2, 3}) {
    const Simulation simulation = run_all(small_bar(dimension, false));
    const double weight = simulation.world().bodies[0].mass * 9.81;
    const Vector3 reaction = simulation.frame().reactions[0].second;
    EXPECT_NEAR(reaction[dimension - 1], weight, 1e-7 * weight);
    EXPECT_NEAR(reaction[0], 0, 1e-7 * weight);
  }
}

TEST(Interruption, LeavesTheStateBeforeTheStep) {
  Simulation simulation(small_bar(3, true));
  simulation.step();
  const State before = simulation.state();
  const StepReport report = simulation.step([](const NewtonReport&) { return false; });
  EXPECT_EQ(report.status, StepReport::Status::interrupted);
  EXPECT_EQ(simulation.state().step, before.step);
  EXPECT_TRUE((simulation.state().positions.array() == before.positions.array()).all());
}

TEST(Checkpoint, RefusesADamagedImage) {
  Simulation simulation(small_bar(3, true));
  std::string image = serialize(simulation.state());
  EXPECT_THAT(message_of([&] { deserialize_state(image.substr(0, image.size() / 2), "c.bin"); }),
              HasSubstr("c.bin"));
  image[image.size() / 2] = static_cast<char>(image[image.size() / 2] ^ 1);
  EXPECT_THAT(message_of([&] { deserialize_state(image, "c.bin"); }), HasSubstr("damaged"));
  EXPECT_THAT(message_of([] { deserialize_state("hello", "c.bin"); }), HasSubstr("c.bin"));
}

}  // namespace
}  // namespace resilin::testing
