#include "viewer/served_live_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "jelly_scene.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/overloaded.hpp"
#include "resilin/view/frame_codec.hpp"

namespace resilin::viewer {
namespace {

using nlohmann::json;
using resilin::testing::jelly;
using ::testing::HasSubstr;

constexpr const char* plate = R"([simulation]
kind = "static"
dimension = 2
[[body]]
name = "plate"
element = "P1"
mesh = { box = { size = [1, 1], cells = [2, 2] } }
material = { law = "neo_hookean", youngs_modulus = 1e4, poissons_ratio = 0.3, density = 1000 }
[[fix]]
where = { plane = { axis = "y", at = 0 } }
)";

SetControl set(std::string_view key, const ControlValue& value) { return {find_live_control(key), value}; }

struct ServedLiveSceneTest : ::testing::Test {
  std::string text = jelly;
  ServedLiveScene scene{[this] { return read_scene_from_text(text, "jelly.toml", "."); }};

  DecodedFrame frame(std::optional<std::size_t> field = std::nullopt, double blend = 1) {
    return decode_frame(scene.frame(++number, 0, {.field = field}, blend));
  }
  Vector3 vertex(std::uint32_t v) {
    const std::vector<float> x = frame().positions;
    return Vector3(static_cast<double>(x[3 * v]), static_cast<double>(x[3 * v + 1]),
                   static_cast<double>(x[3 * v + 2]));
  }
  /// A vertex of the upper side.
  std::uint32_t top() {
    const std::vector<float> x = frame().positions;
    for (std::uint32_t v = 0; v < x.size() / 3; ++v) {
      if (x[3 * v + 2] > 0.999F) return v;
    }
    return 0;
  }
  std::string refusal(const SceneMessage& message) {
    try {
      scene.apply(message);
      return {};
    } catch (const InputError& error) {
      return error.what();
    }
  }
  void run(int num_steps) {
    for (int i = 0; i < num_steps; ++i) scene.step(3600);  // [s], more than any machine needs
  }

  std::uint32_t number = 0;
};

TEST_F(ServedLiveSceneTest, DescribesTheScene) {
  const json header = scene.header();
  EXPECT_EQ(header["title"], "jelly.toml");
  EXPECT_EQ(header["parts"][0]["num_vertices"], 27);
  EXPECT_EQ(header["fields"].size(), scene.field_names().size());
  const json state = scene.state();
  EXPECT_TRUE(state["ground"].is_null());
  const json& values = state["values"];
  EXPECT_EQ(values["law"], "stable_neo_hookean");
  EXPECT_EQ(values["youngs_modulus"], 1e4);
  EXPECT_EQ(values["gravity"], json({0, 0, -9.81}));
  EXPECT_EQ(values["time_step"], 0.01);
  EXPECT_EQ(values["ground"], false);
  EXPECT_EQ(values["ground_height"], 0) << "the floor would be under the lowest vertex";
}

TEST_F(ServedLiveSceneTest, SendsTheVectorsOfAFieldAsArrows) {
  const std::vector<std::string> names = scene.field_names();
  const auto velocity = static_cast<std::size_t>(std::ranges::find(names, "velocity") - names.begin());
  ASSERT_LT(velocity, names.size());
  EXPECT_TRUE(frame().arrows.empty());
  const std::uint32_t v = top();
  run(1);
  const Vector3 before = vertex(v);
  run(1);
  const DecodedFrame shown = decode_frame(scene.frame(++number, 0, {.field = {}, .arrows = velocity}, 1));
  EXPECT_TRUE(shown.field.empty());
  EXPECT_EQ(shown.arrows_number, velocity);
  ASSERT_EQ(shown.arrows.size(), shown.positions.size());
  // Backward Euler: the velocity is the way of the last step over its time of 0.01 s.
  const double speed = (vertex(v).z() - before.z()) / 0.01;
  EXPECT_LT(speed, 0) << "it sags";
  EXPECT_NEAR(static_cast<double>(shown.arrows[3 * v + 2]), speed, 0.02 * std::abs(speed));
}

TEST_F(ServedLiveSceneTest, ListsItsControlsForThePanel) {
  const json header = scene.header();
  std::map<std::string, json> controls;
  for (const json& control : header["controls"]) controls[control["key"]] = control;
  const auto num_of_contact = std::ranges::count_if(live_control_table(), &LiveControl::is_of_contact);
  EXPECT_EQ(controls.size() + static_cast<std::size_t>(num_of_contact), live_control_table().size());
  EXPECT_FALSE(controls.contains("contact_friction")) << "of one body, which nothing meets";
  EXPECT_EQ(controls["youngs_modulus"]["kind"], "log_slider");
  EXPECT_EQ(controls["youngs_modulus"]["unit"], "Pa");
  EXPECT_EQ(controls["newton_limit"]["step"], 1);
  EXPECT_EQ(controls["ground"]["hotkey"], "g");
  EXPECT_EQ(controls["ground_height"]["greatest"], 2) << "extents of the jelly";
  EXPECT_EQ(controls["gravity"]["initial"], json({0, 0, -9.81}));
  const json& laws = controls["law"]["options"];
  const auto stable =
      std::ranges::find(laws, "stable_neo_hookean", [](const json& law) { return law["name"]; });
  ASSERT_NE(stable, laws.end());
  EXPECT_EQ((*stable)["label"], "Stable Neo-Hookean");
}

TEST_F(ServedLiveSceneTest, AHandPullsTheVertexThatItHoldsWithoutAJolt) {
  const std::uint32_t v = top();
  const Vector3 before = vertex(v);
  const Vector3 hit = before + Vector3(0.01, 0, 0);  // the pointer hit beside the vertex
  scene.apply(Grab{v, hit});
  EXPECT_TRUE(scene.is_grabbed());
  run(1);
  EXPECT_LT((vertex(v) - before).norm(), 0.005) << "it falls for a step, and taking hold moves nothing";
  scene.apply(Drag{1, hit + Vector3(0, 0.3, 0)});
  run(30);
  EXPECT_GT(vertex(v).y() - before.y(), 0.1);
  EXPECT_LT(std::abs(vertex(v).x() - before.x()), 0.5 * (vertex(v).y() - before.y()));
  scene.apply(Release{});
  EXPECT_FALSE(scene.is_grabbed());
}

TEST_F(ServedLiveSceneTest, APinnedVertexStaysAndIsNamedAsThePageNamedIt) {
  const std::uint32_t v = top();
  const Vector3 before = vertex(v);
  scene.apply(Pin{v});
  EXPECT_EQ(scene.state()["pinned"], json({v}));
  run(20);
  EXPECT_LT((vertex(v) - before).norm(), 1e-4);  // 1/65535 of the box is the precision of a frame
  scene.apply(Unpin{v});
  EXPECT_EQ(scene.state()["pinned"], json::array());
  run(20);
  EXPECT_GT((vertex(v) - before).norm(), 1e-3);
  scene.apply(Pin{v});
  scene.apply(UnpinAll{});
  EXPECT_EQ(scene.state()["pinned"], json::array());
}

TEST_F(ServedLiveSceneTest, SetsEachControl) {
  const std::vector<std::pair<const char*, ControlValue>> cases = {
      {"youngs_modulus", 3e4},
      {"poissons_ratio", 0.45},
      {"damping", 2.0},
      {"time_step", 0.02},
      {"speed", 0.5},
      {"max_force", 50.0},
      {"tolerance", 1e-3},
      {"newton_limit", 3.0},
      {"ground_height", -0.5},
      {"ground", true},
      {"law", std::string("neo_hookean")},
      {"gravity", Vector3(1, 2, 3)},
  };
  for (const auto& [key, value] : cases) {
    scene.apply(set(key, value));
    const json expected = std::visit(Overloaded{
                                         [](const Vector3& v) -> json { return {v.x(), v.y(), v.z()}; },
                                         [](const auto& plain) -> json { return plain; },
                                     },
                                     value);
    EXPECT_EQ(scene.state()["values"][key], expected) << key;
    run(1);
  }
  EXPECT_EQ(scene.state()["ground"], -0.5);
  EXPECT_EQ(scene.time_step(), 0.02);
  EXPECT_EQ(scene.speed(), 0.5);
  scene.apply(Reload{});
  EXPECT_EQ(scene.time_step(), 0.01);
  EXPECT_EQ(scene.speed(), 0.5) << "the speed is not the scene's";
}

TEST_F(ServedLiveSceneTest, RefusesWhatCannotBeAndStaysAsItWas) {
  const json before = scene.state();
  const std::vector<std::pair<SceneMessage, std::string>> cases = {
      {Grab{27, Vector3::Zero()}, "grab: vertex: expected a number from 0 to 26, got 27"},
      {Grab{0, Vector3(1e30, 0, 0)}, "within a thousand sizes of the bodies"},
      {Pin{4294967295U}, "got 4294967295"},
      {Unpin{27}, "unpin: vertex"},
      {Poke{Vector3(0, 0, 1e9), 0.1}, "poke: center"},
      {set("youngs_modulus", -1.0), "youngs_modulus"},
      {set("poissons_ratio", 0.5), "poissons_ratio"},
      {set("time_step", 0.0), "time_step"},
      {set("newton_limit", 1.5), "newton_limit: expected a whole number from 0 to 1000, got 1.5"},
      {set("law", std::string("rubber")), "rubber"},
  };
  for (const auto& [message, expected] : cases) {
    EXPECT_THAT(refusal(message), HasSubstr(expected));
    EXPECT_EQ(scene.state(), before);
  }
  run(1);
}

TEST_F(ServedLiveSceneTest, FramesCarryTheFieldThatIsAskedFor) {
  run(10);
  EXPECT_TRUE(frame().field.empty());
  EXPECT_EQ(std::ranges::count(scene.field_names(), "nodal_von_mises"), 1) << "few cells are smoothed live";
  for (std::size_t i = 0; i < scene.field_names().size(); ++i) {
    const DecodedFrame shown = frame(i);
    EXPECT_EQ(shown.field_number, i);
    EXPECT_EQ(shown.field.size(), 27U) << scene.field_names()[i];
  }
}

TEST_F(ServedLiveSceneTest, FramesBetweenTwoStepsGoEvenlyFromOneToTheOther) {
  run(10);
  const DecodedFrame before = frame();
  run(1);
  const DecodedFrame after = frame();
  const DecodedFrame between = frame(std::nullopt, 0.25);
  EXPECT_NEAR(between.time, before.time + 0.25 * 0.01, 1e-12);
  const float precision = 2e-5F * between.size[2];  // precision of a frame: 1/65535
  for (std::size_t i = 0; i < before.positions.size(); ++i) {
    EXPECT_NEAR(between.positions[i], 0.75F * before.positions[i] + 0.25F * after.positions[i], precision);
  }
  scene.apply(Reset{});
  EXPECT_EQ(frame(std::nullopt, 0.25).time, 0);
}

TEST_F(ServedLiveSceneTest, ShowsCollidersWhereTheyAreBetweenTwoSteps) {
  text = std::string(jelly) + R"(
[[collider]]
name = "paddle"
kind = "box"
center = [5, 0, 0]
size = [1, 1, 1]
velocity = [0, 2, 0]
)";
  scene.apply(Reload{});
  const json header = scene.header();
  ASSERT_EQ(header["colliders"].size(), 1U);
  EXPECT_EQ(header["colliders"][0]["num_vertices"], 8);
  EXPECT_EQ(header["colliders"][0]["closed"], true);
  const auto height = [this](double blend) { return frame(std::nullopt, blend).colliders.at(7); };
  EXPECT_EQ(height(1), 0);
  scene.step(1);
  const auto moved = static_cast<float>(2 * scene.time_step());
  EXPECT_FLOAT_EQ(height(1), moved);
  EXPECT_FLOAT_EQ(height(0.25), 0.25F * moved);
  EXPECT_EQ(scene.status()["active_pairs"], 0);
  EXPECT_TRUE(scene.status()["smallest_gap"].is_number_float() || scene.status()["smallest_gap"].is_null());
}

TEST_F(ServedLiveSceneTest, ReloadsAndKeepsTheSceneWhenTheFileIsBroken) {
  run(3);
  text = "[simulation]\nkynd = 1\n";
  EXPECT_THAT(refusal(Reload{}), HasSubstr("jelly.toml:2: simulation.kynd"));
  EXPECT_GT(scene.time(), 0);
  text = plate;
  EXPECT_EQ(refusal(Reload{}), "");
  EXPECT_EQ(scene.time(), 0);
  EXPECT_EQ(scene.header()["dimension"], 2);
  EXPECT_EQ(scene.header()["up"], json({0, 1, 0}));
  scene.apply(Grab{0, Vector3(0, 0, 5)});  // a plane has no depth
  run(2);
  EXPECT_EQ(vertex(0).z(), 0);
}

TEST_F(ServedLiveSceneTest, StandsAnyOrderOfCommands) {
  std::mt19937 random(1);
  const auto below = [&random](std::uint32_t end) {
    return std::uniform_int_distribution<std::uint32_t>(0, end - 1)(random);
  };
  const auto place = [&random] {
    std::normal_distribution<double> one;
    return Vector3(one(random), one(random), one(random));
  };
  const auto factor = [&random] { return std::exp(std::normal_distribution<double>(0, 2)(random)); };
  for (int i = 0; i < 600; ++i) {
    const SceneMessage messages[] = {
        Grab{below(30), place()},
        Drag{1, 10 * place()},
        Release{},
        Pin{below(30)},
        Unpin{below(30)},
        UnpinAll{},
        Poke{place(), factor()},
        PokeEnd{},
        set("youngs_modulus", 1e4 * factor()),
        set("poissons_ratio", 0.3 * factor()),
        set("time_step", 0.01 * factor()),
        set("ground", below(2) == 0),
        set("ground_height", place().z()),
        set("gravity", Vector3(10 * place())),
        set("law", std::string(below(2) == 0 ? "neo_hookean" : "stable_neo_hookean")),
        Reset{}};
    refusal(messages[below(std::size(messages))]);
    scene.step(0);
    for (const float x : frame().positions) ASSERT_TRUE(std::isfinite(x)) << i;
    ASSERT_TRUE(scene.status()["residual"].is_number());
  }
}

TEST(ServedSceneOfAProgram, IsWhereTheProgramAndThePageHaveLedIt) {
  const auto live = std::make_shared<LiveScene>(read_scene_from_text(jelly, "jelly.toml", ".").description);
  ServedLiveScene scene(live, {"careful"});
  EXPECT_EQ(scene.header()["saves"], false);
  EXPECT_EQ(scene.state()["warnings"], json({"careful"}));
  EXPECT_THROW(scene.save(), InputError);

  const double first_damping = live->controls().damping;
  scene.apply(set("damping", first_damping + 3));
  EXPECT_EQ(live->controls().damping, first_damping + 3);
  scene.step(3600);
  EXPECT_GT(live->state().time, 0);
  live->pin(0);  // by the program: the page did not say by which vertex
  const json pinned = scene.state()["pinned"];
  ASSERT_EQ(pinned.size(), 1U);
  scene.apply(Unpin{pinned[0].get<std::uint32_t>()});
  EXPECT_TRUE(live->pinned().empty());

  live->pin(0);
  scene.apply(set("speed", 0.5));
  scene.apply(Reload{});  // there is no file: a reset, with the controls that it was shown with first
  EXPECT_EQ(live->state().time, 0);
  EXPECT_TRUE(live->pinned().empty());
  EXPECT_EQ(live->controls().damping, first_damping);
  EXPECT_EQ(scene.speed(), 0.5);
}

}  // namespace
}  // namespace resilin::viewer
