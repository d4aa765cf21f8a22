// Energies, stresses and section forces: their values against what reports and fields have, their
// derivatives against differences of whole runs, for all entries of the catalogues.

#include <map>

#include "every_element.hpp"
#include "every_integrator.hpp"
#include "resilin/core/error.hpp"
#include "resilin/sensitivity/measured_number.hpp"
#include "resilin/sensitivity/stress_at_place.hpp"
#include "short_bar.hpp"
#include "test_names.hpp"

namespace resilin::testing {
namespace {

constexpr double middle = 0.25;  // middle of the bar, where cells meet [m]

Description cut_bar(int dimension, bool is_dynamic, const std::string& element) {
  Description scene = short_bar(dimension, is_dynamic, element);
  SectionDescription cut;
  cut.name = "cut";
  cut.axis = 0;
  cut.at = middle;
  scene.sections.push_back(cut);
  if (is_dynamic) {
    scene.end_time = 0.03;
    scene.bodies[0].velocity = {0.3, 0.5, 0};
  }
  return scene;
}

/// A place in the second cell of the body, at these reference coordinates.
Vector3 place_in_cell(const World& world, const Vector3& xi) {
  const Body& body = world.bodies[0];
  const ElementInfo& element = body.domains.front().energy->element();
  const auto n = static_cast<std::size_t>(element.num_nodes);
  std::vector<double> shape(n);
  element.shape_values(xi, shape);
  Vector3 at = Vector3::Zero();
  for (std::size_t a = 0; a < n; ++a)
    at += shape[a] * world.place_of(body.cells[n + a], world.rest_positions);
  return at;
}

/// Not at a quadrature point.
Vector3 inner_place(const World& world) {
  return place_in_cell(world, {0.3, 0.2, world.dimension == 3 ? 0.15 : 0.0});
}

/// Some of each kind, at the last frame and at one before, by their names.
std::map<std::string, MeasuredNumber> measure(Derivatives& run, const Vector3& at) {
  std::map<std::string, MeasuredNumber> all;
  const World& world = run.world();
  const Body& body = world.bodies[0];
  const int last = run.num_frames() - 1;
  all["elastic energy"] = energy_at(run, "elastic", nullptr, last);
  all["elastic energy of the body"] = energy_at(run, "elastic", &body, last);
  if (world.is_dynamic) {
    all["kinetic energy"] = energy_at(run, "kinetic", nullptr, last);
    all["kinetic energy at the start"] = energy_at(run, "kinetic", &body, 0);
  }
  for (const std::string component : {"von_mises", "xx", "zz", "xy"})
    all["stress " + component] = stresses_at(run, body, {at}, component, last)[0];
  const std::vector<MeasuredNumber> force = section_force_at(run, "cut", last);
  for (std::size_t k = 0; k < force.size(); ++k) all["section force " + std::to_string(k)] = force[k];
  return all;
}

int frame_of(const std::string& name, const Derivatives& run) {
  return name.ends_with("start") ? 0 : run.num_frames() - 1;
}

std::vector<FrameChange> slopes_of(const std::string& name, const MeasuredNumber& measured,
                                   const Derivatives& run) {
  std::vector<FrameChange> slopes(static_cast<std::size_t>(run.num_frames()));
  FrameChange& of = slopes[static_cast<std::size_t>(frame_of(name, run))];
  of.positions = measured.by_positions;
  of.velocities = measured.by_velocities;
  return slopes;
}

/// Both products by every parameter against each other and against differences of runs.
void expect_right_numbers(const Description& scene, const std::vector<std::string>& wrt = {}) {
  const auto made = std::make_shared<const Description>(scene);
  const std::vector<std::string> names = wrt.empty() ? parameter_names(World(made)) : wrt;
  const auto run = Derivatives::run(scene, names);
  const Vector3 at = inner_place(run->world());
  const std::map<std::string, MeasuredNumber> base = measure(*run, at);
  std::map<std::string, std::vector<VectorX>> gradients;
  for (const auto& [name, measured] : base) {
    gradients[name] = run->transposed(slopes_of(name, measured, *run));
    for (std::size_t i = 0; i < names.size(); ++i) gradients[name][i] += measured.by_parameters[i];
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    SCOPED_TRACE(names[i]);
    const Parameter& parameter = run->parameters()[i];
    const std::vector<VectorX> changes = change_of_one(*run, i);
    const std::vector<FrameChange> frames = run->forward(changes);
    constexpr double step = 2e-4;
    std::map<double, std::map<std::string, MeasuredNumber>> beside;
    for (const double t : {-2 * step, -step, step, 2 * step}) {
      Description changed = scene;
      parameter.set(parameter.value + t * changes[i], changed);
      const auto other = Derivatives::run(changed, {});
      // The place moves with the body where the rest shape does.
      beside[t] = measure(*other, names[i].ends_with("rest_positions") ? inner_place(other->world()) : at);
    }
    for (const auto& [name, measured] : base) {
      SCOPED_TRACE(name);
      const double slope = gradients[name][i].dot(changes[i]);
      const FrameChange& frame = frames[static_cast<std::size_t>(frame_of(name, *run))];
      const double forward = measured.change(frame, changes);
      const auto value = [&, n = name](double t) { return beside.at(t).at(n).value; };
      const double quotient =
          (8 * (value(step) - value(-step)) - (value(2 * step) - value(-2 * step))) / (12 * step);
      double parts = std::abs(slope) + measured.by_parameters[i].norm() * changes[i].norm();
      if (measured.by_positions.size() > 0) parts += measured.by_positions.norm() * frame.positions.norm();
      if (measured.by_velocities.size() > 0) parts += measured.by_velocities.norm() * frame.velocities.norm();
      EXPECT_NEAR(forward, slope, 1e-11 * parts);
      // Values are right to some 1e-13 of what they are summed of, which the step magnifies.
      EXPECT_NEAR(slope, quotient, 1e-6 * (parts + std::abs(measured.value)));
    }
  }
}

using EveryElementsNumbers = OnEveryElement;

TEST_P(EveryElementsNumbers, HaveRightDerivativesAtRest) {
  Description scene = cut_bar(element.dim, false, std::string(element.name));
  scene.fixes[0].displacement = {-0.01, 0.01, 0};
  expect_right_numbers(scene);
}

TEST_P(EveryElementsNumbers, HaveRightDerivativesInMotion) {
  for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
    Description scene = cut_bar(element.dim, true, std::string(element.name));
    scene.bodies[0].mass = mass;
    expect_right_numbers(scene, {"body.body.material.youngs_modulus", "body.body.density",
                                 "body.body.rest_positions", "body.body.initial_velocities"});
  }
}

/// At a quadrature point the stress is that of the fields; energies and forces are those of the report.
TEST_P(EveryElementsNumbers, AreThoseOfTheReport) {
  for (const bool is_dynamic : {false, true}) {
    const Description scene = cut_bar(element.dim, is_dynamic, std::string(element.name));
    const auto run = Derivatives::run(scene, {});
    const int last = run->num_frames() - 1;
    const Frame& frame = run->frame(last);
    const World& world = run->world();
    const VectorX x = run->positions(last);
    EXPECT_NEAR(energy_at(*run, "elastic", nullptr, last).value, frame.elastic_energy,
                1e-12 * frame.elastic_energy);
    if (is_dynamic) {
      EXPECT_NEAR(energy_at(*run, "kinetic", nullptr, last).value, frame.kinetic_energy,
                  1e-12 * frame.kinetic_energy);
    }
    const std::vector<MeasuredNumber> force = section_force_at(*run, "cut", last);
    for (int k = 0; k < element.dim; ++k)
      EXPECT_NEAR(force[static_cast<std::size_t>(k)].value, frame.sections[0].force[k],
                  1e-12 * frame.sections[0].force.norm());

    const Body& body = world.bodies[0];
    const std::vector<Matrix<3>> stresses = body.domains.front().energy->cauchy_stresses(x);
    const Vector3 at = place_in_cell(world, body.domains.front().energy->quadrature().points.back().xi);
    const Matrix<3>& expected =
        stresses[2 * static_cast<std::size_t>(body.domains.front().energy->num_points()) -
                 1];  // stress of the second cell
    EXPECT_LT((StressAtPlace(world, body, at, "place").stress(x) - expected).norm(), 1e-9 * expected.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryElementsNumbers, ::testing::ValuesIn(elements()), name_of_element);

using EveryIntegratorsNumbers = WithEveryIntegrator;

TEST_P(EveryIntegratorsNumbers, HaveRightDerivatives) {
  Description scene = cut_bar(3, true, "P1");
  scene.integrator = integrator;
  scene.bodies[0].damping = {.mass = 2, .stiffness = 0.005, .shear_viscosity = 3, .bulk_viscosity = 5};
  expect_right_numbers(scene);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryIntegratorsNumbers, ::testing::ValuesIn(integrator_names()),
                         name_of_integrator);

/// With fibres where a law has them, by the constants of its formula, uniform and by cell.
TEST(EveryLawsNumbers, HaveRightDerivatives) {
  for (const LawInfo* law : laws())
    for (const int dimension : {2, 3}) {
      SCOPED_TRACE(std::string(law->name) + " in " + std::to_string(dimension) + "D");
      Description scene = cut_bar(dimension, false, law->has_volume_energy ? "P2P0" : "P1");
      MaterialDescription& material = scene.bodies[0].material;
      material = material_of(*law);
      for (const ConstantText& constant : law->constants)  // inside of its range
        if (constant.is_free && constant.fallback == 0) material.constants[std::string(constant.name)] = 0.1;
      std::vector<double> constants = resolve_constants(*law, material.constants, "material");
      for (std::size_t k = 0; k < constants.size(); ++k)  // moduli that change forces by more than rounding
        if (constants[k] == 0 && !law->constants[k].unit.empty()) constants[k] = 0.01 * constants[0];
      material.constants.clear();
      std::vector<std::string> names = {"body.body.rest_positions"};
      const std::size_t num_cells =
          scene.bodies[0].mesh.find_solid(dimension)->nodes.size() / static_cast<std::size_t>(dimension + 1);
      for (std::size_t k = 0; k < constants.size(); ++k) {
        const std::string name(law->constants[k].name);
        names.push_back("body.body.material." + name);
        if (k % 2 == 0) {
          material.constants[name] = constants[k];
          continue;
        }
        const VectorX noise = random_numbers(static_cast<Eigen::Index>(num_cells), static_cast<unsigned>(k));
        for (const double number : noise)
          material.cell_constants[name].push_back(constants[k] * (1 + 0.05 * number));
      }
      expect_right_numbers(scene, names);
    }
}

TEST(EnergyOfABody, IsItsOwn) {
  Description scene = cut_bar(3, true, "P1");
  BodyDescription other = scene.bodies[0];
  other.name = "other";
  other.translate = {0, 0, 1};
  other.material.density = 300;
  scene.bodies.push_back(other);
  scene.fixes[0].body = scene.sections[0].body = scene.bodies[0].name;
  scene.contact.is_enabled = false;
  const auto run = Derivatives::run(scene, {"body.other.density", "body.body.density"});
  const int last = run->num_frames() - 1;
  for (const std::string kind : {"elastic", "kinetic"}) {
    const MeasuredNumber first = energy_at(*run, kind, run->world().bodies.data(), last),
                         second = energy_at(*run, kind, &run->world().bodies[1], last),
                         both = energy_at(*run, kind, nullptr, last);
    EXPECT_GT(first.value, 0);
    EXPECT_NEAR(first.value + second.value, both.value, 1e-13 * both.value);
    EXPECT_EQ(first.by_parameters[0][0], 0);
    if (kind == "kinetic") {
      EXPECT_NEAR(second.by_parameters[0][0], second.value / 300, 1e-12 * second.value / 300);
    }
  }
}

TEST(MeasuredNumbers, AreRefusedInWords) {
  const auto text_of = [](const auto& measure) {
    try {
      measure();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  const auto run = Derivatives::run(cut_bar(3, false, "P1"), {});
  const Body& body = run->world().bodies[0];
  EXPECT_NE(text_of([&] { energy_at(*run, "kinetic", nullptr, 1); }).find("a dynamic scene"),
            std::string::npos);
  EXPECT_NE(text_of([&] { energy_at(*run, "elastik", nullptr, 1); }).find("elastic"), std::string::npos);
  EXPECT_NE(text_of([&] { section_force_at(*run, "cat", 1); }).find("cut"), std::string::npos);
  EXPECT_NE(text_of([&] { stresses_at(*run, body, {{9, 0, 0}}, "xx", 1); }).find("outside"),
            std::string::npos);
  EXPECT_NE(text_of([&] { stresses_at(*run, body, {{0.1, 0.1, 0.1}}, "x", 1); }).find("von_mises"),
            std::string::npos);
  EXPECT_NE(text_of([&] { stresses_at(*run, body, {{0.1, 0.1, 0.1}}, "von_mises", 0); }).find("kink"),
            std::string::npos);
}

}  // namespace
}  // namespace resilin::testing
