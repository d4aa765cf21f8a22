// Checkpoints that were cut, damaged or forged: always an answer in one line, never a crash.

#include "resilin/results/checkpoint.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>
#include <random>

#include "resilin/core/hash.hpp"
#include "resilin/results/build_info.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

template <class Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// A few cells, so that every length of its checkpoint can be tried.
Description tiny(const std::string& kind) {
  Description scene = small_bar(2, kind == "dynamic");
  scene.bodies[0].mesh = make_rectangle({1, 0.5}, {2, 1});
  scene.newton.max_iterations = 5;
  if (kind == "modes") scene.modes.emplace().count = 3;
  if (kind == "path") {
    scene.load_control = LoadControlKind::arc_length;
    scene.max_steps = 4;
  }
  if (kind == "dynamic") scene.integrator = "bdf2";
  if (kind == "adaptive") {
    scene.is_dynamic = true;
    scene.integrator = "newmark";
    scene.adaptive.emplace();
  }
  scene.load_steps = 4;
  return scene;
}

Checkpoint checkpoint_of(const Description& scene, int steps) {
  Simulation simulation(scene);
  for (int i = 0; i < steps; ++i) simulation.step();
  return {
      .version = std::string(version()),
      .fingerprint = simulation.world().fingerprint,
      .failed_steps = {.count = 2, .in_a_row = 1, .first_step = 2, .first_time = 0.5, .first_reason = "why"},
      .state = simulation.state()};
}

const std::array<std::string, 5> kinds = {"static", "dynamic", "adaptive", "modes", "path"};

TEST(Checkpoint, IsReadAsItWasWritten) {
  for (const std::string& kind : kinds) {
    const Checkpoint written = checkpoint_of(tiny(kind), 2);
    const Checkpoint read = parse_checkpoint(serialize(written), "c.bin");
    EXPECT_EQ(serialize(read), serialize(written)) << kind;
    EXPECT_EQ(read.failed_steps.first_reason, "why");
    EXPECT_FALSE(first_difference(read.fingerprint, written.fingerprint).has_value());
  }
}

TEST(Checkpoint, IsRefusedAtEveryLengthButItsOwn) {
  std::string bytes = serialize(checkpoint_of(tiny("dynamic"), 2));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::string message =
        message_of([&] { parse_checkpoint(std::string_view(bytes).substr(0, size), "c.bin"); });
    ASSERT_THAT(message, HasSubstr("c.bin: expected")) << size;
    ASSERT_EQ(message.find('\n'), message.npos) << size;
  }
  bytes += '\0';
  EXPECT_THAT(message_of([&] { parse_checkpoint(bytes, "c.bin"); }), HasSubstr("damaged"));
}

TEST(Checkpoint, IsRefusedWithAnyByteChanged) {
  const std::string bytes = serialize(checkpoint_of(tiny("static"), 2));
  std::mt19937 random(1);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1 + random() % 255));
    ASSERT_THAT(message_of([&] { parse_checkpoint(damaged, "c.bin"); }), HasSubstr("c.bin: expected")) << at;
  }
}

TEST(Checkpoint, OfAnotherFormatSaysSo) {
  EXPECT_THAT(message_of([] { parse_checkpoint("resilin state 5\n0123456789", "c.bin"); }),
              HasSubstr("one of another format"));
  EXPECT_THAT(message_of([] { parse_checkpoint("hello", "c.bin"); }), HasSubstr("something else"));
}

/// Puts right hashes where they belong, as whoever forges a checkpoint on purpose would.
void sign(std::string& bytes) {
  const std::size_t begin = bytes.find("resilin state ");
  constexpr std::size_t size = sizeof(std::uint64_t);
  if (begin == bytes.npos || bytes.size() < begin + 2 * size) return;
  const auto sign_part = [&bytes](std::size_t from, std::size_t end) {
    const std::uint64_t hash = hash_of(std::string_view(bytes).substr(from, end - from));
    std::memcpy(bytes.data() + end, &hash, size);
  };
  sign_part(begin, bytes.size() - 2 * size);
  sign_part(0, bytes.size() - size);
}

/// The word at a place becomes one of the numbers that break programs.
void forge_word(std::string& bytes, std::size_t at, std::mt19937& random) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr std::array numbers = {std::numeric_limits<double>::quiet_NaN(),
                                  infinity,
                                  -infinity,
                                  -1.0,
                                  0.0,
                                  1e300,
                                  -1e300,
                                  5e-324,
                                  1e-300,
                                  1e9,
                                  3.0};
  constexpr std::array<std::int64_t, 9> counts = {-1,
                                                  0,
                                                  1,
                                                  1 << 20,
                                                  std::numeric_limits<std::int32_t>::max(),
                                                  std::int64_t{1} << 32,
                                                  std::int64_t{1} << 61,
                                                  std::numeric_limits<std::int64_t>::max(),
                                                  std::numeric_limits<std::int64_t>::min()};
  char word[8];
  if (random() % 2 == 0)
    std::memcpy(word, &numbers[random() % numbers.size()], sizeof(word));
  else
    std::memcpy(word, &counts[random() % counts.size()], sizeof(word));
  std::memcpy(bytes.data() + at, word, sizeof(word));
}

/// Refused in one line, or gone on from for a few steps: whether it is.
bool expect_answer(const std::string& bytes, const Description& scene) {
  Simulation simulation(scene);
  const std::string message = message_of([&] {
    const Checkpoint checkpoint = parse_checkpoint(bytes, "c.bin");
    simulation.resume_from(checkpoint.state, "c.bin", checkpoint.failed_steps);
  });
  if (!message.empty()) {
    EXPECT_THAT(message, HasSubstr("c.bin: expected"));
    EXPECT_EQ(message.find('\n'), message.npos) << message;
    return false;
  }
  for (int i = 0; i < 3 && !simulation.is_finished(); ++i) {
    if (simulation.step().status == StepReport::Status::not_converged) break;
    EXPECT_TRUE(simulation.state().positions.allFinite());
  }
  return true;
}

class EveryKind : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryKind, OfForgedCheckpointIsRefusedOrGoneOnFrom) {
  const Description scene = tiny(GetParam());
  const std::string good = serialize(checkpoint_of(scene, 2));
  const std::size_t begin = good.find("resilin state ") + std::string("resilin state 6\n").size();
  std::mt19937 random(2);
  int gone_on = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string forged = good;
    // Words of the state in their places, most often those at its start: counters, times, lengths.
    const std::size_t words = (good.size() - begin) / 8 - 2;
    for (std::size_t changes = 1 + random() % 3; changes > 0; --changes) {
      const std::size_t word = random() % (random() % 2 == 0 ? 5 : words);
      forge_word(forged, begin + 8 * word, random);
    }
    sign(forged);
    SCOPED_TRACE(i);
    gone_on += expect_answer(forged, scene) ? 1 : 0;
  }
  EXPECT_GT(gone_on, 50);
}

TEST_P(EveryKind, OfShortenedVectorIsRefused) {
  const Description scene = tiny(GetParam());
  const Checkpoint good = checkpoint_of(scene, 2);
  for (VectorX State::* member : {&State::positions, &State::velocities, &State::previous_positions,
                                  &State::accelerations, &State::previous_velocities}) {
    for (const Eigen::Index size : {0, 1, 5, 13}) {
      Checkpoint forged = good;
      (forged.state.*member).conservativeResize(size);
      expect_answer(serialize(forged), scene);
      if (size == 0) continue;
      Simulation simulation(scene);
      EXPECT_THAT(message_of([&] { simulation.resume_from(forged.state, "c.bin"); }),
                  HasSubstr("of 12 DOFs, got"));
    }
  }
}

TEST_P(EveryKind, OfModeThatIsNotThereIsRefused) {
  for (const int mode : {-1, 4, std::numeric_limits<int>::max()}) {
    const Description scene = tiny(GetParam());
    Simulation simulation(scene);
    State state = simulation.state();
    state.mode = mode;
    EXPECT_THAT(message_of([&] { simulation.resume_from(state, "c.bin"); }), HasSubstr("mode")) << mode;
  }
}

INSTANTIATE_TEST_SUITE_P(Checkpoint, EveryKind, ::testing::ValuesIn(kinds),
                         [](const auto& instance) { return instance.param; });

TEST(Checkpoint, OfAnotherVersionIsGoneOnFromOnlyAnyway) {
  Checkpoint other = checkpoint_of(tiny("static"), 1);
  other.version = "0.0.9";
  const Fingerprint scene = fingerprint_of(tiny("static"));
  EXPECT_THAT(message_of([&] { check_scene(other, scene, Resume::same_scene, "c.bin"); }),
              HasSubstr("written by version 0.0.9"));
  EXPECT_THAT(*check_scene(other, scene, Resume::anyway, "c.bin"), HasSubstr("0.0.9"));
  other.version = version();
  EXPECT_EQ(check_scene(other, scene, Resume::same_scene, "c.bin"), std::nullopt);
}

TEST(Checkpoint, OfAnotherKindIsNeverGoneOnFrom) {
  for (const std::string kind : {"static", "dynamic", "modes"}) {
    for (const std::string other : {"static", "dynamic", "modes"}) {
      if (kind == other) continue;
      const std::string message = message_of([&] {
        check_scene(checkpoint_of(tiny(kind), 1), fingerprint_of(tiny(other)), Resume::anyway, "c.bin");
      });
      EXPECT_THAT(message, HasSubstr("simulation.kind \"" + other + "\", got \"" + kind + '"'));
    }
  }
}

}  // namespace
}  // namespace resilin::testing
