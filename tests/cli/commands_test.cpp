#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "program.hpp"
#include "shared_data.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Commands : ::testing::Test {
  TemporaryFolder folder;
  ProgramResult run(const std::vector<std::string>& arguments) {
    return run_program(folder.path(), arguments);
  }
};

TEST_F(Commands, ThatDoNotExistAreRefusedInOneLine) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"rum"},
                                             {"run"},
                                             {"run", "a.toml", "b.toml"},
                                             {"run", "a.toml", "--threads", "0"},
                                             {"run", "a.toml", "--threads", "-1"},
                                             {"run", "a.toml", "--threads", "1000000"},
                                             {"run", "a.toml", "--threads", "abc"},
                                             {"run", "a.toml", "--threads", "1.5"},
                                             {"run", "a.toml", "--threads", ""},
                                             {"bench", "cube", "--threads", "0"},
                                             {"bench", "cube", "--threads", "abc"},
                                             {"run", "a.toml", "--what"},
                                             {"view", "a.toml"},
                                             {"mesh", "a.msh"},
                                             {"materials", "rubber"},
                                             {"fit"},
                                             {"fit", "none.toml"},
                                             {"bench", "nothing"},
                                             {"--what"}}) {
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_THAT(result.err, StartsWith("resilin: "));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
  }
  EXPECT_THAT(run({"rum"}).err, HasSubstr("did you mean \"run\"?"));
  EXPECT_THAT(run({"beam.toml"}).err, HasSubstr("did you mean \"resilin run beam.toml\"?"));
  EXPECT_THAT(run({"part.STL"}).err, HasSubstr("did you mean \"resilin view part.STL\"?"));
}

TEST_F(Commands, ExplainThemselvesWithAnExample) {
  EXPECT_EQ(run({"--help"}).exit_code, 0);
  for (const std::string command : {"run", "view", "check", "gradcheck", "rest-shape", "mesh", "materials",
                                    "fit", "plot", "revolve", "info", "doctor", "completion"}) {
    const ProgramResult result = run({command, "--help"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.out, HasSubstr("Example"));
    EXPECT_THAT(result.out, HasSubstr("resilin " + command));
  }
}

TEST_F(Commands, CheckTellsAboutAScene) {
  folder.write("box.toml", box_scene);
  const ProgramResult good = run({"check", "box.toml"});
  EXPECT_EQ(good.exit_code, 0) << good.err;
  EXPECT_THAT(good.out, HasSubstr("no errors, 0 warnings"));
  EXPECT_THAT(good.out, HasSubstr("108 DOFs"));
  const ProgramResult soft = run({"check", "box.toml", "--set", "body.0.material.youngs_modulus=1"});
  EXPECT_EQ(soft.exit_code, 0);
  EXPECT_THAT(soft.err, HasSubstr("is youngs_modulus in Pa"));
  EXPECT_THAT(soft.out, HasSubstr("no errors, 1 warning\n"));
}

TEST_F(Commands, CheckTellsBoxesInTheFrameOfSelections) {
  folder.write("box.toml", box_scene);
  const ProgramResult moved =
      run({"check", "box.toml", "--set", "body.0.scale=2", "--set", "body.0.translate=[10,0,0]"});
  EXPECT_EQ(moved.exit_code, 0) << moved.err;
  EXPECT_THAT(moved.out, ContainsRegex("box of `where` +\\(10, 0, 0\\) to \\(14, 2, 2\\) m"));
}

TEST_F(Commands, CheckTellsWhatLoadsAmountTo) {
  folder.write("box.toml", box_scene +
                               "[[load]]\nname = \"push\"\nkind = \"force\"\nwhere = { group = \"x_max\" }\n"
                               "value = [0, 0, -50]\n");
  EXPECT_THAT(run({"check", "box.toml"}).out,
              ContainsRegex("load push: force on [0-9]+ facets \\([0-9]+ nodes, 1 m\\^2\\) about \\(2, 0.5, "
                            "0.5\\) m: force \\(0, 0, -50\\) N"));
}

TEST_F(Commands, CheckAsksForTheUnitOfALongMesh) {
  folder.write("long.obj", "v 0 0 0\nv 60 0 0\nv 0 60 0\nv 0 0 60\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  EXPECT_THAT(run({"check", "long.obj"}).out, HasSubstr("m (millimetres? scale = 0.001 in the scene)"));
}

TEST_F(Commands, GradcheckPutsDerivativesBesideDifferences) {
  folder.write("box.toml", box_scene);
  const ProgramResult all = run({"gradcheck", "box.toml"});
  EXPECT_EQ(all.exit_code, 0) << all.out << all.err;
  EXPECT_THAT(all.out, HasSubstr("material.youngs_modulus"));
  EXPECT_THAT(all.out, HasSubstr("all derivatives agree"));
  // Hardly any weight beside what a support presses: nothing is contradicted.
  const ProgramResult unseen =
      run({"gradcheck", "box.toml", "--set", "simulation.gravity=[0, 0, -1e-12]", "--set",
           "fix.0.gradient=[[0.01, 0, 0], [0, 0.01, 0], [0, 0, 0]]", "--wrt", "body.box.density"});
  EXPECT_EQ(unseen.exit_code, 0) << unseen.out << unseen.err;
  EXPECT_THAT(unseen.out, HasSubstr("body.box.density: finite differences have no digits here"));
  EXPECT_THAT(unseen.out, Not(HasSubstr("derivatives agree")));
  const ProgramResult unknown = run({"gradcheck", "box.toml", "--wrt", "simulation.gravitation"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("simulation.gravity"));
}

TEST_F(Commands, CheckTellsAboutAMesh) {
  const std::string meshes = source_folder() / "tests/data/bad_inputs";
  const ProgramResult inverted = run({"check", meshes + "/tet_inverted.msh"});
  EXPECT_THAT(inverted.err, HasSubstr("element 2"));
  const ProgramResult nan = run({"check", meshes + "/coord_nan.msh"});
  EXPECT_EQ(nan.exit_code, 1);
  EXPECT_THAT(nan.err, HasSubstr("coord_nan.msh"));
}

TEST_F(Commands, TheFirstLineAboutABrokenFileIsTheError) {
  int num_broken = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() / "tests/data/bad_inputs")) {
    const ProgramResult checked = run({"check", entry.path().string()});
    if (checked.exit_code == 0) continue;
    ++num_broken;
    EXPECT_EQ(checked.exit_code, 1) << entry.path();
    EXPECT_THAT(checked.err, StartsWith("resilin: ")) << entry.path();
    EXPECT_EQ(checked.out, "") << entry.path();
    const ProgramResult converted = run({"mesh", entry.path().string(), "out.msh"});
    if (converted.exit_code == 0) continue;
    EXPECT_THAT(converted.err, StartsWith("resilin: ")) << entry.path();
  }
  EXPECT_GT(num_broken, 10);
}

TEST_F(Commands, NamesThatATerminalWouldObeyAreShownEscaped) {
  // A group, a body and a title with the commands to clear the screen and to ring.
  ASSERT_EQ(run({"mesh", "box.msh", "--box", "1", "1", "1", "--cells", "1", "1", "1"}).exit_code, 0);
  std::string mesh = read_text_file(folder / "box.msh");
  const std::size_t at = mesh.find("x_min");
  ASSERT_NE(at, std::string::npos);
  folder.write("bell.msh", mesh.replace(at, 5, "\x1b[2J\x07"));
  const std::string scene = "title = \"\\u001b[2J\"\n[[body]]\nname = \"a\\u0007\"\nmesh = \"bell.msh\"\n";
  folder.write("good.toml", scene + "[[fix]]\nwhere = { group = \"\\u001b[2J\\u0007\" }\n");
  folder.write("bad.toml", scene + "[[fix]]\nwhere = { group = \"x_min\" }\n");
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"check", "bell.msh"},
                                             {"check", "good.toml"},
                                             {"run", "good.toml"},
                                             {"check", "bad.toml"},
                                             {"run", "bad.toml"}}) {
    const ProgramResult result = run(arguments);
    const std::string all = result.out + result.err;
    EXPECT_TRUE(std::ranges::none_of(all, [](char c) {
      return (c >= 0 && c < 0x20 && c != '\n') || c == 0x7f;
    })) << all;
    EXPECT_THAT(all, HasSubstr("\\x1b[2J")) << arguments[0] << " " << arguments[1];
  }
}

TEST_F(Commands, MeshMakesConvertsAndSkinsABox) {
  ASSERT_EQ(run({"mesh", "box.msh", "--box", "2", "1", "1", "--cells", "4", "2", "2"}).exit_code, 0);
  const ProgramResult converted = run({"mesh", "box.msh", "box.vtu"});
  EXPECT_EQ(converted.exit_code, 0) << converted.err;
  EXPECT_THAT(converted.out, HasSubstr("45 vertices"));
  EXPECT_THAT(converted.out, HasSubstr("96 tetrahedra"));
  const ProgramResult surface = run({"mesh", "box.msh", "box.obj", "--surface"});
  EXPECT_EQ(surface.exit_code, 0) << surface.err;
  EXPECT_THAT(surface.out, HasSubstr("80 triangles"));  // 2 (4*2 + 4*2 + 2*2) squares
  EXPECT_EQ(run({"mesh", "square.msh", "--box", "1", "1", "--cells", "3", "3"}).exit_code, 0);
  EXPECT_EQ(run({"mesh", "box.msh", "--box", "2", "1", "0", "--cells", "4", "2", "2"}).exit_code, 1);
  EXPECT_EQ(run({"mesh", "box.msh", "--box", "2", "1", "1", "--cells", "4", "2"}).exit_code, 1);
  EXPECT_EQ(run({"mesh", "box.msh", "box.xyz"}).exit_code, 1);
}

TEST_F(Commands, MaterialsTellsConstantsFormulaAndCurves) {
  const nlohmann::json all = nlohmann::json::parse(run({"materials", "--json"}).out);
  EXPECT_GE(all.size(), 8u);
  for (const nlohmann::json& law : all) {
    EXPECT_FALSE(law["formula"].get<std::string>().empty());
    EXPECT_FALSE(law["source"].get<std::string>().empty());
    for (const nlohmann::json& point : law["curve"]) {
      if (point["stretch"] == 1.0) {
        EXPECT_EQ(point["shear_stress"], 0.0) << law["name"];
      }
    }
  }
  // Near rest every law is the same small-strain solid: 10 % pull is E * 0.1 up to its curvature.
  const ProgramResult one = run({"materials", "linear_elastic"});
  EXPECT_EQ(one.exit_code, 0);
  EXPECT_THAT(one.out, HasSubstr("lame_lambda"));
  EXPECT_THAT(one.out, HasSubstr("1e+05"));
}

TEST_F(Commands, MaterialsListsTheLibraryWithSources) {
  const nlohmann::json all = nlohmann::json::parse(run({"materials", "--library", "--json"}).out);
  EXPECT_GE(all.size(), 6u);
  for (const nlohmann::json& material : all)
    for (const char* key : {"name", "law", "range", "source"})
      EXPECT_FALSE(material[key].get<std::string>().empty()) << key;
  const ProgramResult list = run({"materials", "--library"});
  EXPECT_EQ(list.exit_code, 0) << list.err;
  for (const char* part : {"natural_rubber_yeoh: ", "Treloar 1944", "material = { library = "})
    EXPECT_THAT(list.out, HasSubstr(part));
  EXPECT_EQ(run({"materials", "yeoh", "--library"}).exit_code, 1);
}

TEST_F(Commands, InfoTellsHowItWasBuilt) {
  const nlohmann::json info = nlohmann::json::parse(run({"info", "--json"}).out);
  for (const char* key : {"version", "compiler", "instruction_set", "blas_kernel", "solvers", "threads"}) {
    EXPECT_TRUE(info.contains(key)) << key;
  }
  EXPECT_THAT(run({"info", "--scene-reference"}).out, StartsWith("# The scene file"));
}

/// Name that OpenBLAS has for its kernels of an instruction set of ours.
std::string openblas_core(const std::string& set) {
  return set == "avx512" ? "SkylakeX" : set == "avx2" ? "Haswell" : "Prescott";
}

TEST_F(Commands, ResilinIsaChoosesTheKernelsOfElementsAndOfBlas) {
  const nlohmann::json best = nlohmann::json::parse(run({"info", "--json"}).out);
  for (const std::string set : best["instruction_sets"]) {
    const nlohmann::json info =
        nlohmann::json::parse(run_program(folder.path(), {"info", "--json"}, {"RESILIN_ISA=" + set}).out);
    EXPECT_EQ(info["instruction_set"], set);
    const std::string blas = info["blas_kernel"];
    if (!blas.starts_with("OpenBLAS")) continue;
    EXPECT_THAT(blas, EndsWith(openblas_core(set)));
  }
}

TEST_F(Commands, TheVariableOfOpenblasStandsWhereOursSaysNothing) {
  const auto info_with = [&](const std::vector<std::string>& environment) {
    return nlohmann::json::parse(run_program(folder.path(), {"info", "--json"}, environment).out);
  };
  const nlohmann::json info = info_with({});
  if (!info["blas_kernel"].get<std::string>().starts_with("OpenBLAS"))
    GTEST_SKIP() << "the BLAS of this machine is not OpenBLAS";
  const std::string set = info["instruction_sets"][0], theirs = "OPENBLAS_CORETYPE=Nehalem";
  EXPECT_THAT(info_with({theirs})["blas_kernel"].get<std::string>(), EndsWith("Nehalem"));
  EXPECT_THAT(info_with({theirs, "RESILIN_ISA=" + set})["blas_kernel"].get<std::string>(),
              EndsWith(openblas_core(set)));
}

TEST_F(Commands, AnInstructionSetThatIsNotThereIsOneLine) {
  const ProgramResult result = run_program(folder.path(), {"info"}, {"RESILIN_ISA=avx1024"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, AllOf(StartsWith("resilin: environment variable RESILIN_ISA: expected"),
                                HasSubstr("got \"avx1024\"")));
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1);
}

TEST_F(Commands, FitFindsConstantsAndWritesThem) {
  const std::string example = (source_folder() / "examples" / "fit_rubber.toml").string();
  const ProgramResult result = run({"fit", example, "--out", "fitted", "--laws", "yeoh,neo_hookean"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("law "), HasSubstr("yeoh"), HasSubstr("+-"), HasSubstr("fitted/fit.html")));
  EXPECT_THAT(folder.read("fitted/material.toml"), HasSubstr("material = { law = \"yeoh\""));
  EXPECT_EQ(read_json(folder / "fitted/fit.json")["laws"].size(), 2U);
  EXPECT_THAT(folder.read("fitted/fit.html"), HasSubstr("<svg"));
  const ProgramResult json =
      run({"fit", example, "--json", "--laws", "all", "--set", "fit.residual=relative"});
  EXPECT_EQ(json.exit_code, 0) << json.err;
  EXPECT_EQ(nlohmann::json::parse(json.out)["residual"], "relative");
  EXPECT_THAT(run({"fit", example, "--laws", "yeo"}).err, HasSubstr("did you mean \"yeoh\""));
}

TEST_F(Commands, FitFindsNumbersOfScenesAndTellsEachSolve) {
  const std::string example = (source_folder() / "examples" / "fit_bar.toml").string();
  const ProgramResult result = run({"fit", example, "--out", "fitted"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("solve 1: "), HasSubstr("E root"), HasSubstr("converged after 5"),
                                HasSubstr("fitted/fit.html, material.toml and fit.json")));
  EXPECT_EQ(read_json(folder / "fitted/fit.json")["parameters"].size(), 2U);
  EXPECT_THAT(folder.read("fitted/material.toml"), HasSubstr("bar_youngs_modulus.csv"));
  EXPECT_EQ(std::ranges::count(folder.read("fitted/bar_youngs_modulus.csv"), '\n'), 40);
  const ProgramResult json = run({"fit", example, "--json"});
  EXPECT_EQ(nlohmann::json::parse(json.out)["solves"], 5);
  EXPECT_EQ(run({"fit", example, "--quiet", "--set", "fit.max_solves=2"}).exit_code, 2);
  EXPECT_THAT(run({"run", example}).err, HasSubstr("this is a fit file"));
}

TEST_F(Commands, FitFindsThePronySeriesOfARelaxation) {
  folder.write("silicone.toml",
               "title = \"Silicone\"\n[relaxation]\ntime = [0.1, 0.5, 1, 2, 5, 10, 50, 100]\n"
               "modulus = [360, 311, 298, 287, 270, 255, 233, 225]\n");
  const ProgramResult result = run({"fit", "silicone.toml"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("8 times of the lists"), HasSubstr("relaxation time tau [s]"),
                                HasSubstr("out/silicone/fit.html, material.toml and fit.json")));
  const nlohmann::json json = read_json(folder / "out/silicone/fit.json");
  EXPECT_EQ(json["g"].size(), json["tau"].size());
  EXPECT_THAT(folder.read("out/silicone/fit.html"), HasSubstr("<svg"));
  EXPECT_THAT(folder.read("out/silicone/material.toml"), HasSubstr("\nviscoelastic = { g = ["));
  EXPECT_EQ(run({"fit", "silicone.toml", "--json", "--set", "relaxation.branches=9"}).exit_code, 1);
}

TEST_F(Commands, TakeTheNumberOfThreadsFromTheEnvironmentOrRefuseItInOneLine) {
  const auto info_with = [&](const std::string& threads) {
    return run_program(folder.path(), {"info", "--json"}, {"RESILIN_THREADS=" + threads});
  };
  for (const int threads : {1, 3})
    EXPECT_EQ(nlohmann::json::parse(info_with(std::to_string(threads)).out)["threads"], threads);
  EXPECT_EQ(info_with("").exit_code, 0) << "the same as none";
  for (const std::string wrong : {"0", "-1", "1000000", "99999999999999999999", "abc", "2x", "1.5", " 2"}) {
    const ProgramResult result = info_with(wrong);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(
        result.err,
        "resilin: environment variable RESILIN_THREADS: expected a whole number from 1 to 1024, got \"" +
            wrong + "\"; correct it or unset it\n");
  }
}

}  // namespace
}  // namespace resilin::testing
