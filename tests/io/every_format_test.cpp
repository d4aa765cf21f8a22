// Properties that every mesh format of the catalogue must have.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <sstream>

#include "resilin/core/error.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/generators.hpp"
#include "shared_data.hpp"
#include "temporary_folder.hpp"

namespace resilin {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string name_of_format(const ::testing::TestParamInfo<std::size_t>& entry) {
  return std::string(mesh_formats()[entry.param].name);
}

std::vector<std::size_t> numbers_of_formats(bool only_written) {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < mesh_formats().size(); ++i)
    if (!only_written || mesh_formats()[i].write != nullptr) numbers.push_back(i);
  return numbers;
}

struct EveryFormat : ::testing::TestWithParam<std::size_t> {
  const MeshFormat& format = mesh_formats()[GetParam()];
  const testing::TemporaryFolder folder;

  std::string file_name(std::string_view extension) const { return "a." + std::string(extension); }
};
INSTANTIATE_TEST_SUITE_P(Catalogue, EveryFormat, ::testing::ValuesIn(numbers_of_formats(false)),
                         name_of_format);

TEST_P(EveryFormat, HasExtensionsOfItsOwnInSmallLetters) {
  EXPECT_FALSE(format.extensions.empty());
  for (const std::string_view extension : format.extensions) {
    EXPECT_TRUE(
        std::ranges::all_of(extension, [](unsigned char c) { return std::islower(c) || std::isdigit(c); }));
    int num_users = 0;
    for (const MeshFormat& other : mesh_formats())
      num_users += static_cast<int>(std::ranges::count(other.extensions, extension));
    EXPECT_EQ(num_users, 1) << extension;
  }
}

TEST_P(EveryFormat, IsListedWhereAFileIsOfNone) {
  try {
    read_mesh_from_memory("a.nothing", "nothing");
    FAIL() << "read as something";
  } catch (const InputError& error) {
    for (const std::string_view extension : format.extensions)
      EXPECT_THAT(error.what(), HasSubstr("." + std::string(extension)));
  }
}

/// In one line that begins with the name of the file; nothing else is thrown.
TEST_P(EveryFormat, RefusesWhatIsNoMesh) {
  for (const std::string_view extension : format.extensions) {
    const std::string name = file_name(extension);
    for (const std::string& bytes : {std::string(), std::string("no mesh\n"), std::string(100, '\0'),
                                     std::string("1 2 3\n4 5 6\n"), std::string("\xff\xfe\n\n\x01")}) {
      try {
        read_mesh_from_memory(name, bytes, [](const std::string&) { return std::string("no mesh"); });
        FAIL() << name << " with " << bytes;
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), StartsWith("a."));
        EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos) << error.what();
      }
    }
  }
}

TEST_P(EveryFormat, IsWrittenOrSaysThatItIsOnlyRead) {
  const Mesh mesh = make_rectangle({1, 1}, {2, 2});
  for (const std::string_view extension : format.extensions) {
    const std::filesystem::path path = folder / file_name(extension);
    if (format.write == nullptr) {
      EXPECT_THROW(write_mesh(path, mesh), InputError);
      EXPECT_FALSE(std::filesystem::exists(path));
    } else {
      write_mesh(path, mesh);
      EXPECT_GT(std::filesystem::file_size(path), 0U);
    }
  }
}

/// The rows of docs/mesh_formats.md that name this extension.
std::vector<std::string> rows_of(std::string_view extension) {
  std::ifstream page(testing::source_folder() / "docs" / "mesh_formats.md");
  std::vector<std::string> rows;
  for (std::string line; std::getline(page, line);)
    if (line.starts_with("| ") && line.find("`." + std::string(extension) + "`") != line.npos)
      rows.push_back(line);
  return rows;
}

/// The text of a cell of such a row, from 0.
std::string cell_of(const std::string& row, int number) {
  std::istringstream cells(row.substr(2));
  std::string text;
  for (int i = 0; i <= number; ++i) std::getline(cells, text, '|');
  const std::size_t begin = text.find_first_not_of(' '), end = text.find_last_not_of(' ');
  return begin == text.npos ? "" : text.substr(begin, end + 1 - begin);
}

TEST_P(EveryFormat, IsDocumentedAsWhatItIs) {
  for (const std::string_view extension : format.extensions) {
    const std::vector<std::string> rows = rows_of(extension);
    EXPECT_FALSE(rows.empty()) << extension;
    const bool is_written =
        std::ranges::any_of(rows, [](const std::string& row) { return cell_of(row, 3) != "-"; });
    EXPECT_EQ(is_written, format.write != nullptr) << extension;
  }
}

bool calls_cells_inverted(const MeshFile& file) {
  return std::ranges::any_of(check_mesh_file(file).warnings, [](const MeshIssue& issue) {
    return issue.text().find("inverted") != std::string::npos;
  });
}

/// A flat mesh is that of a body in 2D, in which triangles go anticlockwise, unless its format holds surfaces
/// alone.
TEST(AFormatOfSurfaces, IsExaminedAsASurface) {
  const MeshFile surface = read_mesh_from_memory("triangle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n");
  EXPECT_TRUE(surface.is_surface);
  EXPECT_FALSE(calls_cells_inverted(surface));
  MeshFile body = surface;
  body.is_surface = false;
  EXPECT_TRUE(calls_cells_inverted(body));
}

struct EveryWrittenFormat : EveryFormat {
  /// As text, as `write_mesh` puts it into a file.
  std::string written(const Mesh& mesh) const {
    std::ostringstream stream;
    format.write(stream, mesh);
    return stream.str();
  }
  Mesh written_and_read(const Mesh& mesh) const {
    const std::filesystem::path path = folder / file_name(format.extensions[0]);
    write_mesh(path, mesh);
    return read_mesh(path).mesh;
  }
};
INSTANTIATE_TEST_SUITE_P(Catalogue, EveryWrittenFormat, ::testing::ValuesIn(numbers_of_formats(true)),
                         name_of_format);

/// Numbers that a short text would round, at places from 1e-7 to 1e6.
Mesh awkward_surface() {
  Mesh surface = extract_surface(make_box({1e6, 2.0 / 3, 0.1}, {2, 1, 2}, {1e-7, -1.0 / 3, 0})).mesh;
  surface.groups.clear();
  return surface;
}

TEST_P(EveryWrittenFormat, KeepsEveryBitAndTheOrderOfTriangles) {
  const Mesh surface = awkward_surface();
  const Mesh back = written_and_read(surface);
  EXPECT_EQ(back.vertices, surface.vertices);
  ASSERT_NE(back.find_block(CellKind::triangle), nullptr);
  EXPECT_EQ(back.find_block(CellKind::triangle)->nodes, surface.find_block(CellKind::triangle)->nodes);
}

TEST_P(EveryWrittenFormat, WritesTheSameBytesAgain) {
  const Mesh surface = awkward_surface();
  EXPECT_EQ(written(surface), written(surface));
  const Mesh back = written_and_read(surface);
  if (back.groups.empty() && back.cell_fields.empty()) {
    EXPECT_EQ(written(written_and_read(back)), written(back));
  }
}

TEST_P(EveryWrittenFormat, IsToldByItsOwnFirstBytesWhateverTheExtension) {
  const std::string bytes = written(awkward_surface());
  const bool has_signature = format.has_signature != nullptr && format.has_signature(bytes);
  EXPECT_EQ(has_signature, format.has_signature != nullptr);
  for (const MeshFormat& other : mesh_formats()) {
    if (&other == &format || other.has_signature == nullptr) continue;
    EXPECT_FALSE(other.has_signature(bytes)) << other.name;
  }
  const std::string name = has_signature ? "a.of_none" : file_name(format.extensions[0]);
  EXPECT_THAT(read_mesh_from_memory(name, bytes).format, StartsWith(std::string(format.name)));
}

/// Wherever a file ends too early: a mesh or an InputError, and nothing else.
TEST_P(EveryWrittenFormat, ReadsOrRefusesWhatWasCut) {
  const std::string bytes = written(awkward_surface());
  const std::string name = file_name(format.extensions[0]);
  int num_refused = 0;
  for (std::size_t cut = 0; cut < bytes.size(); cut += std::max<std::size_t>(1, bytes.size() / 200)) {
    try {
      read_mesh_from_memory(name, std::string_view(bytes).substr(0, cut));
    } catch (const InputError&) {
      ++num_refused;
    }
  }
  EXPECT_GT(num_refused, 0);
}

}  // namespace
}  // namespace resilin
