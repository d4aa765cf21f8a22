// A checkpoint knows its scene: --resume goes on in that one, and in another only when that is meant.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;
using Words = std::vector<std::string>;

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// A change of the scene and what is named when a run would go on in it.
struct Edit {
  std::string name;
  Words settings;
  std::string named;
  bool keeps_unknowns = true;
};

const std::vector<Edit> edits = {
    {"stiffness",
     {"body.box.material.youngs_modulus=2e6"},
     "body.box.material.youngs_modulus is 1e+06, not 2e+06"},
    {"poissons_ratio", {"body.box.material.poissons_ratio=0.31"}, "body.box.material.poissons_ratio"},
    {"density", {"body.box.material.density=1001"}, "body.box.material.density is 1000, not 1001"},
    {"law", {"body.box.material.law=stable_neo_hookean"}, "body.box.material.law"},
    {"gravity", {"simulation.gravity=[0,0,-9.8]"}, "simulation.gravity is [0, 0, -9.81], not [0, 0, -9.8]"},
    {"size", {"body.box.mesh.box.size=[2,1,1.01]"}, "body.box.mesh is 45 vertices"},
    {"cells", {"body.box.mesh.box.cells=[3,2,2]"}, "body.box.mesh is 45 vertices", false},
    {"place", {"body.box.translate=[0,0,1e-9]"}, "body.box.translate"},
    {"element", {"body.box.element=P2"}, "body.box.element", false},
    {"support",
     {"fix.wall.where={group=\"x_max\"}"},
     "fix.wall.where is group \"x_min\", not group \"x_max\""},
    {"displacement", {"fix.wall.displacement=[0.01,0,0]"}, "fix.wall.displacement"},
    {"no_support",
     {"fix=[]", "load=[{kind=\"spring\",where=\"all\",stiffness=100}]"},
     "fix is \"wall\", not none"},
    {"load",
     {"load=[{kind=\"traction\",where={group=\"x_max\"},value=[0,0,1]}]"},
     "load is none, not \"load[0]\""},
    {"tolerance", {"newton.tolerance=1e-7"}, "newton.tolerance is 1e-08, not 1e-07"},
    {"solver", {"solver.kind=ldlt"}, "solver.kind"},
};

const std::vector<Edit> edits_of_motion = {
    {"time_step", {"simulation.time_step=0.02"}, "simulation.time_step is 0.01, not 0.02"},
    {"integrator", {"simulation.integrator=bdf2"}, "simulation.integrator"},
    {"velocity", {"body.box.velocity=[0,0,1]"}, "body.box.velocity"},
    {"mass", {"body.box.mass=consistent"}, "body.box.mass"},
    {"damping", {"body.box.damping.mass=0.1"}, "body.box.damping.mass"},
    {"adaptive", {"simulation.adaptive={}"}, "simulation.adaptive is false, not true"},
};

Words run(const std::string& kind, const Words& settings, const Words& more = {}) {
  Words words = {"run", "box.toml", "--quiet", "--out", "out", "--set", "simulation.kind=" + kind};
  if (kind == "dynamic") words = words + Words{"--set", "simulation.end_time=0.06"};
  if (kind == "static") words = words + Words{"--set", "simulation.load_steps=4"};
  for (const std::string& setting : settings) words = words + Words{"--set", setting};
  return words + more;
}

struct ResumeCommand : ::testing::TestWithParam<std::string> {
  TemporaryFolder folder;
  ResumeCommand() { folder.write("box.toml", box_scene); }
  std::string files() const {
    return folder.read("out/report.json") + folder.read("out/checkpoint.bin") +
           folder.read("out/frames.pvd") + folder.read("out/frames/0002.vtu") +
           folder.read("out/result.html");
  }
  ProgramResult go(const Words& words) const { return run_program(folder.path(), words); }
};

void expect_one_line(const std::string& text) { EXPECT_EQ(text.find('\n'), text.size() - 1) << text; }

TEST_P(ResumeCommand, InAnotherSceneIsRefusedWithTheFirstDifference) {
  std::vector<Edit> all = edits;
  if (GetParam() == "dynamic") all.insert(all.end(), edits_of_motion.begin(), edits_of_motion.end());
  ASSERT_EQ(go(run(GetParam(), {}, {"--steps", "2"})).exit_code, 2);
  const std::string before = files();
  for (const Edit& edit : all) {
    SCOPED_TRACE(edit.name);
    const ProgramResult refused = go(run(GetParam(), edit.settings, {"--resume"}));
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err, HasSubstr("out/checkpoint.bin: expected a checkpoint of this scene"));
    EXPECT_THAT(refused.err, HasSubstr(edit.named));
    EXPECT_THAT(refused.err, HasSubstr("--resume=anyway"));
    expect_one_line(refused.err);
    EXPECT_EQ(files(), before);
  }
}

TEST_P(ResumeCommand, AnywayGoesOnInAnotherScene) {
  std::vector<Edit> all = edits;
  if (GetParam() == "dynamic") all.insert(all.end(), edits_of_motion.begin(), edits_of_motion.end());
  for (const Edit& edit : all) {
    SCOPED_TRACE(edit.name);
    ASSERT_EQ(go(run(GetParam(), {}, {"--steps", "2"})).exit_code, 2);
    const ProgramResult anyway = go(run(GetParam(), edit.settings, {"--resume=anyway"}));
    if (!edit.keeps_unknowns) {
      EXPECT_EQ(anyway.exit_code, 1);
      EXPECT_THAT(anyway.err, HasSubstr("of another mesh"));
      expect_one_line(anyway.err);
      continue;
    }
    EXPECT_EQ(anyway.exit_code, 0) << anyway.err;
    EXPECT_THAT(folder.read("out/log.txt"),
                HasSubstr("checkpoint of another scene, used anyway: " + edit.named));
    const nlohmann::json report = read_json(folder / "out/report.json");
    EXPECT_GT(report["frames"].size(), 3u);
    EXPECT_GT(report["frames"].back()["step"], 2);
    if (GetParam() == "dynamic") {
      EXPECT_NEAR(report["frames"].back()["time"].get<double>(), 0.06, 0.01 + 1e-12);
    }
    // The checkpoint is of the changed scene from now on.
    EXPECT_EQ(go(run(GetParam(), edit.settings, {"--resume"})).exit_code, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, ResumeCommand, ::testing::Values("static", "dynamic"),
                         [](const auto& instance) { return instance.param; });

TEST_F(ResumeCommand, NeverTurnsOneKindIntoAnother) {
  for (const std::string kind : {"static", "dynamic", "modes"}) {
    ASSERT_NE(go(run(kind, {}, {"--steps", "1"})).exit_code, 1);
    for (const std::string other : {"static", "dynamic", "modes"}) {
      if (other == kind) continue;
      for (const std::string resume : {"--resume", "--resume=anyway"}) {
        const ProgramResult result = go(run(other, {}, {resume}));
        EXPECT_EQ(result.exit_code, 1);
        EXPECT_THAT(result.err, HasSubstr("simulation.kind \"" + other + "\", got \"" + kind + "\""));
        expect_one_line(result.err);
      }
    }
    std::filesystem::remove_all(folder / "out");
  }
}

TEST_F(ResumeCommand, GoesOnWhereOnlyWhatIsWatchedOrWrittenHasChanged) {
  for (const std::string setting :
       {"title=other", "output.every=2", "output.formats=[\"vtu\"]", "probe.tip.at=[0,0,0]",
        "simulation.end_time=0.08", "output.fields=[\"von_mises\"]"}) {
    ASSERT_EQ(go(run("dynamic", {}, {"--steps", "2"})).exit_code, 2);
    const ProgramResult result = go(run("dynamic", {setting}, {"--resume"}));
    EXPECT_EQ(result.exit_code, 0) << setting << result.err;
  }
}

TEST_F(ResumeCommand, OfAFinishedRunSaysSo) {
  for (const std::string kind : {"static", "dynamic", "modes"}) {
    Words words = run(kind, {});
    std::erase(words, "--quiet");
    ASSERT_EQ(go(words).exit_code, 0);
    const nlohmann::json before = read_json(folder / "out/report.json");
    const ProgramResult again = go(words + Words{"--resume"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_THAT(again.out, HasSubstr("the run had ended before"));
    EXPECT_EQ(read_json(folder / "out/report.json")["frames"], before["frames"]);
    std::filesystem::remove_all(folder / "out");
  }
}

TEST_F(ResumeCommand, KeepsTheVerdictOnStepsThatHadFailed) {
  const Words hasty = {"newton.max_iterations=1", "body.box.velocity=[0,0,5]"};
  const ProgramResult stopped = go(run("dynamic", hasty, {"--steps", "3"}));
  ASSERT_EQ(stopped.exit_code, 2);
  const ProgramResult rest = go(run("dynamic", hasty, {"--resume"}));
  EXPECT_EQ(rest.exit_code, 2);
  const std::string reason = read_json(folder / "out/report.json")["reason"];
  std::filesystem::remove_all(folder / "out");
  const ProgramResult whole = go(run("dynamic", hasty));
  EXPECT_EQ(whole.exit_code, 2);
  EXPECT_EQ(reason, read_json(folder / "out/report.json")["reason"]);
  EXPECT_THAT(reason, HasSubstr("did not converge; the first at t = 0.01 s (step 1)"));
}

TEST_F(ResumeCommand, FromWhatIsNoCheckpointOrReportIsRefusedInOneLine) {
  ASSERT_EQ(go(run("dynamic", {}, {"--steps", "2"})).exit_code, 2);
  const std::string report = folder.read("out/report.json"), checkpoint = folder.read("out/checkpoint.bin");
  for (const std::string name : {"report.json", "checkpoint.bin"}) {
    for (const std::string content :
         {"", "{}", "[[[", "{\"frames\": [{\"step\": \"zero\"}]}", "resilin state 5\n"}) {
      folder.write("out/report.json", report);
      folder.write("out/checkpoint.bin", checkpoint);
      folder.write("out/" + name, content);
      const ProgramResult result = go(run("dynamic", {}, {"--resume"}));
      EXPECT_EQ(result.exit_code, 1) << name << content;
      EXPECT_THAT(result.err, HasSubstr("out/" + name + ": expected"));
      expect_one_line(result.err);
    }
  }
  folder.write("out/report.json", "{\"frames\": [[]]}");
  const ProgramResult viewed = go({"view", "out", "--no-browser"});
  EXPECT_EQ(viewed.exit_code, 1);
  EXPECT_THAT(viewed.err, HasSubstr("report.json: expected the report of a run, got frames[0]"));
}

TEST_F(ResumeCommand, TakesAWordOnlyBehindAnEqualsSign) {
  ASSERT_EQ(go(run("static", {}, {"--steps", "1"})).exit_code, 2);
  EXPECT_EQ(go({"run", "--quiet", "--out", "out", "--set", "simulation.load_steps=4", "--resume", "box.toml"})
                .exit_code,
            0);
  const ProgramResult wrong = go(run("static", {}, {"--resume=always"}));
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("--resume"));
  expect_one_line(wrong.err);
}

}  // namespace
}  // namespace resilin::testing
