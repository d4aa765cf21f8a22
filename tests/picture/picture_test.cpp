#include "resilin/picture/picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "pictured_bar.hpp"
#include "resilin/core/error.hpp"
#include "resilin/mesh/generators.hpp"
#include "resilin/picture/camera.hpp"
#include "resilin/picture/color_map.hpp"
#include "resilin/picture/surface.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

TEST(Picture, ShowsTheBodyInTheColoursOfItsField) {
  const Image image = draw_picture(bar(), small("x"));
  ASSERT_EQ(image.width, 300);
  ASSERT_EQ(image.pixels.size(), 60000u);
  // From the front the bar is twice as wide as high; viridis goes from violet on the left to yellow.
  EXPECT_EQ(image.at(2, 2), white);
  const Color left = image.at(30, 100), right = image.at(190, 100);
  EXPECT_GT(left.blue, left.green);
  EXPECT_GT(right.green, right.blue + 60);
  EXPECT_GT(count(image, [](Color c) { return c != white; }), 12000);
}

TEST(Picture, HasAColourBarWithAllColoursAndItsText) {
  const Image image = draw_picture(bar(), small("x"));
  // One column of the bar runs through the map from its end to its beginning.
  int column = 0;
  for (int x = 200; x < 300 && column == 0; ++x)
    if (image.at(x, 36) == map_color("viridis", 1 - (36 + 0.5 - 34) / 132)) column = x;
  ASSERT_GT(column, 0);
  for (int y = 40; y < 160; ++y)
    EXPECT_EQ(image.at(column, y), map_color("viridis", 1 - (y + 0.5 - 34) / 132)) << y;
  int dark_beside_it = 0;
  for (int y = 30; y < 170; ++y)
    for (int x = column + 20; x < 300; ++x) dark_beside_it += image.at(x, y).green < 120 ? 1 : 0;
  EXPECT_GT(dark_beside_it, 30);  // digits
}

/// Without its bar a picture keeps the colours, and gives the bar's place to the body.
TEST(Picture, LeavesItsColourBarOutWhereAsked) {
  PictureOptions options = small("x");
  options.caption = "0.1 s";
  const Image with = draw_picture(bar(), options);
  options.shows_bar = false;
  const Image without = draw_picture(bar(), options);
  const auto body = [](Color c) { return c.green > c.red + 20; };  // the middle of the map
  EXPECT_GT(count(without, body), 1.3 * count(with, body));
  EXPECT_EQ(without.at(285, 20), white);
  EXPECT_EQ(without.legend, with.legend);
  options.shows_caption = false;
  EXPECT_GT(count(draw_picture(bar(), options), [](Color c) { return c == white; }),
            count(without, [](Color c) { return c == white; }) + 20);
}

TEST(Picture, IsAnotherForAnotherFieldAndTheSameBitsForTheSame) {
  const std::string first = encode_png(draw_picture(bar(), small("x")));
  EXPECT_EQ(first, encode_png(draw_picture(bar(), small("x"))));
  EXPECT_NE(first, encode_png(draw_picture(bar(), small("number"))));
  EXPECT_EQ(first.substr(1, 3), "PNG");
}

TEST(Picture, OfACellFieldHasOneColourInACell) {
  VtuContent frame = bar();
  PictureOptions options = small("number");
  options.range = {{-1, 1000}};  // all cells but little apart
  const Image narrow = draw_picture(frame, options);
  frame.cell_data[0].values.assign(frame.cell_data[0].values.size(), 500);
  const Image uniform = draw_picture(frame, options);
  const Color middle = uniform.at(110, 100);
  EXPECT_EQ(uniform.at(40, 100), middle);
  EXPECT_EQ(uniform.at(160, 120), middle);
  EXPECT_NE(narrow.at(110, 100), middle);
}

TEST(Picture, ScalesDisplacementsAndShowsTheRestShape) {
  VtuContent frame = bar();
  // A shear: the top moves to the right.
  for (std::size_t i = 0; i < frame.file.mesh.vertices.size(); ++i) {
    Vector3& vertex = frame.file.mesh.vertices[i];
    vertex.x() += vertex.z() - 0.5;
    frame.point_data[1].values[3 * i] = vertex.z();
  }
  const auto body = [](Color c) { return c != white; };
  const int once = count(draw_picture(frame, small("x")), body);
  PictureOptions options = small("x");
  options.scale = 4;
  EXPECT_LT(count(draw_picture(frame, options), body), once);  // wider, so zoomed out
  options.scale = 1;
  options.shows_rest = true;
  EXPECT_NE(encode_png(draw_picture(frame, options)), encode_png(draw_picture(frame, small("x"))));
  frame.point_data.pop_back();
  EXPECT_THAT(error_of(frame, options), HasSubstr("add \"displacement\" to `output.fields`"));
}

TEST(Picture, ShowsBodiesThroughColliders) {
  PictureOptions options = small("");
  const Image bare = draw_picture(bar(), options);
  const Image veiled = draw_picture(bar(), options, walls());
  options.shows_colliders = false;
  EXPECT_EQ(draw_picture(bar(), options, walls()).pixels, bare.pixels);
  // The body as it was, the nearer wall before it, both walls beside it: each a tone of many pixels.
  const auto common_tones = [](const Image& image) {
    std::map<std::array<std::uint8_t, 3>, int> counts;
    for (const Color& c : image.pixels) ++counts[{c.red, c.green, c.blue}];
    return std::ranges::count_if(counts, [](const auto& tone) { return tone.second > 300; });
  };
  EXPECT_EQ(common_tones(bare), 2) << "the body and the white around it";
  EXPECT_EQ(common_tones(veiled), 4);
}

TEST(Picture, ComesNearerToBodiesThanToCollidersFarAway) {
  const Image bare = draw_picture(bar(), small(""));
  Mesh far = walls();
  for (Vector3& vertex : far.vertices) vertex.x() += 100;
  EXPECT_EQ(draw_picture(bar(), small(""), far).pixels, bare.pixels);
}

TEST(Picture, LinesOfCollidersLeaveTheWordsBesideTheBarFree) {
  PictureOptions options = small("x");
  options.width = 1350;
  options.height = 900;
  options.label = "a name of a field that is so long that it stands above the end of the body, too";
  Mesh line;
  line.vertices = {Vector3(2.4, 0.5, -100), Vector3(2.4, 0.5, 100)};
  line.block(CellKind::line).nodes = {0, 1};
  const Image image = draw_picture(bar(), options, line);
  std::vector<bool> has_line;
  for (int y = 0; y < image.height; ++y) {
    bool is_there = false;
    for (int x = 0; x < image.width; ++x) is_there |= image.at(x, y) == Color{128, 136, 146};
    has_line.push_back(is_there);
  }
  EXPECT_TRUE(has_line.front() && has_line.back());
  const auto title = std::find(has_line.begin(), has_line.begin() + 153, false);  // the bar begins at 0.17
  ASSERT_NE(title, has_line.begin() + 153) << "it ends above the title";
  const auto below = std::find(title, has_line.end(), true);
  EXPECT_GT(below - title, 20) << "as far as the title is high";
  EXPECT_LT(below - title, 90) << "and goes on below it";
}

TEST(Picture, ShowsEdgesOnADarkGround) {
  PictureOptions options = small("x");
  options.is_dark = true;
  const Image plain = draw_picture(bar(), options);
  options.edges = "on";
  EXPECT_LT(plain.at(2, 2).red, 60);
  EXPECT_NE(encode_png(plain), encode_png(draw_picture(bar(), options)));
}

TEST(Picture, RefusesWhatIsNotThere) {
  EXPECT_EQ(error_of(bar(), small("stres")),
            "field: expected a field of the frame (x, displacement, number, stress), got \"stres\"; "
            "`output.fields` of the scene says what frames hold");
  EXPECT_THAT(error_of(bar(), small("stress")), HasSubstr("expected a component of stress (xx, xy,"));
  EXPECT_THAT(error_of(bar(), small("stress.ab")), HasSubstr("got \"ab\""));
  EXPECT_THAT(error_of(bar(), small("x.y")), HasSubstr("it is one number"));
  EXPECT_EQ(error_of(bar(), small("displacement.z")), "");
  PictureOptions options = small("x");
  options.view = "frnt";
  EXPECT_THAT(error_of(bar(), options), HasSubstr("did you mean \"front\"?"));
  options.view = "1,-2,1";
  EXPECT_EQ(error_of(bar(), options), "");
  options.width = 3;
  EXPECT_THAT(error_of(bar(), options), HasSubstr("64 to 8192 pixels"));
  EXPECT_THAT(error_of(VtuContent{}, small("")), HasSubstr("tetrahedra"));
}

TEST(Surface, OfQuadraticCellsIsCurved) {
  // A triangle whose middle nodes lie on the unit circle, with its corners.
  std::vector<Vector3> points;
  const auto on_circle = [&points](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    points.emplace_back(std::cos(angle), std::sin(angle), 0);
  };
  for (const double degrees : {0, 120, 240, 60, 180, 300}) on_circle(degrees);
  const DrawnSurface surface = find_surface({{CellKind::triangle6, {0, 1, 2, 3, 4, 5}}}, points);
  double area = 0;
  for (const auto& triangle : surface.triangles) {
    std::array<Vector3, 3> p;
    for (std::size_t i = 0; i < 3; ++i)
      p[i] = DrawnSurface::at(triangle[i],
                              [&](Index n) -> Vector3 { return points[static_cast<std::size_t>(n)]; });
    area += 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).z();
  }
  // The straight triangle has 1.30. Three parabolas of height 1/2 over sides of sqrt 3 add 2/3 of their
  // boxes.
  EXPECT_NEAR(area, std::sqrt(3) * 0.75 + 3 * 2.0 / 3 * std::sqrt(3) * 0.5,
              0.06);  // cut into 6 pieces a side
  EXPECT_EQ(surface.edges.size(), 3u);
}

/// A value of 1 at one node and 0 at the others stays between, reaches 0 half-way, and all nodes make 1.
TEST(Surface, OfQuadraticCellsHasPartsOnWhichValuesAreLinear) {
  const std::vector<Vector3> points = {{0, 0, 0},   {1, 0, 0},     {0, 1, 0},
                                       {0.5, 0, 0}, {0.5, 0.5, 0}, {0, 0.5, 0}};
  const DrawnSurface surface = find_surface({{CellKind::triangle6, {0, 1, 2, 3, 4, 5}}}, points);
  for (const auto& triangle : surface.triangles)
    for (const DrawnSurface::Corner& corner : triangle) {
      const auto place = [&](Index n) -> Vector3 { return points[static_cast<std::size_t>(n)]; };
      const Vector3 x = DrawnSurface::at(corner, place);
      // The nodes reproduce places, and each is heard of where it is, never below zero.
      EXPECT_LT((DrawnSurface::at(corner, place, true) - x).norm(), 1e-14);
      double sum = 0;
      for (Index node = 0; node < 6; ++node) {
        const double share = DrawnSurface::at(corner, [&](Index n) { return n == node ? 1.0 : 0.0; }, true);
        EXPECT_GE(share, -1e-15);
        EXPECT_EQ(share > 1 - 1e-12, (place(node) - x).norm() < 1e-12);
        sum += share;
      }
      EXPECT_NEAR(sum, 1, 1e-15);
    }
}

/// Beside a node that is pressed and others that are not, contact's fields do not turn negative as others do.
TEST(Picture, OfContactStaysBetweenTheValuesOfItsNodes) {
  VtuContent frame;
  frame.file.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0, 0}, {0.5, 0.5, 0}, {0, 0.5, 0}};
  frame.file.mesh.blocks = {{CellKind::triangle6, {0, 1, 2, 3, 4, 5}}};
  frame.point_data = {{"contact_pressure", 1, {1, 0, 0, 0, 0, 0}},
                      {"heat", 1, {1, 0, 0, 0, 0, 0}},
                      {"zero", 1, {0, 0, 0, 0, 0, 0}}};
  const auto num_blue = [&](const std::string& field) {
    PictureOptions options = small(field);
    options.map = "diverging";
    options.range = {-0.2, 0.2};
    return count(draw_picture(frame, options), [](Color pixel) { return pixel.blue > pixel.red + 10; });
  };
  EXPECT_LE(num_blue("contact_pressure"), num_blue("zero"));  // the colour bar and an axis are blue, too
  EXPECT_GT(num_blue("heat"), num_blue("zero") + 200);
}

TEST(Surface, OfHexahedraHasTheirOuterSides) {
  std::vector<Vector3> points;
  const std::array<Vector3, 4> square = {Vector3(0, 0, 0), {0, 1, 0}, {0, 1, 1}, {0, 0, 1}};
  for (const double x : {0.0, 1.0, 2.0})
    for (const Vector3& corner : square) points.push_back(corner + x * Vector3::UnitX());
  const DrawnSurface surface =
      find_surface({{CellKind::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 8, 9, 10, 11}}}, points);
  EXPECT_EQ(surface.triangles.size(), 10u * 2 * 36);  // ten quadrilaterals, each of 6 x 6 pairs
  const auto is_feature = [](const DrawnSurface::Line& line) { return line.is_feature; };
  EXPECT_EQ(std::ranges::count_if(surface.edges, is_feature), 16);  // the four edges in the middle are flat
}

/// Yellow stays yellow in the shade: every colour of a lit body is one of the bar, hardly darker.
TEST(Picture, KeepsTheColoursOfTheBarUnderItsLight) {
  PictureOptions options = small("x");
  options.view = "1,-1,0.3";
  const Image image = draw_picture(bar(), options);
  int found = 0, near = 0, dark_yellow = 0;
  for (int y = 20; y < 130; y += 2)
    for (int x = 60; x < 210; x += 2) {
      const Color pixel = image.at(x, y);
      if (std::max({pixel.red, pixel.green, pixel.blue}) - std::min({pixel.red, pixel.green, pixel.blue}) <
          40)
        continue;
      double nearest = 1e9;
      for (int i = 0; i <= 128; ++i) {
        const Color color = map_color("viridis", i / 128.0);
        for (const double shade : {0.8, 0.85, 0.9, 0.95, 1.0})
          nearest =
              std::min(nearest, std::hypot(pixel.red - shade * color.red, pixel.green - shade * color.green,
                                           pixel.blue - shade * color.blue));
      }
      near += nearest < 12 ? 1 : 0;
      ++found;
      dark_yellow += pixel.red > 0.9 * pixel.green && pixel.blue < 0.5 * pixel.red && pixel.red < 185 ? 1 : 0;
    }
  EXPECT_GT(found, 750);
  EXPECT_GT(near, 0.97 * found) << "all but the pixels at its outline";
  EXPECT_EQ(dark_yellow, 0) << "olive";
}

TEST(Picture, WritesNothingButPng) {
  const TemporaryFolder folder;
  const Image image = draw_picture(bar(), small("x"));
  for (const char* name : {"it", "it.jpg", "it.webp"})
    EXPECT_THROW(write_png(folder / name, image), InputError) << name;
  write_png(folder / "it.png", image);
  EXPECT_EQ(folder.read("it.png"), encode_png(image));
}

/// A plate in the plane y = 0 is looked at from the side that shows it, a lying one from above.
TEST(Camera, ChoosesTheDirectionThatTellsMost) {
  const auto plate = [](const Vector3& u, const Vector3& v) {
    return std::vector<Vector3>{Vector3::Zero(), u, v, u, u + v, v};
  };
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ();
  EXPECT_GT(std::abs(telling_direction(plate(x, z), {}, z).y()), 0.7);
  EXPECT_GT(std::abs(telling_direction(plate(y, z), {}, z).x()), 0.7);
  EXPECT_GT(telling_direction(plate(x, y), {}, z).z(), 0.6) << "from above, not from the edge";
  // A cube that has moved along y is looked at from where that is seen.
  std::vector<Vector3> cube;
  for (const auto& [u, v] : {std::pair(x, y), std::pair(y, z), std::pair(z, x)})
    for (const Vector3& corner : plate(u, v)) cube.push_back(corner);
  const Vector3 seen = telling_direction(cube, std::vector<Vector3>(cube.size(), y), z);
  const Vector3 unmoved = telling_direction(cube, {}, z);
  EXPECT_LE(std::abs(seen.y()), std::abs(unmoved.y()) + 1e-12);
  // The page's first look where nothing speaks for another.
  EXPECT_LT((page_direction(z, 0, 0.28) -
             Vector3(std::sin(0.55) * std::cos(0.28), -std::cos(0.55) * std::cos(0.28), std::sin(0.28)))
                .norm(),
            1e-12);
}

TEST(Camera, LooksFromWhereItsNameSays) {
  const Camera front = make_camera(3, "front", axis_of("z"));
  EXPECT_EQ(front.toward, Vector3(0, -1, 0));
  EXPECT_EQ(front.up, Vector3(0, 0, 1));
  EXPECT_EQ(front.right, Vector3(1, 0, 0));
  EXPECT_EQ(make_camera(3, "top", axis_of("z")).up, Vector3(0, 1, 0));
  EXPECT_EQ(make_camera(3, "front", axis_of("y")).toward, Vector3(0, 0, 1));
  EXPECT_EQ(make_camera(2, "iso", axis_of("z")).toward, Vector3(0, 0, 1));
  for (const std::string& view : view_names())
    for (const char* up : {"x", "y", "z"}) {
      const Camera camera = make_camera(3, view, axis_of(up));
      EXPECT_NEAR(camera.right.cross(camera.up).dot(camera.toward), 1, 1e-14) << view << up;
    }
}

}  // namespace
}  // namespace resilin::testing
