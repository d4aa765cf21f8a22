// Remarks on a scene before its first step: starts that a law cannot have, scenes in which nothing
// happens, bodies in each other, probes far from any vertex.
#include "resilin/world/start_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "every_element.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::string joined(const std::vector<std::string>& lines) {
  std::string all;
  for (const std::string& line : lines) all += line + "\n";
  return all;
}

std::string warnings_of(const Description& scene) { return joined(all_warnings(World(scene))); }

/// The bar of small_bar in cells of an element, with its first cell turned inside out: its last corner goes
/// through it.
Description inverted_start(const ElementInfo& element, const LawInfo& law, bool is_dynamic) {
  Description scene = small_bar(element.dim, is_dynamic);
  BodyDescription& body = scene.bodies[0];
  body.material = material_of(law);
  body.element = element.name;
  if (!is_simplex(element.shape))
    body.mesh = element.dim == 3 ? make_hexahedron_box({1, 0.25, 0.25}, {4, 1, 1})
                                 : make_quadrilateral_rectangle({1, 0.25}, {4, 1});
  std::vector<Vector3> places = body.mesh.vertices;
  // Mirrored across x = 0.5, half-way: every cell is inside out.
  for (Vector3& X : places) X.x() = 1 - X.x();
  for (const Vector3& X : places)
    body.initial_positions.insert(body.initial_positions.end(), X.data(), X.data() + element.dim);
  return scene;
}

struct StartOfEveryElement : OnEveryElement {};
INSTANTIATE_TEST_SUITE_P(Catalogue, StartOfEveryElement, ::testing::ValuesIn(elements()), name_of_element);

TEST_P(StartOfEveryElement, IsRefusedInsideOutUnderALawThatNeedsPositiveVolume) {
  for (const LawInfo* law : laws()) {
    if (element.has_mean_volume && !law->has_volume_energy) continue;
    SCOPED_TRACE(law->name);
    for (const bool is_dynamic : {false, true}) {
      const Description scene = inverted_start(element, *law, is_dynamic);
      const std::string message = refusal_of(scene);
      if (law->needs_positive_J) {
        EXPECT_THAT(message, AllOf(HasSubstr("initial_positions"), HasSubstr("cell 0"), HasSubstr("J > 0"),
                                   HasSubstr(law->name)));
      } else if (law->kind != LawKind::stretches) {  // the mirrored state has no unique rotation
        EXPECT_EQ(message, "");
      } else {
        EXPECT_THAT(message, AllOf(HasSubstr("initial_positions"), HasSubstr("cell 0")));
      }
    }
  }
}

/// One cell alone is inside out: it is named by its number in the mesh.
TEST(Start, NamesTheCellThatIsInsideOut) {
  for (const Index cell : {0, 7, 30, 101}) {
    Description scene = small_bar(3, true);
    BodyDescription& body = scene.bodies[0];
    body.material.law = "neo_hookean";
    // Vertices of that cell alone: all cells stand apart.
    Mesh apart;
    CellBlock block{CellKind::tetrahedron, {}};
    for (const Index node : body.mesh.find_solid(3)->nodes) {
      block.nodes.push_back(static_cast<Index>(apart.vertices.size()));
      apart.vertices.push_back(body.mesh.vertices[static_cast<std::size_t>(node)]);
    }
    apart.blocks = {block};
    body.mesh = apart;
    std::vector<Vector3> places = apart.vertices;
    std::swap(places[static_cast<std::size_t>(4 * cell)], places[static_cast<std::size_t>(4 * cell + 1)]);
    for (const Vector3& X : places)
      body.initial_positions.insert(body.initial_positions.end(), X.data(), X.data() + 3);
    EXPECT_THAT(refusal_of(scene),
                AllOf(HasSubstr("cell " + std::to_string(cell) + " "), HasSubstr("ratio -1")));
  }
}

TEST(Start, IsRefusedWhereALawEndsElsewhere) {
  Description scene = small_bar(3, true);
  BodyDescription& body = scene.bodies[0];
  body.material = material_of(*find_law("gent"));
  for (const Vector3& X : body.mesh.vertices) {
    const Vector3 place(50 * X.x(), X.y() / 7, X.z() / 7);
    body.initial_positions.insert(body.initial_positions.end(), place.data(), place.data() + 3);
  }
  EXPECT_THAT(refusal_of(scene), AllOf(HasSubstr("gent"), HasSubstr("finite"), HasSubstr("cell 0")));
}

/// Flat cells have finite forces, but no area that a Cauchy stress could act on.
TEST(Start, TellsOfCellsWithoutVolumeWhereTheLawPermitsThem) {
  for (const std::string law : {"stable_neo_hookean", "linear_elastic"})
    for (const double height : {0.0, 0.1}) {
      Description scene = small_bar(3, true);
      BodyDescription& body = scene.bodies[0];
      body.material = material_of(*find_law(law));
      for (const Vector3& X : body.mesh.vertices) {
        const Vector3 place(X.x(), X.y(), height * X.z());
        body.initial_positions.insert(body.initial_positions.end(), place.data(), place.data() + 3);
      }
      const World world(scene);
      const bool is_told = std::ranges::any_of(world.warnings, [](const std::string& warning) {
        return warning.find("starts with cells of no volume, cell 0 among them") != std::string::npos;
      });
      EXPECT_EQ(is_told, law == "stable_neo_hookean" && height == 0) << law << " " << height;
    }
}

/// A scene with nothing in it, and what makes it a scene in which something happens.
struct Cause {
  std::string name;
  bool in_motion_only;
  std::function<void(Description&)> add;
};

Description empty_scene(int dimension, bool is_dynamic) {
  Description scene = small_bar(dimension, is_dynamic);
  scene.gravity.setZero();
  return scene;
}

LoadDescription load_of(const std::string& kind, double size) {
  LoadDescription load;
  load.kind = kind;
  load.value = {size, 0, 0};
  load.pressure = size;
  load.stiffness = 100;
  load.displacement = {size, 0, 0};
  if (kind != "body_force") {
    load.where.kind = Where::Kind::plane;
    load.where.at = 1;
  }
  return load;
}

std::vector<Cause> causes() {
  std::vector<Cause> all = {
      {"gravity", false, [](Description& d) { d.gravity = {1, 0, 0}; }},
      {"fix", false, [](Description& d) { d.fixes[0].displacement = {0, 0.01, 0}; }},
      {"turn", false, [](Description& d) { d.fixes[0].rotate = Rotation{.degrees = 5}; }},
      {"fix that comes back", false,
       [](Description& d) {
         d.fixes[0].displacement = {0, 0.01, 0};
         d.fixes[0].time_function.form = TimeFunction::Table{.times = {0, 0.07, 0.2}, .values = {0, 1, 0}};
       }},
      {"fix velocity", false, [](Description& d) { d.fixes[0].velocity = {0.1, 0, 0}; }},
      {"velocity", true, [](Description& d) { d.bodies[0].velocity = {0, 1, 0}; }},
      {"velocity gradient", true, [](Description& d) { d.bodies[0].velocity_gradient(0, 0) = 1; }},
      {"late load", false,
       [](Description& d) {
         d.loads.push_back(load_of("traction", 5));
         d.loads[0].from = 0.15;
         d.loads[0].until = 0.151;
       }},
      {"load that grows", false,
       [](Description& d) {
         d.loads.push_back(load_of("traction", 5));
         d.loads[0].time_function.form = TimeFunction::Ramp{.from = 0.1, .until = 0.3};
       }},
      {"start drawn out", false,
       [](Description& d) {
         for (const Vector3& X : d.bodies[0].mesh.vertices) {
           const Vector3 place(1.01 * X.x(), X.y(), X.z());
           d.bodies[0].initial_positions.insert(d.bodies[0].initial_positions.end(), place.data(),
                                                place.data() + d.dimension);
         }
       }},
      {"collider that comes", false, [](Description& d) {
         ColliderDescription collider;
         collider.shape.point = {1.2, 0, 0};
         collider.shape.normal = {-1, 0, 0};
         collider.velocity = {-2, 0, 0};
         d.colliders.push_back(collider);
       }}};
  for (const std::string kind : {"body_force", "traction", "nodal_force", "pressure", "spring"})
    all.push_back({kind, false, [kind](Description& d) { d.loads.push_back(load_of(kind, 2)); }});
  return all;
}

TEST(IdleScene, IsToldFromOneInWhichSomethingHappens) {
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true}) {
      EXPECT_TRUE(is_idle(World(empty_scene(dimension, is_dynamic))));
      for (const Cause& cause : causes()) {
        if (cause.in_motion_only && !is_dynamic) continue;
        Description scene = empty_scene(dimension, is_dynamic);
        cause.add(scene);
        const World world(scene);
        EXPECT_FALSE(is_idle(world)) << cause.name << " " << dimension << " " << is_dynamic;
        EXPECT_THAT(joined(all_warnings(world)), Not(HasSubstr("nothing"))) << cause.name;
      }
    }
}

TEST(IdleScene, IsOneWhoseCausesComeToNothing) {
  const std::vector<std::pair<std::string, std::function<void(Description&)>>> nothings = {
      {"gravity across the plane", [](Description& d) { d.dimension == 2 ? d.gravity.z() = -9 : 0; }},
      {"load of zero", [](Description& d) { d.loads.push_back(load_of("traction", 0)); }},
      {"load after the end",
       [](Description& d) {
         d.loads.push_back(load_of("traction", 4));
         d.loads[0].from = 7;
       }},
      {"factor of zero",
       [](Description& d) {
         d.loads.push_back(load_of("nodal_force", 4));
         d.loads[0].time_function.form = TimeFunction::Table{.times = {0, 1}, .values = {0, 0}};
       }},
      {"all held",
       [](Description& d) {
         d.gravity = {0, -9.81, 0};
         d.fixes[0].where.kind = Where::Kind::all;
       }},
      {"velocity of what is held", [](Description& d) {
         d.bodies[0].velocity = {1, 0, 0};
         d.fixes[0].where.kind = Where::Kind::all;
       }}};
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true})
      for (const auto& [name, add] : nothings) {
        Description scene = empty_scene(dimension, is_dynamic);
        add(scene);
        EXPECT_TRUE(is_idle(World(scene))) << name << " " << dimension << " " << is_dynamic;
        EXPECT_THAT(warnings_of(scene),
                    HasSubstr(is_dynamic ? "nothing moves the bodies" : "nothing loads the bodies"))
            << name;
      }
  EXPECT_THAT(warnings_of(empty_scene(3, false)), HasSubstr("nothing loads the bodies"));
}

TEST(BodiesAtTheStart, AreWarnedOfWhereTheyShareSpace) {
  for (const int dimension : {2, 3})
    for (const double x : {0.5, 0.99, 1.0, 1.3}) {
      Description scene = small_bar(dimension, true);
      scene.bodies.push_back(scene.bodies[0]);
      scene.bodies[1].name = "other";
      scene.bodies[1].translate = {x, 0.01, 0};
      scene.contact.is_enabled = false;
      scene.fixes[0].body = scene.probes[0].body = "body";
      const std::string words = warnings_of(scene);
      if (x < 1) {
        EXPECT_THAT(words, AllOf(HasSubstr("\"body\" and \"other\" overlap"), HasSubstr("near ("))) << x;
      } else {
        EXPECT_THAT(words, Not(HasSubstr("overlap"))) << x;
      }
    }
}

/// A bar whose far end is pushed down through a floor that its vertices do not feel there, or stops above.
TEST(Supports, AreWarnedOfWhereTheyLeadIntoACollider) {
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true})
      for (const double down : {-0.05, -0.1, -0.5}) {
        Description scene = small_bar(dimension, is_dynamic);
        ColliderDescription floor;
        floor.name = "floor";
        const int up = dimension - 1;
        floor.shape.point = -0.1 * Vector3::Unit(up);
        floor.shape.normal = Vector3::Unit(up);
        scene.colliders.push_back(floor);
        FixDescription press;
        press.place = "press";
        press.name = "press";
        press.where.kind = Where::Kind::plane;
        press.where.at = 1;
        press.displacement[up] = down;
        if (is_dynamic) press.time_function.form = TimeFunction::Ramp{.from = 0, .until = 0.15};
        scene.fixes.push_back(press);
        const std::string words = warnings_of(scene);
        if (down == -0.5) {
          EXPECT_THAT(
              words, AllOf(HasSubstr("press: takes vertex"), HasSubstr("0.4 m into the collider \"floor\"")));
        } else {
          EXPECT_THAT(words, Not(HasSubstr("into the collider"))) << down;
        }
        scene.fixes[1].components = {true, false, false};
        EXPECT_THAT(warnings_of(scene), Not(HasSubstr("into the collider")));
      }
}

/// The end goes down and comes back: what is said names the deepest place on the way, in statics by its load.
TEST(Supports, AreWarnedOfAColliderOnTheirWay) {
  for (const bool is_dynamic : {false, true}) {
    Description scene = small_bar(2, is_dynamic);
    ColliderDescription floor;
    floor.name = "floor";
    floor.shape.point = {0, -0.1, 0};
    floor.shape.normal = {0, 1, 0};
    scene.colliders.push_back(floor);
    FixDescription press;
    press.place = press.name = "press";
    press.where.kind = Where::Kind::plane;
    press.where.at = 1;
    press.displacement = {0, -0.5, 0};
    press.time_function.form = TimeFunction::Table{.times = {0, 0.05, 0.2}, .values = {0, 1, 0}};
    scene.fixes.push_back(press);
    EXPECT_THAT(warnings_of(scene), AllOf(HasSubstr("0.4 m into the collider \"floor\""),
                                          HasSubstr(is_dynamic ? "at t = 0.05 s" : "at load factor 0.25")));
  }
}

/// A bar in free fall above a floor, or guided along the normal, with gaps from far inside to outside the
/// activation distance; a second floor on the other side takes the push back.
TEST(Contact, IsWarnedOfWhenItPushesABodyOffAtTheStart) {
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true})
      for (const double gap : {1e-5, 1e-3, 0.00499, 0.0051}) {
        SCOPED_TRACE(gap);
        if (!is_dynamic && gap > 0.005) continue;  // nothing holds it
        Description scene = small_bar(dimension, is_dynamic);
        scene.gravity = {0, -9.81, 0};
        scene.fixes[0].components = {true, false, true};
        ColliderDescription floor;
        floor.name = "floor";
        floor.activation_distance = 0.005;
        floor.shape.point = {0, -gap, 0};
        floor.shape.normal = {0, 1, 0};
        scene.colliders = {floor};
        const bool is_inside = gap < 0.004;
        const std::string words = warnings_of(scene);
        EXPECT_EQ(
            words.find("\"body\" starts inside the activation distance of \"floor\"") != std::string::npos,
            is_inside)
            << words;
        scene.fixes[0].components = {true, true, true};
        EXPECT_THAT(warnings_of(scene), Not(HasSubstr("starts inside"))) << "held along the push";
        scene.fixes[0].components = {true, false, true};
        floor.name = "ceiling";
        floor.shape.point = {0, 0.25 + gap, 0};
        floor.shape.normal = {0, -1, 0};
        scene.colliders.push_back(floor);
        EXPECT_THAT(warnings_of(scene), Not(HasSubstr("starts inside"))) << "pushed from both sides";
      }
}

/// Sum of the sizes of all contact forces at the start, and of gravity's [N].
std::pair<double, double> contact_and_weight(const World& world) {
  VectorX contact = VectorX::Zero(world.start_positions.size()), weight = contact;
  for (std::size_t t = 0; t < world.origins.size(); ++t) {
    const TermOrigin::Kind kind = world.origins[t].kind;
    if (kind == TermOrigin::Kind::collider || kind == TermOrigin::Kind::contact)
      world.terms[t]->add_gradient(world.start_positions, {}, contact);
    if (kind == TermOrigin::Kind::gravity) world.terms[t]->add_gradient(world.start_positions, {}, weight);
  }
  return {contact.lpNorm<1>(), weight.lpNorm<1>()};
}

/// A bar in free fall or guided down, a gap above a half-space, a box or another bar.
Description bar_above(const std::string& under, double gap, int dimension, bool is_dynamic) {
  Description scene = small_bar(dimension, is_dynamic);
  scene.gravity = {0, -9.81, 0};
  scene.fixes[0].components = {true, false, true};
  if (under == "bar") {
    BodyDescription base = scene.bodies[0];
    base.name = "base";
    base.translate = {0, -0.25 - gap, 0};
    scene.bodies.push_back(base);
    FixDescription held = scene.fixes[0];
    held.place = held.name = "held";
    held.body = "base";
    held.where = {};
    held.components = {true, true, true};
    scene.fixes[0].body = scene.probes[0].body = scene.bodies[0].name;
    scene.fixes.push_back(held);
    return scene;
  }
  ColliderDescription floor;
  floor.name = "floor";
  floor.kind = under;
  floor.shape.point = {0, -gap, 0};
  floor.shape.normal = {0, 1, 0};
  floor.shape.center = {0.5, -0.5 - gap, dimension == 3 ? 0.125 : 0};
  floor.shape.size = {4, 1, dimension == 3 ? 4.0 : 0.0};
  scene.colliders = {floor};
  return scene;
}

TEST(Contact, HasByDefaultAnActivationDistanceThatFollowsASmallGap) {
  for (const int dimension : {2, 3})
    for (const bool is_dynamic : {false, true})
      for (const std::string under : {"half_space", "box", "bar"})
        for (const double gap : {6e-5, 2e-4, 9e-4, 0.00124}) {
          SCOPED_TRACE(under + " at " + std::to_string(gap) + (is_dynamic ? " in motion" : ""));
          const World world(bar_above(under, gap, dimension, is_dynamic));
          EXPECT_THAT(joined(world.warnings), Not(HasSubstr("starts inside")));
          const auto [push, weight] = contact_and_weight(world);
          const bool is_noted = joined(world.notes).find("activation distance of") != std::string::npos;
          if (is_noted) {
            EXPECT_LT(push, 10 * weight);
          }
          if (!is_dynamic) {
            EXPECT_GT(push, 0.5 * weight) << "contact alone holds it";
          }
          if (gap < 5e-4) {
            EXPECT_TRUE(is_noted);
          }
        }
}

/// The push of contact counts by its length: a scene that is turned as a whole has the same distances.
TEST(Contact, HasDefaultDistancesThatDoNotFollowTheAxes) {
  const auto distances = [](double gap, double degrees) {
    Description scene = small_bar(3, true);
    const Vector3 axis = Vector3(1, 2, 3).normalized();
    const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180, axis);
    scene.fixes.clear();
    scene.probes.clear();
    scene.bodies[0].rotate = Rotation{.axis = axis, .degrees = degrees};
    scene.gravity = turn * Vector3(0, -9.81, 0);
    ColliderDescription floor;
    floor.name = "floor";
    floor.kind = "half_space";
    floor.shape.point = turn * Vector3(0, -gap, 0);
    floor.shape.normal = turn * Vector3(0, 1, 0);
    scene.colliders = {floor};
    return World(scene).colliders[0]->activation_distance();
  };
  for (double gap = 2e-4; gap < 1.25e-3; gap *= 1.1)
    for (const double degrees : {50.0, 110.0})
      EXPECT_NEAR(distances(gap, degrees), distances(gap, 0), 1e-9) << gap << ", " << degrees;
}

TEST(Probe, IsWarnedOfWhenNoVertexIsNear) {
  struct Place {
    Vector3 at;
    bool is_far;
  };
  // Cells of 0.125 m; a tenth of the bar is 0.1 m.
  for (const int dimension : {2, 3})
    for (const auto& [at, is_far] :
         {Place{{1, 0.25, 0}, false}, Place{{1, 0.2, 0}, false}, Place{{1.05, 0.25, 0}, false},
          Place{{1.2, 0.25, 0}, true}, Place{{0.5, 1, 0}, true}, Place{{-3, 0, 0}, true}}) {
      Description scene = small_bar(dimension, true);
      scene.probes[0].at = at;
      const std::string words = warnings_of(scene);
      if (is_far) {
        EXPECT_THAT(words, AllOf(HasSubstr("probe"), HasSubstr("the nearest vertex"))) << at.transpose();
      } else {
        EXPECT_THAT(words, IsEmpty()) << at.transpose();
      }
    }
  Description coarse = small_bar(3, true);
  coarse.bodies[0].mesh = make_box({1, 1, 1}, {1, 1, 1});
  coarse.probes[0].at = {0.5, 0.5, 0.5};  // in a cell, and yet far from its corners
  EXPECT_THAT(warnings_of(coarse), HasSubstr("the nearest vertex"));
}

TEST(Units, AreWarnedOfInTheWorldItself) {
  Description scene = small_bar(3, true);
  scene.bodies[0].scale = 1e5;
  EXPECT_THAT(warnings_of(scene), AllOf(HasSubstr("in other units"), HasSubstr("its own weight strains")));
}

}  // namespace
}  // namespace resilin::testing
