#include "resilin/view/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "resilin/view/header.hpp"
#include "resilin/view/surface_fields.hpp"
#include "small_scenes.hpp"

namespace resilin::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Page, TellsItsSourceAndCarriesTheNonceOfItsProgram) {
  const std::string live = page_with(source_script("live"), "");
  EXPECT_EQ(live.size(), page_bytes().size());
  EXPECT_THAT(live.substr(0, 20), HasSubstr("<!doctype html>"));
  const std::string recorded = page_with(source_script("recorded"), "abc");
  EXPECT_THAT(recorded,
              HasSubstr(R"(<script id="source" type="application/json">{"kind": "recorded"}</script>)"));
  EXPECT_THAT(recorded, Not(HasSubstr(R"({"kind": "live"})")));
  EXPECT_THAT(recorded, HasSubstr(R"(<script id="program" nonce="abc">)"));
}

TEST(Page, LoadsNothingFromElsewhere) {
  const std::string page = page_with(source_script("live"), "");
  for (const char* link : {"src=\"http", "href=\"http", "@import", "url(http"})
    EXPECT_THAT(page, Not(HasSubstr(link)));
}

TEST(ViewHeader, DescribesPartsAndFields) {
  const World world(small_bar(3, true));
  const ShownSurface surface(world);
  const std::vector<ScalarField> fields = SurfaceFields::quick(3);
  const json header = json::parse(encode_header(
      {.title = "A <bar>", .version = "1.2", .gravity = {0, 0, -9.81}, .fields = fields}, world, surface));
  EXPECT_EQ(header["title"], "A <bar>");
  EXPECT_EQ(header["dimension"], 3);
  EXPECT_EQ(header["extent"], world.largest_extent());
  EXPECT_EQ(header["up"], json({0, 0, 1}));
  EXPECT_EQ(header["gravity"], json({0, 0, -9.81}));
  ASSERT_EQ(header["parts"].size(), 1U);
  EXPECT_EQ(header["parts"][0]["kind"], "cells");
  EXPECT_EQ(header["parts"][0]["num_vertices"], surface.num_vertices());
  ASSERT_EQ(header["fields"].size(), fields.size());
  EXPECT_EQ(header["fields"][0], json({{"name", "displacement"},
                                       {"label", "displacement"},
                                       {"unit", "m"},
                                       {"group", "displacement"},
                                       {"scale", 1.0}}));
  EXPECT_EQ(header["parts"][0]["num_tetrahedra"], surface.parts()[0].num_tetrahedra);
  EXPECT_EQ(header["marks"].size(), 2U) << "wall and tip";
  EXPECT_EQ(header["fields"][1]["label"], "displacement x");
}

TEST(ViewHeader, OfAPlaneHasYUp) {
  const World world(small_bar(2, true));
  const ShownSurface surface(world);
  const json header = json::parse(encode_header({.title = {}, .version = {}, .fields = {}}, world, surface));
  EXPECT_EQ(header["up"], json({0, 1, 0}));
  EXPECT_EQ(header["forces_per_metre"], true);
}

TEST(ViewHeader, SaysThatAPlaneIsAHalfSection) {
  Description description = small_bar(2, true);
  const auto header = [&description] {
    const World world(description);
    const ShownSurface surface(world);
    return json::parse(encode_header({.title = {}, .version = {}, .fields = {}}, world, surface));
  };
  EXPECT_FALSE(header().contains("axisymmetric"));
  description.bodies[0].element = "P1 axisymmetric";
  EXPECT_EQ(header()["axisymmetric"], true);
}

TEST(ViewHeader, SaysThatForcesAreThoseOfTheThickness) {
  Description description = small_bar(2, true);
  description.thickness = 0.01;
  const World world(description);
  const ShownSurface surface(world);
  const json header = json::parse(encode_header({.title = {}, .version = {}, .fields = {}}, world, surface));
  EXPECT_EQ(header["forces_per_metre"], false);
}

}  // namespace
}  // namespace resilin::testing
