#include "resilin/world/description_image.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "resilin/core/archive.hpp"
#include "resilin/core/error.hpp"
#include "resilin/world/fingerprint.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

/// Descriptions that need not make sense, with other values in every member.
class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}

  double number() { return std::uniform_real_distribution(-1e6, 1e6)(random_); }
  int whole(int end) { return std::uniform_int_distribution(0, end - 1)(random_); }
  bool coin() { return whole(2) == 1; }
  Vector3 vector() { return {number(), number(), number()}; }
  Eigen::Matrix3d matrix() {
    return Eigen::Matrix3d::NullaryExpr([this] { return number(); });
  }
  std::string text() {
    std::string text(static_cast<std::size_t>(whole(6)), ' ');
    for (char& c : text) c = static_cast<char>(whole(256));
    return text;
  }
  template <class Make>
  auto list(const Make& make) {
    std::vector<decltype(make())> list;
    for (int i = whole(4); i > 0; --i) list.push_back(make());
    return list;
  }
  template <class Make>
  auto maybe(const Make& make) {
    return coin() ? std::optional(make()) : std::nullopt;
  }
  std::vector<double> numbers() {
    return list([this] { return number(); });
  }

  Mesh mesh() {
    Mesh mesh = coin() ? make_box({1, 2, 3}, {1, 1, 2}) : make_rectangle({1, 2}, {2, 1});
    mesh.vertices[0] = vector();
    mesh.groups[0].name = text();
    mesh.cell_fields = {{text(), 0, numbers()}};
    return mesh;
  }
  Where where() {
    return {static_cast<Where::Kind>(whole(7)),
            text(),
            vector(),
            vector(),
            whole(3),
            number(),
            maybe([this] { return number(); }),
            vector(),
            number(),
            {whole(9), whole(9)},
            vector(),
            maybe([this] { return vector(); }),
            number()};
  }
  Rotation rotation() { return {vector(), vector(), number()}; }
  TimeFunction time_function() {
    switch (whole(4)) {
      case 0:
        return {TimeFunction::Table{numbers(), numbers()}};
      case 1:
        return {TimeFunction::Sine{number(), number(), number(), number()}};
      case 2:
        return {TimeFunction::Ramp{number(), number()}};
      default:
        return {};
    }
  }
  MaterialDescription material() {
    return {text(),
            text(),
            {{text(), number()}, {text(), number()}},
            {{text(), numbers()}},
            list([this] { return list([this] { return vector(); }); }),
            number(),
            maybe([this] {
              return ViscoelasticDescription{text(), numbers(), numbers(), numbers(),
                                             static_cast<Moduli>(whole(2))};
            }),
            maybe([this] { return MullinsDescription{text(), number(), number(), number()}; })};
  }
  BodyDescription body() {
    BodyDescription body;
    body.place = text();
    body.name = text();
    body.mesh = mesh();
    body.mesh_name = text();
    body.element = text();
    body.quadrature = text();
    body.material = material();
    body.scale = number();
    body.rotate = maybe([this] { return rotation(); });
    body.translate = vector();
    body.velocity = vector();
    body.velocity_gradient = matrix();
    body.initial_positions = numbers();
    body.initial_velocities = numbers();
    body.contact_shape = numbers();
    body.mass = static_cast<MassKind>(whole(2));
    body.damping = {number(), number(), number(), number()};
    body.skin = maybe([this] { return SkinDescription{text(), mesh(), text(), coin()}; });
    return body;
  }
  Description description() {
    Description d;
    d.title = text();
    d.is_dynamic = coin();
    d.dimension = 2 + whole(2);
    d.thickness = number();
    d.gravity = vector();
    d.time_step = number();
    d.adaptive = maybe([this] { return AdaptiveSteps{number(), number(), std::nullopt}; });
    d.modes = maybe([this] { return ModesOptions{whole(9), coin()}; });
    d.load_control = static_cast<LoadControlKind>(whole(2));
    d.bodies = list([this] { return body(); });
    d.fixes = list([this] {
      FixDescription fix;
      fix.name = text();
      fix.where = where();
      fix.components = {coin(), coin(), coin()};
      fix.gradient = matrix();
      fix.rotate = maybe([this] { return rotation(); });
      fix.time_function = time_function();
      return fix;
    });
    d.loads = list([this] {
      LoadDescription load;
      load.value = vector();
      load.point = maybe([this] { return vector(); });
      load.until = maybe([this] { return number(); });
      load.time_function = time_function();
      return load;
    });
    d.colliders = list([this] {
      ColliderDescription collider;
      collider.shape = {vector(), vector(), vector(), number(), vector(), vector(),
                        vector(), mesh(),   text(),   number(), vector()};
      collider.displacement = vector();
      collider.time_function = time_function();
      collider.rotate = maybe([this] { return ColliderTurn{vector(), vector(), number(), number()}; });
      collider.stiffness = maybe([this] { return number(); });
      return collider;
    });
    d.probes = list([this] { return ProbeDescription{text(), text(), text(), vector()}; });
    d.sections = list([this] { return SectionDescription{text(), text(), text(), whole(3), number()}; });
    d.newton = {number(), whole(99), whole(9), static_cast<ProjectionChoice>(whole(4)),
                static_cast<InversionBound>(whole(2))};
    d.output = {whole(9), list([this] { return text(); }),
                list([this] { return static_cast<OutputFormat>(whole(3)); })};
    return d;
  }

 private:
  std::mt19937 random_;
};

TEST(DescriptionImage, ComesBackBitByBit) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Description description = Dice(seed).description();
    const std::string image = serialize(description);
    const Description back = deserialize_description(image, "scene.bin");
    ASSERT_EQ(serialize(back), image) << seed;
    EXPECT_EQ(back.title, description.title);
    EXPECT_EQ(fingerprint_of(back), fingerprint_of(description));
    ASSERT_EQ(back.bodies.size(), description.bodies.size());
    for (std::size_t b = 0; b < back.bodies.size(); ++b) {
      EXPECT_EQ(back.bodies[b].mesh.vertices, description.bodies[b].mesh.vertices);
      EXPECT_EQ(back.bodies[b].material.constants, description.bodies[b].material.constants);
      EXPECT_EQ(back.bodies[b].material.fibres, description.bodies[b].material.fibres);
    }
  }
}

TEST(DescriptionImage, GivesTheSameWorld) {
  for (const int dim : {2, 3}) {
    const Description description = small_bar(dim, true);
    Simulation ours(deserialize_description(serialize(description), "scene.bin")), theirs(description);
    for (int i = 0; i < 3; ++i) {
      ours.step();
      theirs.step();
    }
    EXPECT_EQ(serialize(ours.state()), serialize(theirs.state()));
  }
}

std::string refusal_of_image(const std::string& image) {
  try {
    deserialize_description(image, "scene.bin");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(DescriptionImage, IsRefusedWhenItIsDamagedAnywhere) {
  const std::string image = serialize(Dice(3).description());
  for (std::size_t at = 0; at < image.size(); at += 1 + image.size() / 300) {
    EXPECT_THAT(refusal_of_image(image.substr(0, at)), HasSubstr("scene.bin")) << at;
    std::string flipped = image;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x20);
    EXPECT_THAT(refusal_of_image(flipped), HasSubstr("scene.bin")) << at;
  }
  EXPECT_THAT(refusal_of_image(image + "x"), HasSubstr("scene.bin"));
  EXPECT_EQ(refusal_of_image(image), "");
}

/// With a hash that is right: counts are not trusted, and what comes is a description or a refusal.
TEST(DescriptionImage, IsNeverTrustedWhenItIsForged) {
  const std::string image = serialize(Dice(5).description());
  const std::string mark = image.substr(0, image.find('\n') + 1);
  std::mt19937 random(1);
  int num_refused = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string content = image.substr(mark.size(), image.size() - mark.size() - sizeof(std::uint64_t));
    for (int i = 0; i < 3; ++i)
      content[std::uniform_int_distribution<std::size_t>(0, content.size() - 1)(random)] =
          static_cast<char>(random() % 256);
    if (round % 3 == 0) content.resize(std::uniform_int_distribution<std::size_t>(0, content.size())(random));
    num_refused += refusal_of_image(sealed(mark, content)).empty() ? 0 : 1;
  }
  EXPECT_GT(num_refused, 500);
}

}  // namespace
}  // namespace resilin::testing
