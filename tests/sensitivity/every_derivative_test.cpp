// Derivatives of runs by every parameter of their scenes, for all entries of the catalogues: each law,
// element, integrator and kind of load is here without a line.

#include "derivative_checks.hpp"
#include "every_element.hpp"
#include "every_integrator.hpp"
#include "resilin/world/load_catalog.hpp"
#include "short_bar.hpp"
#include "test_names.hpp"

namespace resilin::testing {
namespace {

/// A load of each kind on the far side.
void add_loads(Description& scene) {
  for (const LoadKind& kind : load_kinds()) {
    LoadDescription load;
    load.kind = load.name = kind.name;
    load.value = {30, -20, scene.dimension == 3 ? 10.0 : 0.0};
    load.pressure = 400;
    load.stiffness = 70;
    load.displacement = {0.02, 0.03, 0};
    load.velocity = {0, 0.3, 0};
    if (kind.name != "body_force") {
      load.where.kind = Where::Kind::box;
      load.where.min = {0.4, -1, -1};
      load.where.max = {1, 1, 1};
    }
    scene.loads.push_back(load);
  }
}

using EveryElementsDerivatives = OnEveryElement;

TEST_P(EveryElementsDerivatives, AreRightAtRest) {
  Description scene = short_bar(element.dim, false, std::string(element.name));
  add_loads(scene);
  scene.fixes[0].displacement = {-0.01, 0.01, 0};
  scene.fixes[0].gradient(0, 1) = 0.05;
  expect_right_derivatives(scene);
}

TEST_P(EveryElementsDerivatives, AreRightInMotion) {
  Description scene = short_bar(element.dim, true, std::string(element.name));
  scene.integrator = "newmark";
  scene.bodies[0].mass = MassKind::lumped;
  scene.bodies[0].damping = {.mass = 2, .stiffness = 0.005, .shear_viscosity = 3, .bulk_viscosity = 5};
  scene.end_time = 0.03;
  expect_right_derivatives(scene);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryElementsDerivatives, ::testing::ValuesIn(elements()),
                         name_of_element);

using EveryIntegratorsDerivatives = WithEveryIntegrator;

/// With loads that begin and end, a moving support, damping and a consistent mass.
TEST_P(EveryIntegratorsDerivatives, AreRight) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(dimension);
    Description scene = short_bar(dimension, true);
    scene.integrator = integrator;
    scene.end_time = 0.06;
    BodyDescription& body = scene.bodies[0];
    body.mass = MassKind::consistent;
    body.velocity = {0.3, 0.5, 0};
    body.velocity_gradient(0, 1) = 0.4;
    body.damping = {.mass = 2, .stiffness = 0.005, .shear_viscosity = 3, .bulk_viscosity = 5};
    add_loads(scene);
    scene.loads[0].from = 0.02;
    scene.loads[1].until = 0.04;
    scene.fixes[0].velocity = {0.2, 0.1, 0};
    scene.fixes[0].displacement = {0.01, 0.02, 0};
    scene.fixes[0].time_function.form =
        TimeFunction::Sine{.frequency = 3, .amplitude = 1, .phase = 0, .offset = 0};
    expect_right_derivatives(scene);
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryIntegratorsDerivatives, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

/// By Young's modulus and Poisson's ratio, by the constants of the formula, and by fields of both kinds.
TEST(EveryLawsDerivatives, AreRight) {
  for (const LawInfo* law : laws())
    for (const int dimension : {2, 3}) {
      SCOPED_TRACE(std::string(law->name) + " in " + std::to_string(dimension) + "D");
      Description scene = short_bar(dimension, false, law->has_volume_energy ? "P2P0" : "P1");
      MaterialDescription& material = scene.bodies[0].material;
      material = material_of(*law);
      for (const ConstantText& constant : law->constants)  // inside of its range
        if (constant.is_free && constant.fallback == 0) material.constants[std::string(constant.name)] = 0.1;
      if (std::isnan(law->only_poissons_ratio)) {
        expect_right_derivatives(scene);
      } else {
        expect_right_derivatives(scene, {"body.body.material.youngs_modulus"});
      }
      const std::size_t num_cells =
          scene.bodies[0].mesh.find_solid(dimension)->nodes.size() / static_cast<std::size_t>(dimension + 1);
      const std::vector<double> constants = resolve_constants(*law, material.constants, "material");
      material.constants.clear();
      for (std::size_t k = 0; k < constants.size(); ++k) {
        const VectorX noise = random_numbers(static_cast<Eigen::Index>(num_cells), static_cast<unsigned>(k));
        std::vector<double>& values = material.cell_constants[std::string(law->constants[k].name)];
        for (const double number : noise) values.push_back(constants[k] * (1 + 0.05 * number));
      }
      std::vector<std::string> names;
      for (const ConstantText& constant : law->constants)
        names.push_back("body.body.material." + std::string(constant.name));
      expect_right_derivatives(scene, names);
    }
}

TEST(StaticDerivatives, DoNotDependOnTheLoadSteps) {
  Description scene = short_bar(3, false);
  const std::vector<std::string> wrt = {"body.body.material.youngs_modulus", "body.body.rest_positions"};
  std::vector<std::vector<VectorX>> gradients;
  for (const int steps : {1, 7}) {
    scene.load_steps = steps;
    const auto run = Derivatives::run(scene, wrt);
    std::vector<FrameChange> slopes(static_cast<std::size_t>(run->num_frames()));
    slopes.back().positions = random_numbers(run->world().rest_positions.size(), 1);
    gradients.push_back(run->transposed(slopes));
  }
  for (std::size_t i = 0; i < wrt.size(); ++i)
    EXPECT_LT((gradients[0][i] - gradients[1][i]).norm(), 1e-9 * gradients[0][i].norm()) << wrt[i];
}

TEST(StaticDerivatives, OfAMeshWithMiddlesOfEdgesAreTakenByItsVertices) {
  expect_right_derivatives(short_bar(3, false, "P2"), {"body.body.rest_positions"});
}

/// Facets of a mesh on which no cell stands get middles of edges, too, which move along.
TEST(StaticDerivatives, OfAMeshWithFacetsOfNoCellAreRight) {
  Description scene = short_bar(2, false, "P2");
  std::vector<Index>& nodes = scene.bodies[0].mesh.block(CellKind::triangle).nodes;
  nodes.resize(nodes.size() - 3);
  expect_right_derivatives(scene, {"body.body.rest_positions"});
}

/// Nodes that stood on a plane are held although they have moved off it.
TEST(StaticDerivatives, ByRestPositionsKeepWhatWasSelectedByPlace) {
  for (const std::string element : {"P1", "P2"}) {
    Description scene = short_bar(3, false, element);
    scene.fixes[0].where.kind = Where::Kind::plane;
    LoadDescription pull;
    pull.name = "pull";
    pull.kind = "traction";
    pull.where.kind = Where::Kind::box;
    pull.where.min = {0.4, -1, -1};
    pull.where.max = {1, 1, 1};
    pull.value = {500, 0, 100};
    scene.loads.push_back(pull);
    expect_right_derivatives(scene, {"body.body.rest_positions", "load.pull.value"});
    scene.loads[0].kind = "force";
    expect_right_derivatives(scene, {"body.body.rest_positions", "load.pull.value"});
    scene.loads[0].point = Vector3(0.7, 0.1, 0.3);
    expect_right_derivatives(scene, {"body.body.rest_positions", "load.pull.value"});
    scene.loads[0].point.reset();
    scene.loads[0].where = {};
    scene.loads[0].where.normal = Vector3(1, 0, 0);
    expect_right_derivatives(scene, {"body.body.rest_positions", "load.pull.value"});
  }
}

TEST(StaticDerivatives, OfATurnedSupportAreRight) {
  Description scene = short_bar(3, false);
  FixDescription turn;
  turn.name = "turn";
  turn.where.kind = Where::Kind::box;
  turn.where.min = {0.4, -1, -1};
  turn.where.max = {1, 1, 1};
  turn.rotate = Rotation{.axis = {1, 0.2, 0}, .center = {0, 0.1, 0.1}, .degrees = 40};
  scene.fixes.push_back(turn);
  expect_right_derivatives(scene);
}

TEST(StaticDerivatives, OfASceneFarFromTheOriginAreRight) {
  Description scene = short_bar(3, false);
  scene.bodies[0].scale = 2;
  scene.bodies[0].rotate = Rotation{.axis = {0, 0, 1}, .center = {0, 0, 0}, .degrees = 90};
  scene.bodies[0].translate = {0, 1e7, 0};
  expect_right_derivatives(scene, {"body.body.rest_positions", "fix.wall.displacement", "simulation.gravity"},
                           1e-5);
}

/// The barrier's Hessian is the true one, so that contact without friction costs nothing more.
TEST(ContactDerivatives, OfABodyOnAColliderAreRight) {
  for (const bool is_dynamic : {false, true}) {
    SCOPED_TRACE(is_dynamic);
    Description scene = short_bar(3, is_dynamic);
    scene.bodies[0].velocity = {0, 0, -0.5};
    ColliderDescription floor;
    floor.name = "floor";
    floor.kind = "half_space";
    floor.shape.point = {0, 0, -0.05};
    floor.shape.normal = {0, 0, 1};
    floor.activation_distance = 0.02;
    floor.stiffness = 2e4;
    scene.colliders.push_back(floor);
    scene.bodies[0].material.constants["youngs_modulus"] = 1e4;
    expect_right_derivatives(
        scene, {"body.body.material.youngs_modulus", "body.body.density", "simulation.gravity"});
  }
}

TEST(ContactDerivatives, OfTwoBodiesAreRight) {
  Description scene = short_bar(3, false);
  BodyDescription upper = scene.bodies[0];
  upper.name = "upper";
  upper.translate = {0.02, 0, 0.3};
  scene.bodies[0].name = "lower";
  scene.bodies.push_back(upper);
  scene.fixes[0].body = "lower";
  FixDescription other = scene.fixes[0];
  other.body = "upper";
  other.name = "other";
  other.where.kind = Where::Kind::box;
  other.where.min = {-1, -1, 0};
  other.where.max = {0.03, 1, 1};
  other.displacement = {0, 0, -0.04};
  scene.fixes.push_back(other);
  scene.contact.activation_distance = 0.01;
  scene.contact.stiffness = 1e4;
  expect_right_derivatives(scene, {"body.lower.material.youngs_modulus", "body.upper.material.poissons_ratio",
                                   "fix.other.displacement"});
}

}  // namespace
}  // namespace resilin::testing
