#include "resilin/sweep/sweep_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "resilin/io/atomic_file.hpp"
#include "sweep_scenes.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

const std::string two_scales = "[parameters]\nbody.0.scale = [1, 2]\n";

struct SweepFolderTest : ::testing::Test {
  SheetFolder folder;
  std::string error(const std::string& text) const {
    return error_of([&] {
      const Sweep sweep = folder.sweep(text);
      SweepFolder(folder / "out", sweep);
    });
  }
};

TEST_F(SweepFolderTest, IsOfOneSweep) {
  const Sweep sweep = folder.sweep(two_scales);
  {
    const SweepFolder made(folder / "out", sweep);
  }
  EXPECT_EQ(error(two_scales), "no error");
  EXPECT_THAT(
      error("[parameters]\nbody.0.scale = [1, 3]\n"),
      HasSubstr("one of another: its parameter body.0.scale is [1, 2], not [1, 3]; choose another folder"));
  EXPECT_THAT(error("keep = \"all\"\n" + two_scales), HasSubstr("no error"));
  const Sweep changed = folder.sweep("[parameters]\nbody.0.scale = [1, 3]\n");
  {
    const SweepFolder updated(folder / "out", changed, true);
  }
  EXPECT_THAT(error(two_scales), HasSubstr("one of another"));
}

TEST_F(SweepFolderTest, IsOfOneVersion) {
  const Sweep sweep = folder.sweep(two_scales);
  {
    const SweepFolder made(folder / "out", sweep);
  }
  std::string manifest = read_file(folder / "out" / "sweep.json");
  const std::string version = "\"version\",\n   \"";
  const std::size_t at = manifest.find(version);
  ASSERT_NE(at, manifest.npos);
  manifest.replace(at + version.size(), manifest.find('"', at + version.size()) - at - version.size(),
                   "0.0.7");
  folder.write("out/sweep.json", manifest);
  EXPECT_THAT(error(two_scales),
              HasSubstr("got one of 0.0.7; choose another folder (--out), or run the same version"));
}

TEST_F(SweepFolderTest, IsNoFolderOfARunAndHasNoDamagedList) {
  std::filesystem::create_directories(folder / "out");
  folder.write("out/report.json", "{}");
  EXPECT_THAT(error(two_scales), HasSubstr("the results of a run"));
  std::filesystem::remove(folder / "out" / "report.json");
  for (const std::string text : {"", "{}", "[1]", "{\"identity\": [[1]]}", "not JSON"}) {
    folder.write("out/sweep.json", text);
    EXPECT_THAT(error(two_scales), HasSubstr("expected what a sweep has written")) << text;
  }
}

TEST_F(SweepFolderTest, GivesASceneToOneAtATime) {
  const Sweep sweep = folder.sweep(two_scales);
  SweepFolder first(folder / "out", sweep), second(folder / "out", sweep);
  const SceneHash hash = sweep.hash(0);
  using Claim = SweepFolder::Claim;
  EXPECT_EQ(first.claim(0, hash, false), Claim::taken);
  EXPECT_EQ(first.claim(0, hash, false), Claim::own);
  EXPECT_EQ(second.claim(0, hash, false), Claim::others);
  EXPECT_EQ(second.claim(1, sweep.hash(1), false), Claim::taken);
  first.release(hash);
  EXPECT_EQ(second.claim(0, hash, false), Claim::taken);
  second.append(hash, row_line(failed_row(sweep, 0, SceneStatus::failed, "for a test"), sweep));
  EXPECT_EQ(first.claim(0, hash, false), Claim::finished);
  EXPECT_EQ(first.claim(0, hash, true), Claim::finished);  // it failed while this was open
  SweepFolder third(folder / "out", sweep);
  EXPECT_EQ(third.claim(0, hash, false), Claim::finished);
  EXPECT_EQ(third.claim(0, hash, true), Claim::taken);
}

TEST_F(SweepFolderTest, WritesATableWithQuotes) {
  folder.write("sheet.toml", "title = 't'\n" + pulled_sheet);
  const Sweep sweep = folder.sweep(
      "quantities = [{ of = \"load\", name = 'a \"b\", c' }]\n[parameters]\ntitle = [\"x, y\", \" z\", "
      "\"\"]\n");
  SweepFolder made(folder / "out", sweep);
  for (const std::uint64_t i : {2, 0, 1}) {
    SceneRow row = failed_row(sweep, i, SceneStatus::not_converged, "so,\nit is");
    row.quantities = {{0.5}};
    made.append(row.hash, row_line(row, sweep));
  }
  EXPECT_TRUE(made.write_table());
  const std::string hash0 = sweep.hash(0).text(), hash1 = sweep.hash(1).text(), hash2 = sweep.hash(2).text();
  EXPECT_EQ(
      read_file(folder / "out" / "results.csv"),
      "scene,hash,title,status,\"a \"\"b\"\", c\",steps,newton_iterations,unknowns,seconds,kept,reason\n"
      "0," +
          hash0 +
          ",\"x, y\",not_converged,0.5,0,0,0,0.0,false,\"so,\\x0ait is\"\n"
          "1," +
          hash1 +
          ",\" z\",not_converged,0.5,0,0,0,0.0,false,\"so,\\x0ait is\"\n"
          "2," +
          hash2 + ",,not_converged,0.5,0,0,0,0.0,false,\"so,\\x0ait is\"\n");
}

TEST(Shards, AreReadAndDivideAllScenes) {
  EXPECT_EQ(parse_shard("2/8").number, 2u);
  EXPECT_EQ(parse_shard("2/8").count, 8u);
  for (const std::string text : {"", "0/3", "4/3", "1", "1/", "/2", "a/b", "1/2/3", "-1/2", "1/2 "})
    EXPECT_THAT(error_of([&] { parse_shard(text); }), HasSubstr("i/n with i from 1 to n")) << text;
  for (const std::uint64_t scenes : {0, 1, 5, 16, 17}) {
    std::uint64_t sum = 0;
    for (std::uint64_t i = 1; i <= 4; ++i) sum += Shard{i, 4}.num_scenes(scenes);
    EXPECT_EQ(sum, scenes);
  }
}

}  // namespace
}  // namespace resilin::testing
