#include "resilin/io/vtu.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "refusal.hpp"
#include "resilin/core/error.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/mesh/generators.hpp"
#include "shared_data.hpp"
#include "temporary_folder.hpp"

namespace resilin {
namespace {

using ::testing::HasSubstr;

TEST(Vtu, GivesBackEveryArrayBitByBit) {
  const Mesh box = make_box({1, 1, 1}, {2, 1, 1});
  const std::vector<CellBlock> blocks = {box.blocks[0]};
  std::vector<double> displacements;
  for (std::size_t i = 0; i < 3 * box.vertices.size(); ++i)
    displacements.push_back(std::sin(static_cast<double>(i)));
  std::vector<double> stresses;
  for (int i = 0; i < 9 * blocks[0].num_cells(); ++i) stresses.push_back(1e9 / (i + 1));
  std::vector<double> ratios(static_cast<std::size_t>(blocks[0].num_cells()), 1.0);
  ratios[3] = std::numeric_limits<double>::infinity();

  const testing::TemporaryFolder folder;
  write_vtu(folder / "frame.vtu",
            {.points = box.vertices,
             .blocks = blocks,
             .point_data = {{"displacement", 3, displacements}},
             .cell_data = {{"cauchy <\"stress\">", 9, stresses}, {"volume_ratio", 1, ratios}},
             .time = 0.125});
  const VtuContent back = read_vtu(folder / "frame.vtu");
  EXPECT_EQ(back.file.mesh.vertices, box.vertices);
  ASSERT_EQ(back.point_data.size(), 1u);
  EXPECT_EQ(back.point_data[0].name, "displacement");
  EXPECT_EQ(back.point_data[0].components, 3);
  EXPECT_EQ(back.point_data[0].values, displacements);
  ASSERT_EQ(back.cell_data.size(), 2u);
  EXPECT_EQ(back.cell_data[0].name, "cauchy <\"stress\">");
  EXPECT_EQ(back.cell_data[0].values, stresses);
  EXPECT_EQ(back.cell_data[1].values, ratios);
  EXPECT_EQ(back.time, 0.125);
}

TEST(Vtu, RefusesAnArrayOfTheWrongLength) {
  const Mesh box = make_box({1, 1, 1}, {1, 1, 1});
  const std::vector<double> values(5);
  std::ostringstream stream;
  EXPECT_THROW(
      write_vtu(
          stream,
          {.points = box.vertices, .blocks = box.blocks, .point_data = {{"u", 3, values}}, .cell_data = {}}),
      InputError);
  EXPECT_EQ(stream.str(), "");
}

TEST(Vtu, RefusesAFileThatIsCutAnywhere) {
  const Mesh box = make_box({1, 1, 1}, {1, 1, 1});
  std::ostringstream stream;
  write_vtu(stream, {.points = box.vertices, .blocks = box.blocks, .point_data = {}, .cell_data = {}});
  const std::string whole = stream.str();
  const std::size_t last_byte = whole.rfind("\n</AppendedData>");
  for (std::size_t size = 0; size < last_byte; ++size) {
    EXPECT_NE(testing::refusal("a.vtu", whole.substr(0, size)), "") << size;
  }
  EXPECT_EQ(testing::refusal("a.vtu", whole), "");
  EXPECT_EQ(testing::refusal("a.vtu", whole + "\n\n"), "");
  EXPECT_THAT(testing::refusal("a.vtu", whole + "12"), HasSubstr("the end of the file behind </VTKFile>"));
}

TEST(Vtu, TellsOfBytesBehindTheData) {
  for (const char* name :
       {"cube_raw.vtu", "cube_base64.vtu", "cube_compressed.vtu", "cube_raw.vtp", "cube_base64.vtp",
        "cube_compressed.vtp", "cube_ascii.vtu", "cube_inline.vtu", "cube_ascii.vtp", "cube_inline.vtp"}) {
    const std::string whole = read_file(testing::source_folder() / "tests" / "data" / "meshes" / name);
    ASSERT_EQ(testing::refusal(name, whole), "") << name;
    const std::size_t end_of_data = whole.rfind("</AppendedData>"), end = whole.rfind("</VTKFile>");
    const auto with = [&](std::size_t at) { return std::string(whole).insert(at, "#more#"); };
    EXPECT_THAT(testing::refusal(name, whole + "#more#</VTKFile>"), HasSubstr("the end of the file")) << name;
    EXPECT_EQ(testing::refusal(name, std::string(whole).insert(end, "  \n")), "") << name;
    if (end_of_data == whole.npos) continue;
    EXPECT_THAT(testing::refusal(name, with(end_of_data)), HasSubstr("</AppendedData> behind the data, got "))
        << name;
    EXPECT_THAT(testing::refusal(name, with(end)), HasSubstr("</VTKFile> behind the data, got ")) << name;
  }
}

TEST(Vtu, RefusesCellsOfPointsThatDoNotExist) {
  const auto file = [](const std::string& connectivity, const std::string& offsets,
                       const std::string& types) {
    return "<?xml version=\"1.0\"?><VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece "
           "NumberOfPoints=\"3\" "
           "NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 "
           "0</DataArray>"
           "</Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\">" +
           connectivity + "</DataArray><DataArray type=\"Int32\" Name=\"offsets\">" + offsets +
           "</DataArray><DataArray type=\"UInt8\" Name=\"types\">" + types +
           "</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
  };
  EXPECT_EQ(testing::refusal("a.vtu", file("0 1 2", "3", "5")), "");
  EXPECT_THAT(testing::refusal("a.vtu", file("0 1 3", "3", "5")), HasSubstr("cell 0"));
  EXPECT_THAT(testing::refusal("a.vtu", file("0 1 -2", "3", "5")), HasSubstr("cell 0"));
  EXPECT_THAT(testing::refusal("a.vtu", file("0 1 2", "4", "5")), HasSubstr("offset"));
  EXPECT_THAT(testing::refusal("a.vtu", file("0 1", "3", "5")), HasSubstr("offset"));
  EXPECT_THAT(testing::refusal("a.vtu", file("0 1 2", "3", "42")), HasSubstr("cell type"));
  EXPECT_THAT(testing::refusal("a.vtu", file("0 1 nan", "3", "5")), HasSubstr("connectivity"));
  EXPECT_THAT(testing::refusal("a.vtu", file("0 1 2", "3 3", "5")), HasSubstr("offsets"));
}

/// A triangle; each part may be written otherwise.
struct Parts {
  std::string points =
      R"(<Points><DataArray type="Float64" NumberOfComponents="3">0 0 0 1 0 0 0 1 0</DataArray></Points>)";
  std::string connectivity = R"(<DataArray type="Int32" Name="connectivity">0 1 2</DataArray>)";
  std::string offsets = R"(<DataArray type="Int32" Name="offsets">3</DataArray>)";
  std::string more{};  ///< beside points and cells

  std::string text() const {
    return R"(<?xml version="1.0"?><VTKFile type="UnstructuredGrid"><UnstructuredGrid>)"
           R"(<Piece NumberOfPoints="3" NumberOfCells="1">)" +
           points + "<Cells>" + connectivity + offsets +
           R"(<DataArray type="UInt8" Name="types">5</DataArray></Cells>)" + more +
           "</Piece></UnstructuredGrid></VTKFile>";
  }
};

TEST(Vtu, RefusesTwoOfWhatThereCanBeOneOf) {
  const Parts parts;
  EXPECT_EQ(testing::refusal("a.vtu", parts.text()), "");
  EXPECT_THAT(testing::refusal("a.vtu", Parts{.more = parts.points}.text()),
              HasSubstr("expected one <Points>, got 2"));
  EXPECT_THAT(testing::refusal("a.vtu", Parts{.points = parts.points + parts.points + parts.points}.text()),
              HasSubstr("expected one <Points>, got 3"));
  const std::string cells = "<Cells>" + parts.connectivity + "</Cells>";
  EXPECT_THAT(testing::refusal("a.vtu", Parts{.more = cells}.text()),
              HasSubstr("expected one <Cells>, got 2"));
  const std::string data = R"(<CellData><DataArray type="Float64" Name="E">1</DataArray></CellData>)";
  EXPECT_EQ(testing::refusal("a.vtu", Parts{.more = data}.text()), "");
  EXPECT_THAT(testing::refusal("a.vtu", Parts{.more = data + data}.text()), HasSubstr("one <CellData>"));
  EXPECT_THAT(testing::refusal("a.vtu", Parts{.offsets = parts.offsets + parts.offsets}.text()),
              HasSubstr("one DataArray \"offsets\", got 2"));
  std::string twice = parts.points;
  twice.insert(twice.find("</Points>"),
               R"(<DataArray type="Float64" NumberOfComponents="3">0 0 0 1 0 0 0 1 0</DataArray>)");
  EXPECT_THAT(testing::refusal("a.vtu", Parts{.points = twice}.text()),
              HasSubstr("one DataArray of Points, got 2"));
}

TEST(Vtu, RefusesAWrongNumberOfComponents) {
  for (const std::string wrong : {"1", "2", "4", "9", "0", "-3", "three", ""}) {
    const std::string points = "<Points><DataArray type=\"Float64\" NumberOfComponents=\"" + wrong +
                               "\">0 0 0 1 0 0 0 1 0</DataArray></Points>";
    EXPECT_THAT(testing::refusal("a.vtu", Parts{.points = points}.text()),
                HasSubstr("expected NumberOfComponents 3, got \"" + wrong + '"'));
    if (wrong == "1") continue;
    const std::string connectivity = R"(<DataArray type="Int32" Name="connectivity" NumberOfComponents=")" +
                                     wrong + R"(">0 1 2</DataArray>)";
    EXPECT_THAT(testing::refusal("a.vtu", Parts{.connectivity = connectivity}.text()),
                HasSubstr("\"connectivity\": expected NumberOfComponents 1, got \"" + wrong + '"'));
  }
  const std::string unsaid = "<Points><DataArray type=\"Float64\">0 0 0 1 0 0 0 1 0</DataArray></Points>";
  EXPECT_EQ(testing::refusal("a.vtu", Parts{.points = unsaid}.text()), "");
}

TEST(Pvd, ListsFramesWithTheirTimes) {
  const testing::TemporaryFolder folder;
  write_pvd(folder / "frames.pvd", std::vector<PvdEntry>{{0, "frames/0.vtu"}, {0.5, "frames/1 & 2.vtu"}});
  const std::string text = read_file(folder / "frames.pvd");
  EXPECT_THAT(text, HasSubstr("timestep=\"0.5\""));
  EXPECT_THAT(text, HasSubstr("file=\"frames/1 &amp; 2.vtu\""));
}

}  // namespace
}  // namespace resilin
