// `resilin plot RUN`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "program.hpp"
#include "temporary_folder.hpp"

namespace resilin::testing {
namespace {

using ::testing::HasSubstr;

struct Plots : ::testing::Test {
  TemporaryFolder folder;
  void SetUp() override {
    std::filesystem::create_directory(folder.path() / "out");
    folder.write("out/report.json", R"({"status": "done", "title": "A & B", "dimension": 2, "frames": [
      {"step": 0, "time": 0.0, "load": 0.0, "energy": {"elastic": 0.0},
       "probes": {"tip": {"displacement": [0.0, 0.0]}}, "reactions": {"wall": [0.0, 0.0]}, "contacts": []},
      {"step": 1, "time": 0.5, "load": 0.5, "energy": {"elastic": 2.0},
       "probes": {"tip": {"displacement": [3.0, -4.0]}}, "reactions": {"wall": [1.0, 0.0]},
       "contacts": [{"bodies": ["a", "b"], "force": [0.0, 2.5]}]}]})");
  }
  ProgramResult plot(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"plot", "out"});
    return run_program(folder.path(), arguments);
  }
};

TEST_F(Plots, ListTheNamesWithUnits) {
  const ProgramResult list = plot({"--list"});
  EXPECT_EQ(list.exit_code, 0) << list.err;
  for (const char* name : {"time [s]\n", "load\n", "energy.elastic [J]\n", "probe.tip.displacement.y [m]\n",
                           "reaction.wall [N]\n", "contact.a.b.force.y [N]\n"})
    EXPECT_THAT(list.out, HasSubstr(name));
}

/// A vector alone is its length; where bodies do not touch there is no number.
TEST_F(Plots, PrintTheNumbersOfTheReport) {
  const ProgramResult table = plot({"--y", "probe.tip.displacement", "--y", "contact.a.b.force.y"});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_EQ(table.out, "time [s],probe.tip.displacement [m],contact.a.b.force.y [N]\n0,0,\n0.5,5,2.5\n");
}

TEST_F(Plots, WriteATableAndAPicture) {
  const ProgramResult both = plot({"--x", "probe.tip.displacement.x", "--y", "reaction.wall.x", "--title",
                                   "a < b", "--out", "c.csv", "--out", "c.svg"});
  EXPECT_EQ(both.exit_code, 0) << both.err;
  EXPECT_EQ(read_text_file(folder.path() / "c.csv"),
            "probe.tip.displacement.x [m],reaction.wall.x [N]\n0,0\n3,1\n");
  const std::string picture = read_text_file(folder.path() / "c.svg");
  for (const char* part : {"<svg xmlns=\"http://www.w3.org/2000/svg\"", "a &lt; b", "reaction.wall.x [N]",
                           "probe.tip.displacement.x [m]", "<polyline"})
    EXPECT_THAT(picture, HasSubstr(part));
}

TEST_F(Plots, TellTheStepsAndTheContactOfColliders) {
  folder.write("out/report.json", R"({"status": "done", "title": "", "dimension": 2, "frames": [
    {"step": 0, "time": 0.0, "load": 1.0, "step_name": "press"},
    {"step": 1, "time": 1.0, "load": 1.0, "step_name": "press",
     "collider_contacts": {"plate": {"force": [0.0, -3.0], "pressure": 5.0, "area": 0.5, "center": [1.0, 2.0]}}},
    {"step": 2, "time": 2.0, "load": 1.0, "step_name": "hold & wait",
     "collider_contacts": {"plate": {"force": [0.0, -4.0], "pressure": 7.0, "area": 0.5, "center": [1.0, 2.0]}}}]})");
  const ProgramResult both =
      plot({"--y", "contact.plate.pressure", "--out", "c.csv", "--out", "c.svg", "--out", "c.png"});
  EXPECT_EQ(both.exit_code, 0) << both.err;
  EXPECT_EQ(read_text_file(folder.path() / "c.csv"),
            "time [s],contact.plate.pressure [Pa],step_name\n0,,press\n1,5,press\n2,7,hold & wait\n");
  const std::string picture = read_text_file(folder.path() / "c.svg");
  EXPECT_THAT(picture, HasSubstr(">press</text>"));
  EXPECT_THAT(picture, HasSubstr(">hold &amp; wait</text>"));
  EXPECT_THAT(picture, HasSubstr("line class=\"step\""));
  const std::string pixels = read_text_file(folder.path() / "c.png");
  EXPECT_EQ(pixels.substr(1, 3), "PNG");
  EXPECT_GT(pixels.size(), 2000U);
  const ProgramResult list = plot({"--list"});
  for (const char* name :
       {"contact.plate.area [m^2]\n", "contact.plate.force.y [N]\n", "contact.plate.center.x [m]\n"})
    EXPECT_THAT(list.out, HasSubstr(name));
}

/// A sheet that is compressed evenly: its displacement is linear along a side.
TEST_F(Plots, TellFieldsAlongALineAndTheirSmallestValues) {
  folder.write("sheet.toml", R"(
[simulation]
dimension = 2
load_steps = 2
[[body]]
name = "sheet"
mesh = { box = { size = [1, 1], cells = [3, 3], origin = [-1, 0] } }
material = { law = "neo_hookean", youngs_modulus = 1e6, poissons_ratio = 0.3 }
[[fix]]
where = { group = "y_min" }
components = "y"
[[fix]]
where = { group = "x_max" }
components = "x"
[[fix]]
name = "top"
where = { group = "y_max" }
components = "y"
displacement = [0, -0.1]
)");
  ASSERT_EQ(run_program(folder.path(), {"run", "sheet.toml", "--out", "out", "--quiet"}).exit_code, 0);
  const ProgramResult line = plot({"--y", "displacement.y", "--along", "-1", "0", "-1", "1"});
  EXPECT_EQ(line.exit_code, 0) << line.err;
  std::istringstream rows(line.out);
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row, "distance [m],displacement.y [m]");
  int num_rows = 0;
  for (; std::getline(rows, row); ++num_rows) {
    const std::size_t comma = row.find(',');
    EXPECT_NEAR(std::stod(row.substr(comma + 1)), -0.1 * std::stod(row), 1e-8) << row;
  }
  EXPECT_EQ(num_rows, 201);
  // Half of the way at half of the load, by its smallest value on the line.
  const ProgramResult least =
      plot({"--x", "load", "--smallest", "--y", "displacement.y", "--along", "-1", "0", "-1", "1"});
  EXPECT_EQ(least.exit_code, 0) << least.err;
  std::istringstream loads(least.out);
  std::getline(loads, row);
  EXPECT_EQ(row, "load,smallest displacement.y [m]");
  for (int i = 0; i <= 2; ++i) {
    ASSERT_TRUE(std::getline(loads, row));
    EXPECT_NEAR(std::stod(row), 0.5 * i, 1e-12);
    EXPECT_NEAR(std::stod(row.substr(row.find(',') + 1)), -0.05 * i, 1e-8);
  }
  for (const auto& [arguments, expected] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--y", "displacment", "--along", "0", "0", "0", "1"}, "did you mean \"displacement\"?"},
           {{"--y", "displacement", "--along", "0", "0", "0", "0"}, "two different points"},
           {{"--y", "displacement", "--along", "0", "0", "0", "1", "--body", "shet"}, "\"sheet\""},
           {{"--y", "displacement", "--along", "0", "0", "0", "0", "1", "0"}, "a scene in 2D: 4 numbers"},
           {{"--y", "displacement", "--smallest"}, "--along with two points"},
           {{"--y", "displacement", "--along", "0", "0", "0", "1", "--frame", "9"}, "0 to 2"},
       }) {
    const ProgramResult refused = plot(arguments);
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err, HasSubstr(expected));
  }
}

TEST_F(Plots, RefuseInOneLineWhatTheyCannotPlot) {
  EXPECT_THAT(plot({"--y", "reaction.wal.x"}).err, HasSubstr("did you mean \"reaction.wall.x\"?"));
  EXPECT_THAT(plot({"--x", "tine", "--y", "load"}).err, HasSubstr("did you mean \"time\"?"));
  EXPECT_THAT(plot({}).err, HasSubstr("--list prints all names"));
  const ProgramResult ending = plot({"--y", "load", "--out", "a.pdf"});
  EXPECT_EQ(ending.exit_code, 1);
  EXPECT_THAT(ending.err, HasSubstr("a name that ends in .csv, .svg or .png"));
  EXPECT_EQ(run_program(folder.path(), {"plot", "nowhere", "--list"}).exit_code, 1);
}

}  // namespace
}  // namespace resilin::testing
