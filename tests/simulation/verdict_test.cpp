// "Converged" means that it is right: for every body, whatever stands beside it, at every scale, or the run
// says that it is not.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "resilin/simulation/contact_patches.hpp"
#include "small_scenes.hpp"
#include "test_names.hpp"

namespace resilin::testing {
namespace {

/// Draws numbers whose logarithm is uniform.
class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double operator()(double low, double high) {
    return std::exp(std::uniform_real_distribution(std::log(low), std::log(high))(random_));
  }

 private:
  std::mt19937 random_;
};

/// A block of 3 x 2 x 2 cells of a size, held at its left side, that its weight bends by `sag` of its length.
BodyDescription hanging_block(const std::string& name, double size, double youngs_modulus, double density) {
  BodyDescription body;
  body.name = name;
  body.place = name;
  body.element = "P1";
  body.mesh = make_box({size, 0.4 * size, 0.4 * size}, {3, 2, 2});
  body.material.constants = {{"youngs_modulus", youngs_modulus}, {"poissons_ratio", 0.3}};
  body.material.density = density;
  return body;
}

void add_held_block(Description& scene, BodyDescription body, double left) {
  FixDescription wall;
  wall.name = body.name + " wall";
  wall.body = body.name;
  wall.where.kind = Where::Kind::plane;
  wall.where.at = left;
  wall.where.tolerance = 1e-6;
  body.translate = {left, 0, 0};
  scene.fixes.push_back(wall);
  scene.bodies.push_back(std::move(body));
}

/// The places of the first body's nodes at the end of a run that converged everywhere.
VectorX end_of_first_body(const Description& scene) {
  Simulation simulation(scene);
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    EXPECT_EQ(report.status, StepReport::Status::converged) << report.reason;
    if (report.status != StepReport::Status::converged) break;
  }
  return simulation.state().positions.head(Eigen::Index{simulation.world().bodies[0].num_nodes} * 3);
}

struct BesideAnotherBody : ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Contrasts, BesideAnotherBody, ::testing::Range(0, 24),
                         ::testing::PrintToStringParamName());

TEST_P(BesideAnotherBody, ABodyEndsWhereItEndsAlone) {
  Draw draw(static_cast<unsigned>(GetParam()));
  Description scene;
  scene.is_dynamic = GetParam() % 3 == 2;
  scene.time_step = 0.01;
  scene.end_time = 0.05;
  scene.gravity = {0, 0, -9.81};
  scene.solver.kind = std::vector<std::string>{"auto", "cholesky", "cg_ic0", "cg_amg"}[GetParam() / 3 % 4];
  const double size = draw(0.005, 0.5), density = draw(500, 2000);
  // A sag of some percent of its length.
  add_held_block(scene, hanging_block("soft", size, 1000 * density * 9.81 * size * draw(0.02, 2), density),
                 0);
  const VectorX alone = end_of_first_body(scene);
  const double other_size = draw(0.05, 5);
  add_held_block(scene, hanging_block("other", other_size, draw(1e8, 1e12), draw(500, 8000)), 2 * size);
  const VectorX beside = end_of_first_body(scene);
  Simulation start(scene);
  const double moved = (alone - start.state().positions.head(alone.size())).cwiseAbs().maxCoeff();
  EXPECT_LT((beside - alone).cwiseAbs().maxCoeff(), 1e-6 * moved)
      << "of " << size << " m beside " << other_size << " m, " << scene.solver.kind;
}

/// On a block that is larger, heavier and stiffer by as much as drawn stands a body, held by contact alone:
/// by friction on a slope, or on the level by springs too weak to bear it. A pull acts on the block in some.
struct OnAHeavyBlock : ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Contrasts, OnAHeavyBlock, ::testing::Range(0, 16),
                         ::testing::PrintToStringParamName());

TEST_P(OnAHeavyBlock, ALightBodyIsHeldByItsWeight) {
  Draw draw(static_cast<unsigned>(GetParam()));
  Description scene;
  const int dim = scene.dimension = 2 + GetParam() % 2, up = dim - 1;
  const bool is_rough = GetParam() % 4 < 2;
  const double size = draw(0.01, 0.1), density = draw(100, 5000), block = size * draw(1.5, 500);
  const double slope = is_rough ? 0.3 : 0;
  scene.gravity = Vector3::Zero();
  scene.gravity[0] = 9.81 * slope;
  scene.gravity[up] = -9.81;
  scene.contact.activation_distance = 5e-3 * size;
  if (is_rough) {
    scene.contact.friction = 0.5;
    scene.contact.friction_speed = 1e-3 * size;
  }
  const auto add = [&](const std::string& name, double side, double place, double youngs_modulus, double rho,
                       const std::string& element) {
    BodyDescription body;
    body.name = name;
    body.place = name;
    body.element = element;
    body.mesh = dim == 3 ? make_box({side, side, side}, {2, 2, 2}) : make_rectangle({side, side}, {2, 2});
    body.material.law = "neo_hookean";
    body.material.constants = {{"youngs_modulus", youngs_modulus}, {"poissons_ratio", 0.3}};
    body.material.density = rho;
    body.translate = Vector3::Zero();
    body.translate.head(dim).setConstant(name == "block" ? 0 : 0.38 * (side < block ? block - side : 0));
    body.translate[up] = place;
    scene.bodies.push_back(std::move(body));
  };
  const double soft = 9.81 * density * size * draw(30, 300);
  add("block", block, 0, std::max(soft, 9.81 * 8000 * block * 100) * draw(1, 1e6), 8000, "P1");
  add("light", size, block + 2e-3 * size, soft, density, "P2");
  FixDescription ground;
  ground.body = "block";
  ground.where.kind = Where::Kind::group;
  ground.where.group = dim == 3 ? "z_min" : "y_min";
  scene.fixes.push_back(ground);
  const double weight = 9.81 * density * std::pow(size, dim);
  if (!is_rough) {
    LoadDescription hold;
    hold.body = "light";
    hold.kind = "spring";
    hold.where.kind = Where::Kind::all;
    hold.stiffness = 1e-5 * weight / size;
    scene.loads.push_back(hold);
  }
  if (is_rough && GetParam() % 8 < 4) {  // it tilts the block
    LoadDescription pull;
    pull.body = "block";
    pull.kind = "traction";
    pull.where.kind = Where::Kind::group;
    pull.where.group = "x_max";
    pull.value[up] = -1000 * 9.81 * block;
    scene.loads.push_back(pull);
  }
  const Simulation simulation = converged_end_of(scene);
  ASSERT_EQ(simulation.frame().contacts.size(), 1U);
  const Vector3 held = simulation.frame().contacts[0].force;
  EXPECT_LT((held + weight / 9.81 * scene.gravity).norm(), 1e-3 * weight) << "a block of " << block / size;
}

/// A light body lies, held by friction alone, on a block that a load at its side moves by far more than
/// contact yields.
struct OnAYieldingBlock : ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Contrasts, OnAYieldingBlock, ::testing::Range(0, 8),
                         ::testing::PrintToStringParamName());

TEST_P(OnAYieldingBlock, ALightBodyKeepsItsHold) {
  Draw draw(static_cast<unsigned>(GetParam()));
  Description scene;
  scene.dimension = 2;
  scene.load_steps = 2;
  const double size = draw(0.001, 0.1), density = draw(100, 5000), block = size * draw(5, 50);
  scene.gravity = {4, -9, 0};
  scene.contact.activation_distance = 5e-3 * size;
  scene.contact.friction = 1;
  const double soft = 9 * density * size * draw(1e3, 1e6), hard = soft * draw(1e2, 1e4);
  for (const bool is_block : {true, false}) {
    BodyDescription body;
    body.name = body.place = is_block ? "block" : "light";
    const double side = is_block ? block : size;
    body.element = is_block ? "P1" : "P2";
    body.mesh = make_rectangle({side, side}, {is_block ? 3 : 2, is_block ? 3 : 2});
    body.material.law = is_block ? "linear_elastic" : "neo_hookean";
    body.material.constants = {{"youngs_modulus", is_block ? hard : soft}, {"poissons_ratio", 0.3}};
    body.material.density = density;
    if (!is_block) body.translate = {0.3 * block, block + 2e-3 * size, 0};
    scene.bodies.push_back(std::move(body));
  }
  FixDescription ground;
  ground.body = "block";
  ground.where.kind = Where::Kind::group;
  ground.where.group = "y_min";
  scene.fixes.push_back(ground);
  LoadDescription pull;
  pull.body = "block";
  pull.kind = "traction";
  pull.where.kind = Where::Kind::group;
  pull.where.group = "x_min";
  pull.value = {0, -0.01 * hard, 0};
  scene.loads.push_back(pull);
  const Simulation simulation = converged_end_of(scene);
  ASSERT_EQ(simulation.frame().contacts.size(), 1U);
  const double mass = density * size * size;
  EXPECT_LT((simulation.frame().contacts[0].force + mass * scene.gravity).norm(), 1e-3 * mass * 9.8);
}

/// A plate on two feet, of which one is pressed to the ground by a load, the other by little more than its
/// weight: what is stiff between them is a soft bridge.
Description plate_on_two_feet(double load) {
  Description scene;
  scene.dimension = 2;
  scene.gravity = {0, -10, 0};
  scene.contact.activation_distance = 1e-3;
  BodyDescription body;
  body.name = body.place = "plate";
  body.element = "P1";
  body.mesh = make_rectangle({1.2, 0.2}, {12, 2});
  for (Vector3& X : body.mesh.vertices) {
    if (X.y() < 0.05 && X.x() > 0.45 && X.x() < 0.75) X.y() = 0.05;
    X.y() += 4e-4;
  }
  body.material.law = "neo_hookean";
  body.material.constants = {{"youngs_modulus", 2e3}, {"poissons_ratio", 0.3}};
  body.material.density = 1;
  RegionDescription foot;
  foot.place = "foot";
  foot.name = "foot";
  foot.where.kind = Where::Kind::box;
  foot.where.min = {-1, -1, -1};
  foot.where.max = {0.401, 1, 1};
  foot.material = body.material;
  foot.material.constants["youngs_modulus"] = 1e3 * load;
  body.regions.push_back(foot);
  scene.bodies.push_back(std::move(body));
  ColliderDescription ground;
  ground.kind = "half_space";
  ground.shape.normal = {0, 1, 0};
  ground.activation_distance = 1e-3;
  scene.colliders.push_back(ground);
  LoadDescription press;
  press.kind = "traction";
  press.where.kind = Where::Kind::box;
  press.where.min = {-0.01, 0.19, -1};
  press.where.max = {0.401, 0.21, 1};
  press.value = {0, -load, 0};
  scene.loads.push_back(press);
  LoadDescription hold;
  hold.kind = "spring";
  hold.where.kind = Where::Kind::all;
  hold.stiffness = 1e-3;
  scene.loads.push_back(hold);
  return scene;
}

double patch_tolerance(const Simulation& simulation, const VectorX& x, double residual) {
  const World& world = simulation.world();
  Potential potential = Potential::at(world, world.at_load(1), x);
  return tolerance_of_patches(world, potential, ConnectedComponents(*world.pattern), x, 1e-8, residual, {});
}

TEST(ContactPatches, ALightOneEndsInBalanceBesideAHeavyOne) {
  for (const double load : {1e3, 1e5, 1e6}) {
    const Simulation simulation = converged_end_of(plate_on_two_feet(load));
    EXPECT_EQ(patch_tolerance(simulation, simulation.state().positions, 1e-8), 1e-8) << load;
  }
}

TEST(ContactPatches, ALightOneOutOfBalanceAsksForWhatItsOwnForceIsWorth) {
  const double load = 1e6;
  const Simulation simulation = converged_end_of(plate_on_two_feet(load));
  VectorX x = simulation.state().positions;
  const World& world = simulation.world();
  for (Index node = 0; node < world.num_nodes(); ++node)
    if (world.rest_positions[2 * node] > 1.15 && world.rest_positions[2 * node + 1] > 0.15)
      x[2 * node] += 1e-6;  // strained by some thousandths of its weight
  const double asked = patch_tolerance(simulation, x, 1e-8);
  // It weighs about one newton, and the load is 0.4e6 N.
  EXPECT_LT(asked, 1e-8);
  EXPECT_GT(asked, 1e-3 / load * 0.1);
  EXPECT_EQ(patch_tolerance(simulation, x, 1e-12), 1e-8) << "the residual is known to be small enough";
}

/// The same problem in other units of length, stress and time.
Description scaled_block(double length, double stress, double time, bool is_dynamic) {
  const double density = stress * time * time / (length * length);
  Description scene;
  scene.is_dynamic = is_dynamic;
  scene.time_step = 0.25 * time;
  scene.end_time = 2 * time;
  scene.gravity = {0, 0, -0.01 * length / (time * time)};
  BodyDescription body = hanging_block("block", length, stress, density);
  FixDescription wall;
  wall.where.kind = Where::Kind::plane;
  scene.fixes.push_back(wall);
  LoadDescription pull;
  pull.kind = "traction";
  pull.value = {0.02 * stress, 0, 0.01 * stress};
  pull.where.kind = Where::Kind::plane;
  pull.where.at = length;
  pull.time_function.form = TimeFunction::Ramp{.from = 0.25 * time, .until = time};
  if (is_dynamic) scene.loads.push_back(pull);
  scene.bodies.push_back(std::move(body));
  return scene;
}

struct InAnyUnits : ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Scales, InAnyUnits, ::testing::Range(0, 24), ::testing::PrintToStringParamName());

TEST_P(InAnyUnits, AProblemHasTheSameAnswer) {
  Draw draw(static_cast<unsigned>(GetParam()));
  const bool is_dynamic = GetParam() % 2 == 1;
  const double length = draw(1e-6, 1e6), stress = draw(1e-3, 1e13), time = draw(1e-12, 1e6);
  const VectorX expected = end_of_first_body(scaled_block(1, 1, 1, is_dynamic));
  const VectorX found = end_of_first_body(scaled_block(length, stress, time, is_dynamic)) / length;
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-9)
      << length << " m, " << stress << " Pa, " << time << " s";
}

/// The sag of a small bar after one step; says in `reason` why there is none.
double sag_of(const Description& scene, std::string& reason) {
  try {
    Simulation simulation(scene);
    const StepReport report = simulation.step();
    if (report.status != StepReport::Status::converged) reason = report.reason + " ";
    return simulation.frame().probes[0].displacement.z();
  } catch (const InputError& error) {
    reason = error.what();
    return 0;
  }
}

/// The bar's scene with all that has a place moved, but for the bar.
Description bar_scene_at(double distance) {
  Description scene = small_bar(3, false);
  scene.fixes[0].where.at = distance;
  scene.fixes[0].where.tolerance = 0.01;
  scene.probes[0].at.x() += distance;
  return scene;
}

struct FarFromTheOrigin : ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Distances, FarFromTheOrigin,
                         ::testing::Values(1e3, -1e5, 1e7, 1e8, -1e9, 1e10, 1e12, 1e14),
                         numbered_name<double>);

TEST_P(FarFromTheOrigin, ATranslationCostsNoDigits) {
  std::string reason;
  const double expected = sag_of(bar_scene_at(0), reason);
  Description scene = bar_scene_at(GetParam());
  scene.bodies[0].translate = {GetParam(), 0, 0};
  EXPECT_NEAR(sag_of(scene, reason), expected, 1e-12 * std::abs(expected)) << "at " << GetParam() << " m";
  EXPECT_EQ(reason, "");
}

TEST_P(FarFromTheOrigin, AMeshSagsAsItDoesThereOrTheRunSaysThatItCannotTell) {
  std::string reason;
  const double expected = sag_of(bar_scene_at(0), reason);
  ASSERT_EQ(reason, "");
  Description scene = bar_scene_at(GetParam());
  for (Vector3& X : scene.bodies[0].mesh.vertices) X.x() += GetParam();
  const double found = sag_of(scene, reason);
  if (!reason.empty()) return;
  EXPECT_NEAR(found, expected, 1e-4 * std::abs(expected)) << "at " << GetParam() << " m";
}

/// 1 mm that hardly yields under its weight.
TEST(StiffAgainstItsWeight, ACubeSagsByTheClosedFormOrTheRunSaysThatItCannotTell) {
  Description scene;
  scene.is_dynamic = true;
  scene.time_step = 1;
  scene.end_time = 3;
  scene.gravity = {0, 0, -9.81};
  BodyDescription body = hanging_block("cube", 1e-3, 1e12, 1000);
  body.material.constants["poissons_ratio"] = 0.4999;
  scene.bodies.push_back(body);
  Simulation simulation(scene);
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    if (report.status != StepReport::Status::converged) return;
    // Backward Euler falls by g dt^2 n (n + 1) / 2.
    const int n = simulation.state().step;
    EXPECT_NEAR(simulation.state().positions[2], -9.81 * n * (n + 1) / 2, 1e-6) << "after " << n << " steps";
  }
}

/// Fibres whose energy grows like exp(x^2): forces overflow before energies do.
struct FibreStrip : ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Tractions, FibreStrip, ::testing::Values(1e2, 1e3, 1e4, 1e5, 1e6),
                         numbered_name<double>);

TEST_P(FibreStrip, EndsInNumbersOrSaysWhereItFails) {
  Description scene;
  BodyDescription body;
  body.mesh = make_box({0.01, 0.002, 0.001}, {10, 2, 1});
  body.material.law = "holzapfel_gasser_ogden";
  body.material.constants = {{"shear_modulus", 2e4},
                             {"bulk_modulus", 1e6},
                             {"fibre_modulus", 5e4},
                             {"fibre_stiffening", 5.0},
                             {"dispersion", 0.0}};
  body.material.fibres = {{Vector3(1, 0, 0)}};
  scene.bodies.push_back(std::move(body));
  FixDescription wall;
  wall.where.kind = Where::Kind::plane;
  scene.fixes.push_back(wall);
  LoadDescription load;
  load.kind = "traction";
  load.value = {0, 0, GetParam()};
  load.where.kind = Where::Kind::plane;
  load.where.at = 0.01;
  scene.loads.push_back(load);
  Simulation simulation(scene);
  for (int step = 0; step < 20 && !simulation.is_finished(); ++step) {
    const StepReport report = simulation.step();
    EXPECT_TRUE(simulation.state().positions.allFinite());
    if (report.status != StepReport::Status::converged) {
      EXPECT_NE(report.reason, "");
      EXPECT_EQ(report.reason.find("nan"), std::string::npos) << report.reason;
      EXPECT_EQ(report.reason.find("inf N"), std::string::npos) << report.reason;
      return;
    }
    EXPECT_LE(report.newton.relative_residual(), 1e-8);
    const Vector3 pull = simulation.state().load * GetParam() * 0.002 * 0.001 * Vector3::UnitZ();
    EXPECT_LT((simulation.frame().reactions[0].second + pull).norm(), 1e-6 * pull.norm());
  }
}

/// Bodies that slide on a floor go a long way across their forces, on which next to no work is done.
struct SlidingBody : ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Seeds, SlidingBody, ::testing::Range(0, 12));

TEST_P(SlidingBody, IsInBalanceStepByStep) {
  std::mt19937 generator(static_cast<unsigned>(GetParam()));
  std::uniform_real_distribution<double> unit(-1, 1);
  Description scene = small_bar(2 + GetParam() % 2, true);
  const int up = scene.dimension - 1;
  scene.fixes.clear();
  scene.probes.clear();
  scene.integrator = GetParam() % 3 == 0 ? "tr_bdf2" : "backward_euler";
  BodyDescription& body = scene.bodies[0];
  body.element = GetParam() % 4 < 2 ? "P1" : "P2";
  body.material.constants = {{"youngs_modulus", std::pow(10, 5 + unit(generator))}, {"poissons_ratio", 0.3}};
  body.velocity = 2 * unit(generator) * Vector3::UnitX();
  ColliderDescription floor;
  floor.kind = "half_space";
  floor.shape.point = -0.01 * Vector3::Unit(up);
  floor.shape.normal = Vector3::Unit(up);
  scene.colliders.push_back(floor);
  scene.time_step = std::pow(10, 0.5 * unit(generator));
  scene.end_time = 40 * scene.time_step;
  Simulation simulation(scene);
  while (!simulation.is_finished()) {
    const StepReport report = simulation.step();
    ASSERT_EQ(report.status, StepReport::Status::converged) << report.reason;
  }
}

}  // namespace
}  // namespace resilin::testing
