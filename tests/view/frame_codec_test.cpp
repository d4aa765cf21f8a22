#include "resilin/view/frame_codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "resilin/core/error.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

/// Vertices at random in a box of 2 x 0.5 x 30 m, with directions and a field.
struct SampleFrame {
  std::vector<float> positions, normals, field;

  explicit SampleFrame(std::size_t n) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0, 1);
    std::normal_distribution<float> normal;
    for (std::size_t v = 0; v < n; ++v) {
      const std::array<float, 3> size = {2, 0.5F, 30};
      Eigen::Vector3f direction(normal(random), normal(random), normal(random));
      direction.normalize();
      for (Eigen::Index k = 0; k < 3; ++k) {
        positions.push_back(10 + size[static_cast<std::size_t>(k)] * unit(random));
        normals.push_back(direction[k]);
      }
      field.push_back(-3 + 8 * unit(random));
    }
  }

  LiveFrame frame() const {
    return {.number = 7,
            .time = 1.25,
            .answers = 9,
            .positions = positions,
            .normals = normals,
            .field_number = 2,
            .field = field};
  }
};

std::string encoded(const LiveFrame& frame) {
  std::string bytes;
  encode_frame(frame, bytes);
  return bytes;
}

TEST(FrameCodec, KeepsPlacesNormalsAndTheFieldWithinHalfAQuantum) {
  const SampleFrame sample(1001);
  const DecodedFrame frame = decode_frame(encoded(sample.frame()));
  EXPECT_EQ(frame.number, 7u);
  EXPECT_EQ(frame.time, 1.25);
  EXPECT_EQ(frame.answers, 9u);
  EXPECT_EQ(frame.field_number, 2u);
  ASSERT_EQ(frame.positions.size(), sample.positions.size());
  // Half a step, and the rounding of floats: coordinates to 2^-24, twice.
  for (std::size_t i = 0; i < sample.positions.size(); ++i)
    ASSERT_LE(std::abs(frame.positions[i] - sample.positions[i]),
              0.5F * frame.size[i % 3] / 65535 + sample.positions[i] * 1.2e-7F);
  const float field_step = (frame.range.greatest - frame.range.least) / 65534;
  for (std::size_t v = 0; v < sample.field.size(); ++v)
    ASSERT_LE(std::abs(frame.field[v] - sample.field[v]), 0.51F * field_step + 1e-6F);
  // Half a step of 1/127 along both sides of the octahedron's square: at most a degree.
  for (std::size_t v = 0; v < sample.field.size(); ++v) {
    const Eigen::Map<const Eigen::Vector3f> given(sample.normals.data() + 3 * v);
    const Eigen::Map<const Eigen::Vector3f> found(frame.normals.data() + 3 * v);
    ASSERT_GT(given.dot(found), std::cos(0.0175F)) << given.transpose();
  }
}

TEST(FrameCodec, KeepsArrowsWithinHalfAStepOfTheLargestComponent) {
  for (const std::size_t n : {1001U, 1002U}) {
    const SampleFrame sample(n);
    LiveFrame given = sample.frame();
    std::vector<float> arrows = sample.normals;
    arrows[0] = nan;
    given.arrows = arrows;
    given.arrows_number = 5;
    const std::vector<float> places(numbers_per_collider, 1.5F);
    given.colliders = places;
    const DecodedFrame frame = decode_frame(encoded(given));
    EXPECT_EQ(frame.arrows_number, 5U);
    EXPECT_EQ(frame.field.size(), n);
    EXPECT_EQ(frame.colliders, places);
    ASSERT_EQ(frame.arrows.size(), arrows.size());
    EXPECT_EQ(frame.arrows[0], 0);
    for (std::size_t i = 1; i < arrows.size(); ++i)  // directions: the largest component is at most 1
      ASSERT_LE(std::abs(frame.arrows[i] - arrows[i]), 0.51F / 32767);
    EXPECT_THROW(decode_frame(encoded(given).substr(0, 64 + 8 * n)), InputError);
  }
}

TEST(FrameCodec, SendsTheEndsOfTheBoxAndOfTheFieldExactly) {
  const std::vector<float> positions = {-1, 2, 0, 3, 5, 0}, field = {-4, 12};
  const DecodedFrame frame = decode_frame(encoded({.positions = positions, .field = field}));
  EXPECT_EQ(frame.positions, positions);
  EXPECT_EQ(frame.field, field);
  EXPECT_TRUE(frame.normals.empty());
}

TEST(FrameCodec, SendsWhatIsNotANumberAsZero) {
  const std::vector<float> positions = {0, 0, 0, 1, nan, 1, 2, 4, infinity};
  const std::vector<float> field = {nan, 1, -infinity}, normals = {nan, nan, nan, 0, 0, 0, 0, 0, 1};
  const std::string bytes = encoded({.positions = positions, .normals = normals, .field = field});
  const DecodedFrame frame = decode_frame(bytes);
  EXPECT_EQ(frame.positions[4], 0);
  EXPECT_NEAR(frame.positions[3], 1, 2.0 / 65535);
  std::uint16_t step = 1;
  std::memcpy(&step, bytes.data() + bytes.size() - 6, 2);
  EXPECT_EQ(step, 0);
  EXPECT_TRUE(std::isnan(frame.field[0]));
  EXPECT_EQ(frame.field[1], 1);
  EXPECT_TRUE(std::isnan(frame.field[2]));
}

TEST(FrameCodec, SendsAConstantFieldAsItsLeastValue) {
  const std::vector<float> positions(6, 1.5F), field(2, 3);
  const DecodedFrame frame = decode_frame(encoded({.positions = positions, .field = field}));
  EXPECT_EQ(frame.field, field);
  EXPECT_EQ(frame.positions, positions);
}

TEST(FrameCodec, HasTheLengthOfTheProtocolAndUsesItsMemoryAgain) {
  std::string bytes;
  encode_frame(SampleFrame(5).frame(), bytes);
  EXPECT_EQ(bytes.size(), 64u + 32 + 12 + 10);  // 30 and 10 bytes, padded to fours; the field is last
  EXPECT_EQ(bytes.substr(0, 4), "RSF1");
  const char* memory = bytes.data();
  encode_frame(SampleFrame(4).frame(), bytes);
  EXPECT_EQ(bytes.data(), memory);
  EXPECT_EQ(decode_frame(bytes).field.size(), 4u);
}

TEST(FrameCodec, RefusesWhatIsNoFrame) {
  const std::string bytes = encoded(SampleFrame(5).frame());
  EXPECT_THROW(decode_frame(bytes.substr(0, 40)), InputError);
  EXPECT_THROW(decode_frame(bytes.substr(0, bytes.size() - 1)), InputError);
  std::string other = bytes;
  other[3] = '2';
  EXPECT_THROW(decode_frame(other), InputError);
}

TEST(Topology, HoldsTrianglesAndEdgesOfEachPartAndRestPlaces) {
  const ShownSurface surface{World(small_bar(3, true))};
  const std::string bytes = encode_topology(surface);
  EXPECT_EQ(bytes.substr(0, 4), "RST1");
  const ShownSurface::Part& part = surface.parts()[0];
  const auto triangles = static_cast<std::size_t>(part.num_triangles),
             edges = static_cast<std::size_t>(part.num_edges),
             tetrahedra = static_cast<std::size_t>(part.num_tetrahedra),
             vertices = static_cast<std::size_t>(surface.num_vertices());
  EXPECT_EQ(bytes.size(), 8 + 12 * triangles + 8 * edges + 16 * tetrahedra + 12 * vertices);
  float first_place = -1;
  std::memcpy(&first_place, bytes.data() + 8 + 12 * triangles + 8 * edges + 16 * tetrahedra, 4);
  EXPECT_EQ(first_place, surface.rest_positions()[0]);
}

/// A bar under a ball that comes down and a paddle that turns beside it.
Description bar_with_colliders(int dim) {
  Description scene = small_bar(dim, true);
  ColliderDescription ball;
  ball.name = "ball";
  ball.kind = "sphere";
  ball.shape.center = {0.5, 5, 0};
  ball.shape.radius = 0.25;
  ball.velocity = {0, -1, 0};
  ball.until = 2;
  ColliderDescription paddle;
  paddle.name = "paddle";
  paddle.kind = "box";
  paddle.shape.center = {-5, 0, 0};
  paddle.shape.size = {2, 0.5, 1};
  paddle.rotate = ColliderTurn{.axis = Vector3::UnitZ(), .center = {-5, 0, 0}, .degrees_per_second = 45};
  scene.colliders = {ball, paddle};
  return scene;
}

TEST(FrameCodec, SaysWhereCollidersAre) {
  const World world(bar_with_colliders(3));
  const std::vector<ShownCollider> colliders = shown_colliders(world);
  for (const double time : {0.0, 1.0, 3.0}) {
    const std::vector<float> places = collider_places(colliders, {.time = time});
    for (const std::size_t n :
         {4U, 5U}) {  // with a field that is a multiple of four bytes, and one that is not
      const SampleFrame sample(n);
      LiveFrame frame = sample.frame();
      frame.colliders = places;
      const DecodedFrame read = decode_frame(encoded(frame));
      EXPECT_EQ(read.colliders, places);
      EXPECT_EQ(read.field.size(), n);
      EXPECT_EQ(encoded(frame).size() % 4, 0U);
    }
    ASSERT_EQ(places.size(), 2 * numbers_per_collider);
    for (std::size_t c = 0; c < 2; ++c) {
      const Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>> place(places.data() + 12 * c);
      const Vector3 X(0.3, -0.2, 0.1);
      const Vector3 x = (place.leftCols<3>() * X.cast<float>() + place.col(3)).cast<double>();
      EXPECT_LT((x - colliders[c].place({.time = time})(X)).norm(), 1e-5) << colliders[c].name << time;
    }
  }
}

TEST(Topology, EndsWithTheFacetsOfColliders) {
  for (const int dim : {2, 3}) {
    const World world(bar_with_colliders(dim));
    const ShownSurface surface(world);
    const std::vector<ShownCollider> colliders = shown_colliders(world);
    const std::string bodies = encode_topology(surface), all = encode_topology(surface, colliders);
    EXPECT_EQ(all.substr(0, bodies.size()), bodies);
    std::size_t size = 0;
    for (const ShownCollider& collider : colliders)
      size += 12 * collider.mesh.vertices.size() + 4 * collider.mesh.facets.size();
    EXPECT_EQ(all.size(), bodies.size() + size);
    Index last = -1;
    std::memcpy(&last, all.data() + all.size() - 4, 4);
    EXPECT_EQ(last, colliders.back().mesh.facets.back());
  }
}

}  // namespace
}  // namespace resilin::testing
