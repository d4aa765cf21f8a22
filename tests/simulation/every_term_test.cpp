// Properties that every term of a world must have: each kind of load, each collider's shape, strain energies
// of every element, gravity, inertia and damping, all energies of joints, springs and cables. They walk the
// catalogues, so that a new entry is here.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include "resilin/core/parallel.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/integrator/integrator.hpp"
#include "resilin/simulation/potential.hpp"
#include "resilin/world/load_catalog.hpp"
#include "small_scenes.hpp"
#include "test_names.hpp"

namespace resilin::testing {
namespace {

constexpr double step_length = 0.01;  // [s]

void add_arm(Description& scene);

/// A bar in motion with a load of every kind on its end, all colliders near its underside, another bar above
/// it, and damping.
Description crowded_scene(int dimension, const std::string& element) {
  Description scene = small_bar(dimension, true);
  BodyDescription& body = scene.bodies[0];
  const ElementInfo& info = require_element(element, dimension, "test");
  body.element = element;
  if (!is_simplex(info.shape)) {
    body.mesh = dimension == 3 ? make_hexahedron_box({1, 0.25, 0.25}, {4, 1, 1})
                               : make_quadrilateral_rectangle({1, 0.25}, {4, 1});
  } else {
    body.mesh = dimension == 3 ? make_box({1, 0.25, 0.25}, {4, 1, 1}) : make_rectangle({1, 0.25}, {4, 1});
  }
  body.mass = MassKind::consistent;
  body.damping = {.mass = 2, .stiffness = 0.01, .shear_viscosity = 3, .bulk_viscosity = 5};
  for (const LoadKind& kind : load_kinds()) {
    LoadDescription load;
    load.kind = load.name = kind.name;
    load.body = body.name;
    load.value = {30, -20, dimension == 3 ? 10.0 : 0.0};
    load.pressure = 400;
    load.stiffness = 70;
    load.displacement = {0.1, 0.2, 0};
    load.velocity = {0, 0.3, 0};
    if (kind.name != "body_force") {
      load.where.kind = Where::Kind::plane;
      load.where.at = 1;
    }
    scene.loads.push_back(load);
  }
  for (const ShapeKind& kind : shape_kinds()) {
    if (dimension == 2 && !kind.is_flat_too) continue;
    ColliderDescription collider;
    collider.kind = collider.name = kind.name;
    const int up = dimension - 1;
    collider.shape.point = -0.02 * Vector3::Unit(up);
    collider.shape.normal = Vector3::Unit(up);
    collider.shape.center = Vector3(0.5, 0, 0) - 0.52 * Vector3::Unit(up);
    collider.shape.radius = 0.5;
    collider.shape.size = {1, 1, 1};
    collider.shape.start = collider.shape.center - Vector3(0.3, 0, 0);
    collider.shape.end = collider.shape.center + Vector3(0.3, 0, 0);
    collider.shape.mesh = level_sheet(dimension, -0.02);
    collider.rotate = ColliderTurn{.axis = dimension == 3 ? Vector3(0.1, 0.2, 1) : Vector3::UnitZ(),
                                   .degrees_per_second = 20};
    collider.activation_distance = 0.1;
    collider.velocity = {0.2, 0, 0};
    collider.friction = 0.4;
    scene.colliders.push_back(collider);
  }
  BodyDescription other = body;
  other.name = "other";
  other.translate = 0.3 * Vector3::Unit(dimension - 1);
  scene.fixes[0].body = scene.probes[0].body = body.name;
  scene.bodies.push_back(other);
  scene.contact.activation_distance = 0.1;
  scene.contact.friction = 0.3;
  add_arm(scene);
  return scene;
}

/// An arm joined to the first one and to the ground by more than it needs: a term of each kind.
void add_joined_arm(Description& scene, BodyDescription arm, const TimeFunction& swings) {
  arm.name = "joined arm";
  scene.bodies.push_back(arm);
  const auto add = [&](const char* name, JointKind kind) -> JointDescription& {
    JointDescription& joint = scene.joints.emplace_back();
    joint.name = name;
    joint.kind = kind;
    joint.bodies = {"joined arm"};
    joint.at = arm.translate;
    if (kind == JointKind::slider) joint.axis = Vector3::UnitX();
    return joint;
  };
  const auto motor = [&](double velocity) {
    MotorDescription made;
    made.velocity = velocity;
    made.time_function = swings;
    return made;
  };
  JointDescription& torque = add("torque", JointKind::hinge);
  torque.motor = motor(0);
  torque.motor->effort = 7;
  add("turning motor", JointKind::hinge).motor = motor(3);
  JointDescription& angle = add("spring of an angle", JointKind::hinge);
  angle.stiffness = 40;
  angle.rest = 0.7;
  add("damper of an angle", JointKind::hinge).damping = 6;
  add("stop of an angle", JointKind::hinge).limits = {-1, -0.2};
  add("force", JointKind::slider).motor = motor(0);
  scene.joints.back().motor->effort = 7;
  add("pushing motor", JointKind::slider).motor = motor(3);
  JointDescription& way = add("spring of a way", JointKind::slider);
  way.stiffness = 40;
  way.rest = -0.3;
  add("damper of a way", JointKind::slider).damping = 6;
  add("stop of a way", JointKind::slider).limits = {0.1, 1};
  add("open stop", JointKind::slider).limits = {-1, 1};
  add("gap of a slider", JointKind::slider).bodies = {"arm", "joined arm"};
  if (scene.dimension == 2) return;
  add("gap of a plane", JointKind::planar).bodies = {"arm", "joined arm"};
  JointDescription& universal = add("gap of a universal joint", JointKind::universal);
  universal.bodies = {"arm", "joined arm"};
  universal.second_axis = Vector3::UnitX();
}

/// A rigid arm far from the bars, with a motor that turns it, a rod, springs and cables.
void add_arm(Description& scene) {
  const int dimension = scene.dimension;
  const Vector3 at = 3 * Vector3::Unit(dimension - 1);
  const auto place = [&at](double x, double y) { return Vector3(at + Vector3(x, y, 0)); };
  BodyDescription arm;
  arm.name = "arm";
  arm.mesh = dimension == 3 ? make_box({0.5, 0.3, 0.3}, {1, 1, 1}) : make_rectangle({0.5, 0.3}, {1, 1});
  arm.translate = at;
  arm.rigid = RigidDescription{.density = 1000};
  scene.bodies.push_back(arm);
  const TimeFunction swings{.form =
                                TimeFunction::Sine{.frequency = 3, .amplitude = 1, .phase = 20, .offset = 2}};
  JointDescription hinge, rod;
  hinge.name = "motor";
  hinge.kind = JointKind::hinge;
  hinge.motor = MotorDescription{
      .position = 0.4, .velocity = {}, .effort = {}, .stiffness = 50, .time_function = swings};
  rod.name = "rod";
  rod.kind = JointKind::distance;
  hinge.bodies = rod.bodies = {"arm"};
  hinge.at = at;
  rod.at = place(0.5, 0);
  rod.to = place(0.7, 0.3);
  scene.joints = {hinge, rod};
  add_joined_arm(scene, arm, swings);
  AnchorDescription on_arm, on_bar, on_ground;
  on_arm.body = "arm";
  on_arm.at = place(0.4, 0.1);
  on_bar.body = "other";
  on_bar.at = {1, 0, 0};
  on_ground.at = place(0.2, 0.5);
  const auto add = [](const char* name, const std::vector<AnchorDescription>& points,
                      std::vector<CableDescription>& list) -> CableDescription& {
    list.emplace_back().name = name;
    list.back().points = points;
    list.back().stiffness = 30;
    return list.back();
  };
  add("stretched spring", {on_arm, on_bar}, scene.springs).rest_length = 1;
  add("pressed spring", {on_arm, on_bar}, scene.springs).rest_length = 5;
  add("spring without rest length", {on_arm, on_bar}, scene.springs).rest_length = 0;
  CableDescription& slack = add("slack spring", {on_arm, on_bar}, scene.springs);
  slack.rest_length = 5;
  slack.tension_only = true;
  CableDescription& pulled = add("pulled cable", {on_ground, on_arm, on_bar}, scene.cables);
  pulled.tension = 4;
  pulled.time_function = swings;
  CableDescription& shortened = add("shortened cable", {on_ground, on_arm, on_bar}, scene.cables);
  shortened.shortening = 0.3;
  shortened.tension_only = true;
  shortened.time_function = swings;
  CableDescription& rubbing = add("rubbing cable", {on_ground, on_arm, on_bar}, scene.cables);
  rubbing.tension = 4;
  rubbing.friction = 0.3;
}

struct TermCase {
  int dimension;
  std::string element;
  std::string term;
  enum class Memory { none, viscoelastic, softened } memory = Memory::none;
};

void PrintTo(const TermCase& c, std::ostream* out) {
  *out << c.term << ", " << c.element << ", " << c.dimension << "D";
}

World world_of(const TermCase& c) {
  Description scene = crowded_scene(c.dimension, c.element);
  if (c.memory != TermCase::Memory::none)
    for (BodyDescription& body : scene.bodies) {
      if (body.rigid) continue;
      body.material.law = "neo_hookean_simo";
      if (c.memory == TermCase::Memory::softened) {
        body.material.mullins = {.r = 1.5, .beta = 0.5};
        continue;
      }
      body.material.viscoelastic = {.g = {0.4, 0.3}, .k = {0, 0.2}, .tau = {0.005, 1}};
    }
  return World(scene);
}

/// Each term of a scene of linear cells, and the terms on cells of every other element. Every start of this
/// program asks for them: round colliders of thousands of triangles are few ones here, with the same names.
std::vector<TermCase> all_cases() {
  std::vector<TermCase> cases;
  for (const int dimension : {2, 3}) {
    Description scene = crowded_scene(dimension, "P1");
    for (ColliderDescription& collider : scene.colliders)
      if (find_shape_kind(collider.kind)->make_mesh != nullptr) collider.kind = "mesh";
    std::set<std::string> names;  // both bodies have some of these
    for (const auto& term : World(scene).terms) names.emplace(term->name());
    for (const std::string& name : names) cases.push_back({dimension, "P1", name});
  }
  for (const ElementInfo* element : elements())
    for (const char* term : {"elastic", "viscous damping"})
      if (element->name != "P1") cases.push_back({element->dim, std::string(element->name), term});
  for (const ElementInfo* element : elements())
    for (const auto memory : {TermCase::Memory::viscoelastic, TermCase::Memory::softened})
      cases.push_back({element->dim, std::string(element->name), "elastic", memory});
  return cases;
}

std::string name_of(const ::testing::TestParamInfo<TermCase>& info) {
  return as_test_name((info.param.memory == TermCase::Memory::none       ? info.param.term
                       : info.param.memory == TermCase::Memory::softened ? "softened"
                                                                         : "viscoelastic") +
                      "_" + info.param.element + "_" + std::to_string(info.param.dimension) + "d");
}

VectorX random_vector(Eigen::Index size, double amount, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-amount, amount);
  VectorX x(size);
  for (double& value : x) value = uniform(generator);
  return x;
}

/// The first stage of a step of a scheme, in which bodies come to about x.
Stage first_stage(const std::string& integrator, const VectorX& x) {
  History start;
  start.now = {.positions = x + random_vector(x.size(), 0.004, 3),
               .velocities = random_vector(x.size(), 0.3, 4),
               .accelerations = random_vector(x.size(), 1, 5)};
  start.previous_positions = x + random_vector(x.size(), 0.004, 6);
  start.previous_velocities = random_vector(x.size(), 0.3, 8);
  start.previous_time_step = step_length;
  return make_integrator(integrator, "test")->begin_stage(0, start, {}, step_length);
}

/// One term as it is in the first stage of a step of every integrator: as a potential takes it.
struct EveryTerm : ::testing::TestWithParam<TermCase> {
  struct InStage {
    std::string integrator;
    std::unique_ptr<Potential> potential;
    const Energy* energy;
  };

  World world = world_of(GetParam());
  std::shared_ptr<const Energy> term;
  Terms terms;  ///< the term and those that it sees
  std::vector<InStage> stages;
  const Energy* energy = nullptr;  ///< energy of the stage at hand
  Potential* potential = nullptr;
  VectorX x, p;
  const Conditions at_hand{.time = 0.03, .load = 0.75, .delay = 0.005};
  Conditions conditions = at_hand;

  void SetUp() override {
    term = *std::ranges::find(world.terms, GetParam().term, [](const auto& t) { return t->name(); });
    x = world.rest_positions + random_vector(world.rest_positions.size(), 0.01, 1);
    p = random_vector(x.size(), 1, 2);
    terms = {term};
    if (term->properties().category == EnergyCategory::friction)
      for (const auto& source : world.terms)
        if (source->friction_source() != nullptr) terms.push_back(source);
    // Bodies have been in another shape for a while.
    const VectorX before = world.rest_positions + random_vector(x.size(), 0.01, 11);
    for (const std::string& integrator : integrator_names()) {
      auto made = std::make_unique<Potential>(terms, world.is_fixed, at_hand, first_stage(integrator, x),
                                              ProcessGroup(), start_of_history(terms, before, step_length));
      const Energy* in_stage = made->terms().front();
      const bool is_known = !stages.empty() && in_stage == term.get();  // the same in all stages
      if (!is_known) stages.push_back({integrator, std::move(made), in_stage});
    }
  }

  /// Calls `check()` with the term of each stage.
  template <class Check>
  void in_every_stage(const Check& check) {
    for (const InStage& stage : stages) {
      SCOPED_TRACE(stage.integrator);
      energy = stage.energy;
      potential = stage.potential.get();
      conditions = at_hand;
      potential->form_lag(x);
      potential->prepare(x, p);
      check();
    }
  }

  VectorX gradient_at(const VectorX& at) const {
    VectorX gradient = VectorX::Zero(at.size());
    energy->add_gradient(at, conditions, gradient);
    return gradient;
  }
  VectorX magnitude_at(const VectorX& at) const {
    VectorX magnitude = VectorX::Zero(at.size());
    energy->add_gradient_magnitude(at, conditions, magnitude);
    return magnitude;
  }
  BlockMatrix hessian_at(const VectorX& at, Projection projection) const {
    BlockMatrix hessian(world.dimension, world.pattern);
    energy->add_hessian(at, conditions, projection, hessian);
    return hessian;
  }
};

TEST_P(EveryTerm, DifferenceIsThatOfItsValues) {
  in_every_stage([&] {
    const VectorX to = x + 0.005 * p;
    EXPECT_EQ(energy->difference(x, x, conditions), 0);
    if (!energy->properties().has_potential) {  // the work depends on the path: there and back is nothing
      const double there = energy->difference(x, to, conditions);
      EXPECT_NEAR(there + energy->difference(to, x, conditions), 0, 1e-12 * std::abs(there));
      return;
    }
    const double from_value = energy->value(x, conditions), to_value = energy->value(to, conditions);
    // Sums of parts in another order: round-off of the values.
    EXPECT_NEAR(energy->difference(x, to, conditions), to_value - from_value,
                1e-11 * (std::abs(from_value) + std::abs(to_value)));
  });
}

TEST_P(EveryTerm, GradientIsTheSlopeOfItsEnergy) {
  in_every_stage([&] {
    const double h = 1e-6;  // central: error h^2 of the third derivative, round-off eps / h of the forces
    const double slope = energy->difference(x - h * p, x + h * p, conditions) / (2 * h);
    EXPECT_NEAR(slope, gradient_at(x).dot(p), 1e-6 * magnitude_at(x).dot(p.cwiseAbs()) + 1e-12);
  });
}

TEST_P(EveryTerm, HessianIsTheSlopeOfItsGradientOrItsSymmetricPart) {
  in_every_stage([&] {
    VectorX product;
    multiply(hessian_at(x, Projection::none), p, product);
    const double h = 1e-6;
    const VectorX q = random_vector(x.size(), 1, 7);
    const VectorX Tp = (gradient_at(x + h * p) - gradient_at(x - h * p)) / (2 * h);
    const VectorX Tq = (gradient_at(x + h * q) - gradient_at(x - h * q)) / (2 * h);
    const double scale = q.norm() * std::max(product.norm(), Tp.norm());
    if (energy->properties().has_potential) {
      constexpr double rounding = 10 * std::numeric_limits<double>::epsilon();  // rounding of forces, over h
      EXPECT_NEAR(q.dot(product), q.dot(Tp),
                  1e-5 * scale + 1e-9 + rounding / h * magnitude_at(x).norm() * q.norm());
    } else {
      EXPECT_NEAR(q.dot(product) + p.dot([&] {
        VectorX other;
        multiply(hessian_at(x, Projection::none), q, other);
        return other;
      }()),
                  q.dot(Tp) + p.dot(Tq), 1e-5 * scale + 1e-9);
    }
  });
}

TEST_P(EveryTerm, ProjectedHessianIsNeverNegative) {
  in_every_stage([&] {
    for (const Projection projection : {Projection::clamp, Projection::absolute}) {
      const BlockMatrix hessian = hessian_at(x, projection);
      if (!energy->properties().has_potential) continue;  // follows the surface: not projected
      for (unsigned seed = 10; seed < 30; ++seed) {
        const VectorX q = random_vector(x.size(), 1, seed);
        VectorX product;
        multiply(hessian, q, product);
        EXPECT_GE(q.dot(product), -1e-12 * q.norm() * product.norm());
      }
    }
  });
}

TEST_P(EveryTerm, MagnitudeBoundsItsGradient) {
  in_every_stage([&] {
    const VectorX gradient = gradient_at(x), magnitude = magnitude_at(x);
    for (Eigen::Index i = 0; i < x.size(); ++i)
      EXPECT_LE(std::abs(gradient[i]), magnitude[i] * (1 + 1e-12) + 1e-300) << "unknown " << i;
  });
}

TEST_P(EveryTerm, IsFiniteWithinItsLargestStep) {
  in_every_stage([&] {
    for (const double length : {0.001, 0.1, 10.0, 1000.0}) {
      const VectorX q = length * random_vector(x.size(), 1, 9);
      potential->prepare(x, q);
      const double step = energy->max_step(x, q, conditions);
      EXPECT_GT(step, 0);
      EXPECT_LE(step, 1);
      EXPECT_TRUE(std::isfinite(energy->value(x + step * q, conditions))) << "length " << length;
    }
  });
}

TEST_P(EveryTerm, HasOneHessianEverywhereWhereItIsQuadratic) {
  in_every_stage([&] {
    if (!energy->properties().is_quadratic) return;
    const VectorX elsewhere = x + 0.005 * p;
    VectorX here, there;
    multiply(hessian_at(x, Projection::none), p, here);
    multiply(hessian_at(elsewhere, Projection::none), p, there);
    EXPECT_LE((here - there).norm(), 1e-12 * here.norm());
  });
}

TEST_P(EveryTerm, DoesNothingInStaticsWhereItFollowsVelocities) {
  const EnergyCategory category = term->properties().category;
  if (category != EnergyCategory::inertia && category != EnergyCategory::damping) return;
  EXPECT_EQ(term->begin_stage(static_stage(x)), nullptr);
  EXPECT_EQ(term->value(x, conditions), 0);
  for (const InStage& stage : stages) EXPECT_NE(stage.energy, term.get());
}

/// The guard of a step's energy relies on it: what drives a term does all of its change in one place.
TEST_P(EveryTerm, SaysWhatDrivesItOrDoesNotChangeWithTime) {
  Conditions later = conditions;
  later.time = 0.07;
  const double change = term->value(x, later) - term->value(x, conditions);
  const std::optional<double> work = term->driven_work(x, conditions, x, later);
  if (!work) {
    EXPECT_EQ(change, 0);
    return;
  }
  EXPECT_GE(*work, change - 1e-12 * (std::abs(change) + std::abs(*work)));
}

TEST_P(EveryTerm, CountsAsOftenAsAStageSaysIfItActsAsAnImpulse) {
  in_every_stage([&] {
    const double times = acts_as_impulse(term->properties().category) ? 3 : 1;
    const double value = energy->value(x, conditions);
    const double difference = energy->difference(x, x + 0.005 * p, conditions);
    const VectorX gradient = gradient_at(x), magnitude = magnitude_at(x);
    VectorX product, weighted_product;
    multiply(hessian_at(x, Projection::none), p, product);
    conditions.weight = 3;
    multiply(hessian_at(x, Projection::none), p, weighted_product);
    EXPECT_DOUBLE_EQ(energy->value(x, conditions), times * value);
    EXPECT_DOUBLE_EQ(energy->difference(x, x + 0.005 * p, conditions), times * difference);
    EXPECT_LE((gradient_at(x) - times * gradient).norm(), 1e-14 * gradient.norm());
    EXPECT_LE((magnitude_at(x) - times * magnitude).norm(), 1e-14 * magnitude.norm());
    EXPECT_LE((weighted_product - times * product).norm(), 1e-14 * product.norm());
  });
}

/// Both products of d2E/(dx dp) are of the same matrix. That it is the right one, tests/sensitivity says.
TEST_P(EveryTerm, HasProductsWithItsParametersThatAreTransposed) {
  in_every_stage([&] {
    for (const EnergyParameter& parameter : energy->parameters()) {
      SCOPED_TRACE(parameter.name);
      const VectorX w = random_vector(x.size(), 1, 3), change = random_vector(parameter.size, 1, 4);
      VectorX forces = VectorX::Zero(x.size()), slopes = VectorX::Zero(parameter.size);
      energy->add_parameter_forces(parameter.name, x, change, conditions, forces);
      energy->add_parameter_slopes(parameter.name, x, w, conditions, slopes);
      EXPECT_TRUE(forces.allFinite());
      // Forces on vertices know nothing of the shape, and a slack spring nothing of its constants.
      if (parameter.name != "rest_positions" && !gradient_at(x).isZero(0)) {
        EXPECT_GT(forces.norm(), 0);
      }
      // A force on one facet does not change with its shape: terms cancel up to their rounding.
      const double rounding = 1e-14 * w.norm() * change.norm() * gradient_at(x).norm();
      EXPECT_NEAR(slopes.dot(change), w.dot(forces), 1e-12 * w.norm() * forces.norm() + rounding);
    }
  });
}

TEST_P(EveryTerm, GivesTheSameBitsForAnyNumberOfThreads) {
  in_every_stage([&] {
    const int threads_before = num_threads();
    set_num_threads(1);
    const double value = energy->value(x, conditions);
    const VectorX gradient = gradient_at(x);
    for (const int threads : {2, 8}) {
      set_num_threads(threads);
      EXPECT_EQ(energy->value(x, conditions), value);
      EXPECT_EQ(gradient_at(x), gradient);
    }
    set_num_threads(threads_before);
  });
}

INSTANTIATE_TEST_SUITE_P(AllTerms, EveryTerm, ::testing::ValuesIn(all_cases()), name_of);

}  // namespace
}  // namespace resilin::testing
