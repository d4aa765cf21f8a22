// Whether two scenes are the same for a run that goes on: every key that steps depend on, one after the
// other.

#include "resilin/world/fingerprint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "resilin/io/atomic_file.hpp"
#include "resilin/scene/value.hpp"
#include "scene_text.hpp"

namespace resilin::testing {
namespace {

std::filesystem::path scenes() { return source_folder() / "tests" / "scene" / "scenes"; }

using Path = std::vector<std::string>;  ///< keys, and numbers of list entries

void collect_leaves(const SceneValue& value, const Path& path, std::vector<Path>& leaves) {
  if (value.is_table()) {
    for (const SceneMember& member : value.table()) {
      Path below = path;
      below.push_back(member.key);
      collect_leaves(member.value, below, leaves);
    }
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.array().size(); ++i) {
      Path below = path;
      below.push_back(std::to_string(i));
      collect_leaves(value.array()[i], below, leaves);
    }
  } else {
    leaves.push_back(path);
  }
}

SceneValue& at(SceneValue& root, const Path& path) {
  SceneValue* value = &root;
  for (const std::string& part : path)
    value = value->is_array() ? &value->array()[std::stoul(part)] : value->find(part);
  return *value;
}

/// Other values that a leaf may have.
std::vector<SceneValue> others(const SceneValue& leaf) {
  std::vector<SceneValue> list;
  const auto add = [&](auto data) {
    list.push_back(leaf);
    list.back().data = std::move(data);
  };
  if (const auto* flag = std::get_if<bool>(&leaf.data)) {
    add(!*flag);
  } else if (const auto* whole = std::get_if<std::int64_t>(&leaf.data)) {
    for (const std::int64_t change : {1, -1}) add(*whole + change);
    add(static_cast<double>(*whole) + 0.125);
  } else if (const auto* real = std::get_if<double>(&leaf.data)) {
    for (const double factor : {1.0000001, 0.9999}) add(*real * factor);
  } else {
    for (const char* word : {"newmark",  "neo_hookean_quadratic",
                             "gent",     "P2",
                             "Q1",       "4-point",
                             "lumped",   "none",
                             "points",   "cholesky",
                             "x_max",    "x",
                             "y",        "z",
                             "traction", "body_force",
                             "sphere",   "half_space",
                             "capsule",  "cylinder",
                             "chains",   "another",
                             "skin",     "boundary"})
      if (std::get<std::string>(leaf.data) != word) add(std::string(word));
  }
  return list;
}

/// Keys that no step sees: outputs, keys that this scene's kind does not use, and files, which others change.
bool is_seen_by_no_step(const Path& path) {
  static const std::set<std::string> tables = {"title", "probe", "section", "output"};
  static const std::set<std::string> keys = {"load_steps",     "load_control", "max_steps",
                                             "unstable_modes", "on_jump",      "max_failures"};
  return tables.contains(path[0]) || (path[0] == "fix" && path.back() == "stiffness") ||
         std::ranges::any_of(path, [](const std::string& key) { return keys.contains(key); });
}

bool is_file(const SceneValue& leaf) {
  const auto* text = std::get_if<std::string>(&leaf.data);
  return text != nullptr && text->starts_with("beside/");
}

Fingerprint fingerprint_of_values(const SceneValue& values) {
  return fingerprint_of(read_scene_from_values(values, "every_key", scenes()).description);
}

std::string text(const Path& path) {
  std::string all;
  for (const std::string& part : path) all += (all.empty() ? "" : ".") + part;
  return all;
}

TEST(Fingerprint, SeesEveryKeyThatAStepDependsOnAndNamesIt) {
  const std::filesystem::path file = scenes() / "every_key_3d.toml";
  const SceneValue scene = parse_toml(read_file(file), "every_key");
  const Fingerprint before = fingerprint_of_values(scene);
  std::vector<Path> leaves;
  collect_leaves(scene, {}, leaves);
  int seen = 0;
  for (const Path& path : leaves) {
    SceneValue changed = scene;
    SceneValue& leaf = at(changed, path);
    if (is_file(leaf)) continue;
    std::optional<FingerprintDifference> difference;
    bool could_change = false;
    const SceneValue kept = leaf;
    for (const SceneValue& other : others(kept)) {
      leaf = other;
      Fingerprint now;
      if (!input_error([&] { now = fingerprint_of_values(changed); }).empty()) continue;
      could_change = true;
      difference = first_difference(before, now);
      if (difference) break;
    }
    if (!could_change) continue;
    if (is_seen_by_no_step(path)) {
      EXPECT_FALSE(difference) << text(path) << ": " << difference->name;
      continue;
    }
    ASSERT_TRUE(difference) << text(path);
    ++seen;
    // Its name ends with one of the keys that lead to the value.
    const std::string last = difference->name.substr(difference->name.rfind('.') + 1);
    EXPECT_NE(std::ranges::find(path, last), path.end()) << text(path) << " is called " << difference->name;
  }
  EXPECT_GT(seen, 150);
}

TEST(Fingerprint, IsTheSameForTheSameSceneHoweverItIsWritten) {
  const Fingerprint once = fingerprint_of(read_text(good_scene).description);
  EXPECT_FALSE(first_difference(once, fingerprint_of(read_text(good_scene + "\n# a comment\n").description)));
  for (const char* same :
       {"body.beam.material.youngs_modulus=1000000", "title=another", "fix.wall.displacement=[0, 0, 0]",
        "output.every=3", "simulation.end_time=7", "body.beam.scale=1", "probe.tip.at=[0, 0, 0]"})
    EXPECT_FALSE(first_difference(once, fingerprint_of(read_good_scene_with({same}).description))) << same;
}

TEST(Fingerprint, TakesTheRuleThatAnElementHasAnywayForNone) {
  const World world(read_text(good_scene).description);
  const std::string own(world.bodies[0].domains.element().default_quadrature);
  const World named(read_good_scene_with({"body.beam.quadrature=\"" + own + "\""}).description);
  EXPECT_FALSE(first_difference(world.fingerprint, named.fingerprint)) << own;
}

TEST(Fingerprint, KnowsTheEndTimeWhereSomethingDependsOnIt) {
  for (const std::vector<std::string>& overrides :
       {std::vector<std::string>{"load.pull.time_function={ramp={until=1}}"},
        {"load.pull.until=0.5"},
        {"fix.wall.velocity=[0, 0, 0.1]"},
        {"simulation.kind=\"dynamic\"", "fix.wall.rotate=[0, 0, 1, 90]"}}) {
    std::vector<std::string> longer = overrides;
    longer.emplace_back("simulation.end_time=7");
    const auto difference = first_difference(fingerprint_of(read_good_scene_with(overrides).description),
                                             fingerprint_of(read_good_scene_with(longer).description));
    ASSERT_TRUE(difference) << overrides.back();
    EXPECT_EQ(describe(*difference), "simulation.end_time is 1, not 7 as in the scene");
  }
}

TEST(Fingerprint, NamesWhatIsNewAndWhatIsGone) {
  const Fingerprint once = fingerprint_of(read_text(good_scene).description);
  const auto difference_with = [&](const std::vector<std::string>& overrides) {
    return describe(*first_difference(once, fingerprint_of(read_good_scene_with(overrides).description)));
  };
  EXPECT_EQ(difference_with({"body.beam.material.youngs_modulus=2e6"}),
            "body.beam.material.youngs_modulus is 1e+06, not 2e+06 as in the scene");
  EXPECT_EQ(difference_with({"load=[]"}), "load is \"pull\", not none as in the scene");
  EXPECT_EQ(difference_with({"body.beam.material={law=\"neo_hookean\",shear_modulus=1e5,lame_lambda=1e5}"}),
            "body.beam.material.poissons_ratio is 0.3, which the scene does not have");
  EXPECT_NE(difference_with({"body.beam.mesh.box.size=[2,1,1.5]"}).find("body.beam.mesh is 12 vertices, "),
            std::string::npos);
}

}  // namespace
}  // namespace resilin::testing
