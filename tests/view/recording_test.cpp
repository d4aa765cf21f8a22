#include "resilin/view/recording.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "resilin/core/error.hpp"
#include "resilin/view/page.hpp"
#include "small_scenes.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// A bar whose surface moves by `size` [m], more and more.
RecordedFrame frame_at(const ShownSurface& surface, std::uint32_t number, double size) {
  RecordedFrame frame{.number = number, .step = 2 * number, .time = 0.1 * number, .load = 0.5};
  const auto n = static_cast<std::size_t>(surface.num_vertices());
  frame.displacements.resize(3 * n);
  frame.fields.assign(2, std::vector<float>(n));
  for (std::size_t v = 0; v < n; ++v) {
    const float* X = surface.rest_positions().data() + 3 * v;
    const double x = static_cast<double>(X[0]), z = static_cast<double>(X[2]);
    const double wave = std::sin(0.7 * number + 3 * x);
    frame.displacements[3 * v] = static_cast<float>(size * number * wave);
    frame.displacements[3 * v + 2] = static_cast<float>(size * (number + z) * x * x);
    frame.fields[0][v] = static_cast<float>(1e5 * wave * wave);
    frame.fields[1][v] = static_cast<float>(0.9 + 0.1 * x * number);
  }
  return frame;
}

double quantum_of(std::string_view payload) {
  double quantum = 0;
  std::memcpy(&quantum, payload.data() + 24, sizeof(quantum));
  return quantum;
}

TEST(RecordingCodec, GivesBackWhatWasRecordedToItsQuanta) {
  for (const int dim : {2, 3}) {
    const World world(small_bar(dim, true));
    const ShownSurface surface(world);
    for (const double size : {0.1, 1e-7}) {  // stiff things move little: relative precision is the same
      RecordingCodec writer(surface, 2, world.largest_extent()), reader = writer;
      for (std::uint32_t k = 0; k < 6; ++k) {
        const RecordedFrame frame = frame_at(surface, k, size);
        const std::string payload = writer.encode(frame);
        const RecordedFrame read = reader.decode(payload);
        EXPECT_EQ(read.number, k);
        EXPECT_EQ(read.step, 2 * k);
        EXPECT_EQ(read.time, frame.time);
        EXPECT_EQ(read.load, 0.5);
        const double quantum = quantum_of(payload);
        EXPECT_LE(quantum, 1e-5 * world.largest_extent());
        if (k > 0) {
          EXPECT_LE(quantum, size * 6 / 16000);
        }
        for (std::size_t i = 0; i < frame.displacements.size(); ++i) {
          ASSERT_NEAR(read.displacements[i], frame.displacements[i],
                      0.5 * quantum + 1e-7 * std::abs(frame.displacements[i]));
        }
        for (std::size_t f = 0; f < 2; ++f) {
          const FieldRange range = finite_range(frame.fields[f]);
          const float step = (range.greatest - range.least) / 4094;
          for (std::size_t v = 0; v < frame.fields[f].size(); ++v)
            ASSERT_NEAR(read.fields[f][v], frame.fields[f][v],
                        0.51F * step + 1e-6F * std::abs(range.greatest));
        }
      }
    }
  }
}

TEST(RecordingCodec, SaysWhereCollidersAre) {
  const World world(small_bar(2, true));
  const ShownSurface surface(world);
  RecordingCodec writer(surface, 2, world.largest_extent(), 2), reader = writer;
  RecordedFrame frame = frame_at(surface, 1, 0.1);
  for (std::size_t i = 0; i < 2 * numbers_per_collider; ++i)
    frame.colliders.push_back(0.1F * static_cast<float>(i));
  const std::string payload = writer.encode(frame);
  const RecordedFrame read = reader.decode(payload);
  EXPECT_EQ(read.colliders, frame.colliders);
  EXPECT_EQ(read.fields[1].size(), frame.fields[1].size());
  EXPECT_THROW(RecordingCodec(surface, 2, world.largest_extent()).decode(payload), InputError);
}

TEST(RecordingCodec, SurvivesWhatIsNoNumberAndWhatFliesAway) {
  const World world(small_bar(3, true));
  const ShownSurface surface(world);
  RecordingCodec writer(surface, 2, world.largest_extent()), reader = writer;
  RecordedFrame frame = frame_at(surface, 1, 0.1);
  const RecordedFrame before = reader.decode(writer.encode(frame));
  frame.displacements[4] = nan;
  frame.displacements[7] = std::numeric_limits<float>::infinity();
  frame.fields[0][3] = nan;
  const RecordedFrame after = reader.decode(writer.encode(frame));
  EXPECT_EQ(after.displacements[4], before.displacements[4]);
  EXPECT_EQ(after.displacements[7], before.displacements[7]);
  EXPECT_TRUE(std::isnan(after.fields[0][3]));
  EXPECT_EQ(after.fields[0][2], before.fields[0][2]);
  frame = frame_at(surface, 2, 0.1);
  frame.displacements[0] = 1e20F;
  reader.decode(writer.encode(frame));
  frame.displacements[0] = 0.25F;  // it comes back, in as many frames as it takes
  float place = 0;
  for (int k = 0; k < 5; ++k) place = reader.decode(writer.encode(frame)).displacements[0];
  EXPECT_NEAR(place, 0.25F, 1e-5);
  frame.displacements.assign(frame.displacements.size(), nan);
  frame.fields.assign(2, std::vector<float>(frame.fields[0].size(), nan));
  EXPECT_TRUE(std::isnan(reader.decode(writer.encode(frame)).fields[1][0]));
}

TEST(RecordingCodec, RefusesWhatIsNoRecord) {
  const World world(small_bar(2, true));
  const ShownSurface surface(world);
  RecordingCodec writer(surface, 2, 1), reader = writer;
  const std::string payload = writer.encode(frame_at(surface, 1, 0.1));
  EXPECT_THROW(RecordingCodec(reader).decode("short"), InputError);
  EXPECT_THROW(RecordingCodec(reader).decode(payload.substr(0, payload.size() - 5)), InputError);
  EXPECT_THROW(RecordingCodec(surface, 3, 1).decode(payload), InputError);
}

const std::string file = "recording.bin";

std::vector<State> motion_of_a_bar() {
  Simulation simulation(small_bar(3, true));
  std::vector<State> states = {simulation.state()};
  for (int i = 0; i < 6; ++i) {
    simulation.step();
    states.push_back(simulation.state());
  }
  return states;
}

TEST(Recorder, GoesOnWithATornFileAsIfItHadNeverStopped) {
  const TemporaryFolder folder;
  const World world(small_bar(3, true));
  const std::vector<State> states = motion_of_a_bar();
  const ViewHeader header{.title = "bar", .version = "1", .fields = {}};
  const auto number = [](std::size_t i) { return static_cast<std::uint32_t>(i); };
  {
    Recorder recorder(folder / file, world, header);
    recorder.keep(0);
    for (std::size_t i = 0; i < states.size(); ++i) recorder.record(number(i), states[i]);
  }
  const std::string whole = folder.read(file);
  const Recording recording = parse_recording(whole, "it");
  ASSERT_EQ(recording.records.size(), states.size());
  const auto json = nlohmann::json::parse(recording.header);
  EXPECT_EQ(json["fields"].size(), 3U);
  EXPECT_EQ(json["fields"][0]["name"], "nodal_von_mises");
  EXPECT_EQ(json["title"], "bar");

  for (const std::size_t cut :
       {whole.size() - 1, recording.records[3].begin + 5, recording.records[3].begin - 6,
        recording.records[0].begin, std::size_t{100}, std::size_t{0}}) {
    folder.write(file, whole.substr(0, cut));
    Recorder recorder(folder / file, world, header);
    recorder.keep(5);
    const std::uint32_t next = recorder.next_number();
    EXPECT_LE(next, 5U);
    EXPECT_EQ(next, cut == whole.size() - 1 ? 5U : cut >= recording.records[3].begin - 8 ? 3U : 0U);
    for (std::size_t i = next; i < states.size(); ++i) recorder.record(number(i), states[i]);
    EXPECT_EQ(folder.read(file), whole) << "cut at " << cut;
  }
  // A byte in the middle is wrong: what lies behind it is not trusted.
  std::string damaged = whole;
  damaged[recording.records[2].begin + 40] ^= 1;
  EXPECT_EQ(parse_recording(damaged, "it").records.size(), 2U);
  EXPECT_THROW(parse_recording("something else", "it"), InputError);
  EXPECT_THROW(parse_recording(whole.substr(0, 60), "it"), InputError);
}

TEST(Recorder, BeginsAnewWhereAnotherSceneWas) {
  const TemporaryFolder folder;
  const World world(small_bar(3, true)), other(small_bar(2, true));
  Recorder(folder / file, other, {.title = "other", .version = "1", .fields = {}}).keep(0);
  Recorder recorder(folder / file, world, {.title = "bar", .version = "1", .fields = {}});
  recorder.keep(7);
  EXPECT_EQ(recorder.next_number(), 0U);
  const std::string bytes = folder.read(file);
  EXPECT_EQ(nlohmann::json::parse(parse_recording(bytes, "it").header)["title"], "bar");
}

/// The promise of the page: 10,000 vertices and 100 frames in at most 10 MB, here with waves of several
/// lengths that run through a slab and with fields that follow them.
TEST(RecordingCodec, KeepsAHundredFramesOfTenThousandVerticesBelowTenMegabytes) {
  Description scene = small_bar(3, true);
  scene.bodies[0].mesh = make_box({1, 1, 0.05}, {70, 70, 1});
  scene.probes.clear();
  scene.fixes.clear();
  const World world(scene);
  const ShownSurface surface(world);
  const auto n = static_cast<std::size_t>(surface.num_vertices());
  ASSERT_GE(n, 10000U);
  RecordingCodec codec(surface, 3, 1);
  std::size_t size = encode_topology(surface).size();
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 0.003);  // as strains jump from cell to cell
  RecordedFrame frame{.displacements = std::vector<float>(3 * n), .fields = {3, std::vector<float>(n)}};
  for (int k = 0; k < 100; ++k) {
    const double t = 0.05 * k;
    for (std::size_t v = 0; v < n; ++v) {
      const double x = static_cast<double>(surface.rest_positions()[3 * v]);
      const double y = static_cast<double>(surface.rest_positions()[3 * v + 1]);
      const double wave = std::sin(6 * x + 3 * t) * std::cos(5 * y - t) + 0.2 * std::sin(40 * x - 9 * t);
      frame.displacements[3 * v] = static_cast<float>(0.05 * std::cos(t + 2 * y));
      frame.displacements[3 * v + 1] = static_cast<float>(0.03 * wave);
      frame.displacements[3 * v + 2] = static_cast<float>(0.1 * wave - 0.5 * t * t);
      for (std::size_t f = 0; f < 3; ++f)
        frame.fields[f][v] = static_cast<float>(1e5 * (wave * wave + noise(random)));
    }
    size += codec.encode(frame).size() + 8;
  }
  const std::size_t html = (size + 2) / 3 * 4 + page_bytes().size() + 100 * 1000;  // with a report
  EXPECT_LE(html, 10'000'000U);
  EXPECT_GE(size, 1'000'000U);
}

}  // namespace
}  // namespace resilin::testing
