#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "scene_text.hpp"
#include "temporary_folder.hpp"
#include "test_names.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(SceneFile, FillsTheDescription) {
  const Description d = read_text(good_scene).description;
  EXPECT_EQ(d.title, "A small beam");
  EXPECT_FALSE(d.is_dynamic);
  EXPECT_EQ(d.gravity, Vector3(0, 0, -9.81));
  ASSERT_EQ(d.bodies.size(), 1u);
  EXPECT_EQ(d.bodies[0].name, "beam");
  EXPECT_EQ(d.bodies[0].mesh.find_block(CellKind::tetrahedron)->num_cells(), 12);
  EXPECT_EQ(d.bodies[0].material.law, "neo_hookean");
  EXPECT_EQ(d.bodies[0].material.constants.at("youngs_modulus"), 1e6);
  ASSERT_EQ(d.fixes.size(), 1u);
  EXPECT_EQ(d.fixes[0].where.group, "x_min");
  ASSERT_EQ(d.loads.size(), 1u);
  EXPECT_EQ(d.loads[0].kind, "traction");
  EXPECT_EQ(d.loads[0].value, Vector3(0, 0, -100));
  ASSERT_EQ(d.probes.size(), 1u);
  EXPECT_EQ(d.probes[0].at, Vector3(2, 0.5, 0.5));
}

TEST(SceneFile, LeavesTheDefaultsOfTheStructsWhereItSaysNothing) {
  const Description d =
      read_text("[[body]]\nmesh = { box = { size = [1, 1, 1], cells = [1, 1, 1] } }").description;
  const Description defaults;
  EXPECT_EQ(d.time_step, defaults.time_step);
  EXPECT_EQ(d.newton.tolerance, defaults.newton.tolerance);
  EXPECT_EQ(d.output.fields, defaults.output.fields);
  EXPECT_EQ(d.bodies[0].material.constants, MaterialDescription{}.constants);
}

TEST(SceneFile, ListsBranchesOfAPronySeriesOneByOne) {
  const auto with = [](const std::string& viscoelastic) {
    return "[[body]]\nmesh = { box = { size = [1, 1, 1], cells = [1, 1, 1] } }\nmaterial = { law = \"yeoh\", "
           "c10 = 1, c20 = 0, c30 = 0, bulk_modulus = 9, viscoelastic = { " +
           viscoelastic + " } }";
  };
  const std::string branches = "branches = [{ g = 0.3, tau = 0.1 }, { g = 0.2, k = 0.0, tau = 1 }]";
  const Description d = read_text(with(branches)).description;
  const ViscoelasticDescription& read = d.bodies[0].material.viscoelastic.value();
  EXPECT_EQ(read.g, (std::vector<double>{0.3, 0.2}));
  EXPECT_EQ(read.tau, (std::vector<double>{0.1, 1}));
  EXPECT_THAT(input_error([&] { read_text(with(branches + ", g = [0.3]")); }),
              HasSubstr("either branches or the lists g, k and tau"));
  EXPECT_TRUE(read.k.empty());
  const Description bulk =
      read_text(with("branches = [{ g = 0.3, tau = 1 }, { k = 0.1, tau = 2 }]")).description;
  EXPECT_EQ(bulk.bodies[0].material.viscoelastic->g, (std::vector<double>{0.3, 0}));
  EXPECT_EQ(bulk.bodies[0].material.viscoelastic->k, (std::vector<double>{0, 0.1}));
}

TEST(SceneFile, MayBeginWithAByteOrderMark) {
  EXPECT_EQ(read_text("\xef\xbb\xbf" + good_scene).description.title, "A small beam");
  EXPECT_EQ(input_error([] { read_text("\xff\xfet\0i\0"); }),
            "beam.toml: expected a text in UTF-8, got one in UTF-16 or UTF-32; save it as UTF-8");
}

TEST(SceneFile, TellsFileLineAndColumnOfASyntaxError) {
  const std::string message = input_error([] { read_text("title = \"a\"\ngravity = [1, 2\n[[body]]\n"); });
  EXPECT_THAT(message, StartsWith("beam.toml:3:")) << message;
  EXPECT_EQ(std::ranges::count(message, '\n'), 0);
}

TEST(SceneFile, KnowsTheWordsOfOtherPrograms) {
  const std::pair<const char*, const char*> cases[] = {
      {"dirichlet=[{}]", "fix"},
      {"neumann=[{}]", "load"},
      {"boundary_condition=[{}]", "fix"},
      {"displacement=[{}]", "fix"},
      {"force=[{}]", "load"},
      {"obstacle=[{}]", "collider"},
      {"body.0.material.model=\"neo_hookean\"", "law"},
      {"body.0.material.Constitutive-Model=\"neo_hookean\"", "law"},
      {"body.0.material.nu=0.3", "poissons_ratio"},
      {"body.0.material.rho=1000", "density"},
      {"contact.mu=0.3", "friction"},
      {"contact.friction_coefficient=0.3", "friction"},
      {"contact.dhat=1e-3", "activation_distance"},
      {"simulation.dt=0.1", "time_step"},
      {"fix.0.value=[0, 0, 1]", "displacement"},
  };
  for (const auto& [words, key] : cases)
    EXPECT_THAT(error_with({words}), HasSubstr(std::string("it is called \"") + key + "\" here")) << words;
  EXPECT_THAT(error_with({"rigid=[{}]"}), HasSubstr("[[collider]] (prescribed motion) or body.rigid"));
}

TEST(SceneFile, TellsFileLineAndKeyOfAWrongValue) {
  EXPECT_EQ(error_after_replacing("poissons_ratio = 0.3", "poissons_ratio = \"soft\""),
            "beam.toml:14: body[0].material.poissons_ratio: expected a number, got \"soft\"");
  EXPECT_EQ(error_after_replacing("gravity = [0, 0, -9.81]", "gravity = [0, -9.81]"),
            "beam.toml:5: simulation.gravity: expected 3 numbers since simulation.dimension is 3, got 2");
}

TEST(SceneFile, NamesTheNearestKnownKey) {
  EXPECT_THAT(error_after_replacing("youngs_modulus", "youngs_modulos"),
              AllOf(HasSubstr("beam.toml:13: body[0].material.youngs_modulos: unknown key"),
                    HasSubstr("did you mean \"youngs_modulus\"?")));
  EXPECT_THAT(error_after_replacing("[simulation]", "[simulaton]"),
              HasSubstr("did you mean \"simulation\"?"));
  EXPECT_THAT(error_with({"fix.wall.wheer=\"all\""}), HasSubstr("did you mean \"where\"?"));
}

TEST(SceneFile, SaysWhatIsNotAvailable) {
  EXPECT_THAT(error_with({"body.0.material.law=plasticity"}), HasSubstr("not available (docs/limits.md)"));
  EXPECT_THAT(error_with({"body.0.element=shell"}), HasSubstr("not available (docs/limits.md)"));
  EXPECT_THAT(error_with({"solver.kind=gpu"}), HasSubstr("not available (docs/limits.md)"));
  EXPECT_THAT(error_with({"load.0.kind=creep"}), HasSubstr("not available (docs/limits.md)"));
  EXPECT_THAT(error_with({"load.0.kind=follower_load"}), HasSubstr("it is called \"pressure\" here"));
}

TEST(SceneFile, AsksForAPointInDecimals) {
  EXPECT_THAT(error_after_replacing("poissons_ratio = 0.3", "poissons_ratio = 0,3"),
              AllOf(HasSubstr("beam.toml:14"), HasSubstr("write decimals with a point, not a comma")));
  EXPECT_THAT(error_after_replacing("poissons_ratio = 0.3", "poissons_ratio = \"0,3\""),
              HasSubstr("got \"0,3\"; write decimals with a point: 0.3"));
  EXPECT_THAT(error_with({"simulation.time_step=0,01"}),
              HasSubstr("got \"0,01\"; write decimals with a point, not a comma"));
}

TEST(SceneFile, AcceptsWholeNumbersWhereNumbersAre) {
  EXPECT_EQ(read_good_scene_with({"simulation.end_time=2"}).description.end_time, 2.0);
}

TEST(SceneFile, RefusesNumbersThatAreNotFinite) {
  EXPECT_THAT(error_with({"simulation.gravity=[0,0,nan]"}),
              HasSubstr("simulation.gravity[2]: expected a number, got nan"));
  EXPECT_THAT(error_with({"body.0.material.density=inf"}), HasSubstr("density"));
}

struct WrongValue {
  std::string assignment;
  std::string message;  ///< a part of it
};

void PrintTo(const WrongValue& value, std::ostream* stream) { *stream << value.assignment; }

class EveryWrongValue : public ::testing::TestWithParam<WrongValue> {};

TEST_P(EveryWrongValue, IsRefusedInOneLineThatNamesIt) {
  const std::string message = error_with({GetParam().assignment});
  EXPECT_THAT(message, HasSubstr(GetParam().message)) << GetParam().assignment;
  EXPECT_EQ(std::ranges::count(message, '\n'), 0) << message;
}

INSTANTIATE_TEST_SUITE_P(
    Ranges, EveryWrongValue,
    ::testing::Values(
        WrongValue{"simulation.time_step=0", "simulation.time_step: expected a number > 0, got 0"},
        WrongValue{"simulation.end_time=-1", "simulation.end_time: expected a number > 0"},
        WrongValue{"simulation.load_steps=0", "simulation.load_steps: expected a whole number >= 1"},
        WrongValue{"simulation.load_steps=1.5",
                   "simulation.load_steps: expected a whole number >= 1, got 1.5"},
        WrongValue{"simulation.load_steps=99999999999", "fits 32 bits"},
        WrongValue{"simulation.dimension=4",
                   "simulation.dimension: expected 2, 3, \"plane_stress\" or \"axisymmetric\", got 4"},
        WrongValue{"simulation.kind=quick", "simulation.kind: expected \"static\", \"dynamic\" or \"modes\""},
        WrongValue{"newton.tolerance=0", "newton.tolerance: expected a number > 0"},
        WrongValue{"newton.max_iterations=0", "newton.max_iterations: expected a whole number >= 1"},
        WrongValue{"solver.kind=magic", "solver.kind: expected \"auto\""},
        WrongValue{"solver.max_iterations=-1", "solver.max_iterations"},
        WrongValue{"output.every=0", "output.every: expected a whole number >= 1"},
        WrongValue{"output.fields=[\"stress\"]", "output.fields[0]"},
        WrongValue{"body.0.element=P3", "expected \"auto\", \"P1\", \"P2\""},
        WrongValue{"body.0.quadrature=\"5-point\"", "body[0].quadrature: expected \"1-point\""},
        WrongValue{"body.0.mesh={box={kind=\"prisms\",size=[1,1,1],cells=[1,1,1]}}",
                   "body[0].mesh.box.kind: expected \"tetrahedra\" or \"hexahedra\""},
        WrongValue{"body.0.scale=0", "body[0].scale: expected a number > 0"},
        WrongValue{"body.0.material.density=-1", "body[0].material.density: expected a number >= 0"},
        WrongValue{"body.0.mesh={box={size=[1,0,1],cells=[1,1,1]}}", "body[0].mesh.box.size"},
        WrongValue{"body.0.mesh={box={size=[1,1,1],cells=[1,1,0]}}", "body[0].mesh.box.cells[2]"},
        WrongValue{"body.0.mesh={box={size=[1,1],cells=[1,1]}}",
                   "expected 3 numbers since simulation.dimension is 3"},
        WrongValue{"body.0.mesh={box={size=[1,1,1],cells=[100000,100000,100000]}}", "use fewer cells"},
        WrongValue{"body.0.mesh=missing.msh", "body[0].mesh: "},
        WrongValue{"body.0.rotate=[0,0,0,90]", "body[0].rotate"},
        WrongValue{"body.0.rotate=[0,0,1]", "body[0].rotate: expected a list of 4"},
        WrongValue{"body.0.velocity_gradient=[[1,0],[0,1]]", "expected 3 rows of numbers"},
        WrongValue{"fix.0.components=xw", "fix[0].components: expected letters of \"xyz\""},
        WrongValue{"fix.0.components=xx", "fix[0].components: expected letters of \"xyz\", each once"},
        WrongValue{"fix.0.where={}", "fix[0].where"},
        WrongValue{"fix=[{}]", "give where = a table (docs/scene.md#where): Which vertices."},
        WrongValue{"fix.0.where={plane={axis=\"w\",at=0}}", "fix[0].where.plane.axis"},
        WrongValue{"fix.0.where={box=[[1,0,0],[0,1,1]]}", "min > max in x"},
        WrongValue{"fix.0.where={vertices=[-1]}", "fix[0].where.vertices[0]"},
        WrongValue{"fix.0.where={sphere={center=[0,0,0],radius=-1}}", "radius"},
        WrongValue{"load.0.stiffness=1", "load[0].stiffness: a traction has no such key"},
        WrongValue{"load.0.kind=spring", "load[0]: a spring needs the key \"stiffness\""},
        WrongValue{"load.0.value=3", "load[0].value: expected 3 numbers"},
        WrongValue{"probe.0.name=\"\"", "probe[0].name"},
        WrongValue{"simulation.integrator=newmarck", "did you mean \"newmark\"?"},
        WrongValue{"fix=[{name=\"a\",where=\"all\"},{name=\"a\",where=\"all\"}]",
                   "fix[1].name: expected a name of its own"},
        WrongValue{"body=[]", "there is no [[body]]"}, WrongValue{"body={mesh=\"a\"}", "headed [[body]]"}),
    numbered_name<WrongValue>);

INSTANTIATE_TEST_SUITE_P(
    Later, EveryWrongValue,
    ::testing::Values(
        WrongValue{"body.0.material.law=odgen", "did you mean \"ogden\"?"},
        WrongValue{"body.0.skin=absent.obj", "absent.obj: no such file"},
        WrongValue{"output.formats=[\"obj\"]", "output.formats[0]"},
        WrongValue{"contact.friction_iterations=-1",
                   "contact.friction_iterations: expected a whole number >= 0, got -1"},
        WrongValue{"contact.pair=[{}]", "contact.pair[0]: the key \"bodies\" is missing"},
        WrongValue{"contact.pair=[{bodies=[\"a\"]}]", "contact.pair[0].bodies"},
        WrongValue{"contact.activation_distance=0", "contact.activation_distance: expected a number > 0"},
        WrongValue{"contact.friction=-0.1", "contact.friction: expected a number >= 0, got -0.1"},
        WrongValue{"collider=[{}]", "collider[0]: the key \"kind\" is missing"},
        WrongValue{"collider=[{kind=\"cube\"}]", "\"cylinder\" or \"mesh\", got \"cube\""},
        WrongValue{"collider=[{kind=\"box\",center=[0,0,9],size=[1,0,1]}]",
                   "collider[0].size: expected lengths > 0, got 0"},
        WrongValue{"collider=[{kind=\"mesh\",mesh=\"absent.obj\"}]", "absent.obj: no such file"},
        WrongValue{"collider=[{kind=\"capsule\",start=[0,0,9],end=[0,0,9],radius=1}]",
                   "collider[0].end: expected another place than start"},
        WrongValue{"collider=[{kind=\"sphere\",center=[0,0,9],radius=1,start=[0,0,0]}]",
                   "collider[0].start: is a key of a capsule or a cylinder, not of a sphere"},
        WrongValue{"collider=[{kind=\"sphere\",center=[0,0,9],radius=1,rotate={axis=[0,0,0]}}]",
                   "collider[0].rotate.axis: expected a direction"},
        WrongValue{"collider=[{kind=\"sphere\",center=[0,0,9],radius=1,time_function={ramp={until=1}}}]",
                   "collider[0].time_function: is a factor on displacement"},
        WrongValue{"collider=[{kind=\"half_space\"}]", "collider[0]: a half_space needs the key \"point\""},
        WrongValue{"collider=[{kind=\"half_space\",point=[0,0,0],normal=[0,0,0]}]",
                   "collider[0].normal: expected a direction other than zero"},
        WrongValue{"collider=[{kind=\"sphere\",center=[0,0,0],radius=0}]", "collider[0].radius"},
        WrongValue{"collider=[{kind=\"sphere\",center=[0,0,9],radius=1,point=[0,0,0]}]",
                   "collider[0].point: is a key of a half_space, not of a sphere"},
        WrongValue{"collider=[{kind=\"sphere\",center=[0,0,9],radius=1,friction=-0.3}]",
                   "collider[0].friction: expected a number >= 0, got -0.3"},
        WrongValue{"collider=[{kind=\"sphere\",center=[0,0,9],radius=1,name=\"wall\"}]",
                   "collider[0].name: expected a name of its own, got \"wall\""}),
    numbered_name<WrongValue>);

TEST(SceneFile, ReadsHowBodiesMeet) {
  const Scene scene = read_text(R"([contact]
self = true
activation_distance = 0.01
stiffness = 1e4
[[contact.pair]]
bodies = ["a", "b"]
enabled = false
[[body]]
name = "a"
mesh = { box = { size = [1, 1, 1], cells = [1, 1, 1] } }
)");
  const ContactDescription& contact = scene.description.contact;
  EXPECT_TRUE(contact.is_enabled);
  EXPECT_TRUE(contact.with_themselves);
  EXPECT_EQ(contact.activation_distance, 0.01);
  EXPECT_EQ(contact.stiffness, 1e4);
  ASSERT_EQ(contact.pairs.size(), 1U);
  EXPECT_EQ(contact.pairs[0].bodies, (std::array<std::string, 2>{"a", "b"}));
  EXPECT_FALSE(contact.pairs[0].is_enabled);
}

TEST(SceneFile, TakesTwoNumbersInTwoDimensions) {
  const Scene scene = read_text(R"([simulation]
dimension = 2
gravity = [0, -9.81]
[[body]]
mesh = { box = { size = [2, 1], cells = [4, 2] } }
rotate = [90]
[[fix]]
where = { plane = { axis = "y", at = 0 } }
components = "y"
)");
  EXPECT_EQ(scene.description.gravity, Vector3(0, -9.81, 0));
  EXPECT_EQ(scene.description.bodies[0].mesh.find_block(CellKind::triangle)->num_cells(), 16);
  EXPECT_EQ(scene.description.bodies[0].rotate->degrees, 90);
  EXPECT_EQ(scene.description.bodies[0].rotate->axis, Vector3(Vector3::UnitZ()));
  EXPECT_THAT(error_with({"simulation.dimension=2"}), HasSubstr("since simulation.dimension is 2, got 3"));
}

TEST(SceneFile, ReadsRegionsOfABody) {
  const std::string regions =
      "body.0.region=[{name=\"core\", where={box=[[1,0,0],[2,1,1]]}, material={law=\"gent\", density=2000}},"
      "{where={group=\"body\"}, material={youngs_modulus=2e6}}]";
  const std::vector<RegionDescription> read =
      read_good_scene_with({regions, "body.beam.region.core.material.youngs_modulus=3e6"})
          .description.bodies[0]
          .regions;
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].name, "core");
  EXPECT_EQ(read[0].where.kind, Where::Kind::box);
  EXPECT_EQ(read[0].material.law, "gent");
  EXPECT_EQ(read[0].material.density, 2000);
  EXPECT_EQ(read[0].material.constants.at("youngs_modulus"), 3e6);
  EXPECT_EQ(read[1].name, "2");
  EXPECT_EQ(read[1].where.group, "body");

  EXPECT_THAT(error_with({"body.0.region={name=\"core\"}"}),
              HasSubstr("a list of tables, each headed [[body.region]]"));
  EXPECT_THAT(error_with({"body.0.region=[{name=\"core\", material={}}]"}), HasSubstr("where"));
  EXPECT_THAT(error_with({"body.0.region=[{where=\"all\"}]"}), HasSubstr("material"));
  EXPECT_THAT(error_with({"body.0.region=[{where=\"all\", material={}, law=\"gent\"}]"}), HasSubstr("law"));
}

TEST(SceneFile, ReadsASkinByItsNameOrAsATable) {
  const std::string file = (source_folder() / "tests/scene/scenes/beside/skin.obj").string();
  const auto skin_of = [](const std::string& value) {
    return *read_good_scene_with({"body.0.skin=" + value}).description.bodies[0].skin;
  };
  EXPECT_EQ(skin_of("\"" + file + "\"").surface.find_block(CellKind::triangle)->num_cells(), 4);
  EXPECT_FALSE(skin_of("\"" + file + "\"").is_smooth);
  EXPECT_TRUE(skin_of("{surface=\"" + file + "\",smooth=true}").is_smooth);
}

TEST(SceneFile, RefusesASkinWithoutTrianglesByName) {
  const std::string file = (source_folder() / "tests/scene/scenes/beside/tetrahedron.msh").string();
  EXPECT_THAT(error_with({"body.0.skin=\"" + file + "\""}),
              AllOf(HasSubstr("body[0].skin: expected triangles in"), HasSubstr("tetrahedron.msh, got none"),
                    HasSubstr("--surface")));
  EXPECT_THAT(error_with({"body.0.skin={smooth=true}"}), HasSubstr("surface"));
  EXPECT_THAT(error_with({"body.0.skin={surface=\"a.obj\",smoth=true}"}),
              HasSubstr("did you mean \"smooth\"?"));
}

TEST(SceneFile, ReadsSpringsAndMotion) {
  const Scene scene = read_good_scene_with(
      {"simulation.kind=dynamic",
       "load=[{kind=\"spring\",where=\"all\",stiffness=10,velocity=[1,0,0],from=0.5,until=2}]"});
  const LoadDescription& spring = scene.description.loads[0];
  EXPECT_EQ(spring.kind, "spring");
  EXPECT_EQ(spring.stiffness, 10);
  EXPECT_EQ(spring.velocity, Vector3(1, 0, 0));
  EXPECT_EQ(spring.from, 0.5);
  EXPECT_EQ(spring.until, 2.0);
}

TEST(SceneFile, ReadsPressureAsANumber) {
  EXPECT_EQ(read_good_scene_with({"load.0.kind=pressure", "load.0.value=20"}).description.loads[0].pressure,
            20);
}

/// docs/scene.md gives both small-strain constants a default; the formula's own constants have none beside
/// them.
TEST(SceneFile, GivesTheSmallStrainSolidItsDefaults) {
  const TemporaryFolder folder;
  const auto constants_of_text = [&](const std::string& material) {
    const std::filesystem::path path = folder.write(
        "scene.toml", "[[body]]\nmesh = { box = { size = [1, 1, 1], cells = [1, 1, 1] } }\nmaterial = { " +
                          material + " }\n");
    return read_scene(path).description.bodies[0].material.constants;
  };
  using Constants = std::map<std::string, double>;
  EXPECT_EQ(constants_of_text("youngs_modulus = 2e5"),
            (Constants{{"youngs_modulus", 2e5}, {"poissons_ratio", 0.4}}));
  EXPECT_EQ(constants_of_text("poissons_ratio = 0.3"),
            (Constants{{"youngs_modulus", 1e5}, {"poissons_ratio", 0.3}}));
  EXPECT_EQ(constants_of_text("law = \"neo_hookean\", shear_modulus = 1e4, lame_lambda = 2e4"),
            (Constants{{"shear_modulus", 1e4}, {"lame_lambda", 2e4}}));
}

TEST(SceneFile, ReadsTablesOfVerticesAndCellsBesideTheScene) {
  const TemporaryFolder folder;
  folder.write("velocities.csv", "vx, vy, vz\n1,2,3\n4,5,6\n7,8,9\n-1,0,1e-3\n0,0,0\n0,0,0\n0,0,0\n0,0,0\n");
  folder.write("young.csv", "# one per cell\n1e6\n2e6\n3e6\n4e6\n5e6\n6e6\n");
  const std::filesystem::path path = folder.write("scene.toml", R"([[body]]
mesh = { box = { size = [1, 1, 1], cells = [1, 1, 1] } }
material = { youngs_modulus = { file = "young.csv" }, poissons_ratio = 0.3 }
initial_velocities = "velocities.csv"
)");
  const BodyDescription body = read_scene(path).description.bodies[0];
  ASSERT_EQ(body.initial_velocities.size(), 24u);
  EXPECT_EQ(body.initial_velocities[11], 1e-3);
  EXPECT_EQ(body.material.cell_constants.at("youngs_modulus"),
            (std::vector<double>{1e6, 2e6, 3e6, 4e6, 5e6, 6e6}));
  EXPECT_EQ(body.material.constants.count("youngs_modulus"), 0u);

  const std::string message =
      input_error([&] { read_scene(path, {.overrides = {"body.0.initial_velocities=young.csv"}}); });
  EXPECT_THAT(
      message,
      HasSubstr("expected 8 rows of 3 numbers (one row for each vertex of the mesh), got 6 rows of 1"));
}

TEST(SceneFile, IsReadFromAFileThatIsThere) {
  EXPECT_THAT(input_error([] { read_scene("nowhere/scene.toml"); }), HasSubstr("nowhere/scene.toml"));
}

TEST(SceneReference, IsThePageInTheDocumentation) {
  std::ifstream file(source_folder() / "docs" / "scene.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  EXPECT_EQ(page, scene_reference()) << "run: resilin info --scene-reference > docs/scene.md";
}

}  // namespace
}  // namespace resilin::testing
