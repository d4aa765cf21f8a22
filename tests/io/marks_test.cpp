// Byte-order marks before a text, and characters in names that a terminal would obey.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "refusal.hpp"
#include "resilin/core/text.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/io/mesh_file.hpp"
#include "resilin/mesh/generators.hpp"
#include "temporary_folder.hpp"

namespace resilin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* utf8_mark = "\xef\xbb\xbf";

/// A small mesh in each format that is text, by file name.
std::map<std::string, std::string> small_meshes() {
  const testing::TemporaryFolder folder;
  const Mesh box = make_box({1, 1, 1}, {1, 1, 1});
  std::map<std::string, std::string> texts;
  for (const char* name : {"a.msh", "a.mesh", "a.vtu", "a.obj"}) {
    write_mesh(folder / name, box);
    texts[name] = read_file(folder / name);
  }
  texts["a.vtk"] =
      "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 "
      "0 0 1\n"
      "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";
  texts["a.veg"] =
      "*VERTICES\n4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n*ELEMENTS\nTET\n1 4 0\n1 1 2 3 4\n";
  return texts;
}

TEST(ByteOrderMark, BeforeAMeshIsPassedOver) {
  for (const auto& [name, text] : small_meshes()) {
    const MeshFile plain = read_mesh_from_memory(name, text);
    const std::string marked_text = utf8_mark + text;
    const MeshFile marked = read_mesh_from_memory(name, marked_text);
    EXPECT_EQ(marked.mesh.vertices, plain.mesh.vertices) << name;
    ASSERT_EQ(marked.mesh.blocks.size(), plain.mesh.blocks.size()) << name;
    for (std::size_t b = 0; b < plain.mesh.blocks.size(); ++b)
      EXPECT_EQ(marked.mesh.blocks[b].nodes, plain.mesh.blocks[b].nodes) << name;
    EXPECT_EQ(marked.format, plain.format);
  }
}

TEST(ByteOrderMark, BeforeBothFilesOfTetGenIsPassedOver) {
  const std::string nodes = std::string(utf8_mark) + "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
  const std::string elements = std::string(utf8_mark) + "1 4 0\n1 1 2 3 4\n";
  const MeshFile file = read_mesh_from_memory("a.node", nodes, [&](const std::string&) { return elements; });
  EXPECT_EQ(file.mesh.vertices.size(), 4u);
}

TEST(ByteOrderMark, OfUtf16IsRefusedWithTheCure) {
  for (const auto& [name, text] : small_meshes()) {
    for (const char* mark : {"\xff\xfe", "\xfe\xff"}) {
      std::string wide = mark;
      for (const char c : text) wide += {c, '\0'};
      EXPECT_THAT(testing::refusal(name, wide), AllOf(HasSubstr(name), HasSubstr("save it as UTF-8")))
          << name;
    }
  }
}

TEST(OneLine, ShowsWhatATerminalWouldObey) {
  EXPECT_EQ(one_line("plain, b\xc3\xa4r, \xf0\x9f\x90\xbb"), "plain, b\xc3\xa4r, \xf0\x9f\x90\xbb");
  EXPECT_EQ(one_line("a\nb\tc\r"), "a\\x0ab\\x09c\\x0d");
  EXPECT_EQ(one_line("\x1b[31mred\x7f"), "\\x1b[31mred\\x7f");
  EXPECT_EQ(one_line("\xc2\x9b"
                     "31m"),
            "\\xc2\\x9b31m")
      << "C1";
  EXPECT_EQ(one_line("\xe2\x80\xae"
                     "txt"),
            "\\xe2\\x80\\xaetxt")
      << "from right to left";
  EXPECT_EQ(one_line(std::string("a\0b", 3)), "a\\x00b");
}

TEST(OneLine, KeepsNoByteThatIsNoUtf8) {
  // Lone, cut, overlong, surrogates, beyond U+10FFFF.
  for (const char* wrong : {"\xff", "\x80", "\xc3", "\xe2\x82", "\xf0\x9f\x90", "\xc0\xaf", "\xe0\x80\xaf",
                            "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xf8\x88\x80\x80\x80"}) {
    const std::string line = one_line(std::string("a") + wrong + "z");
    EXPECT_TRUE(std::ranges::all_of(line, [](char c) { return c >= 0x20 && c < 0x7f; })) << line;
    EXPECT_TRUE(line.starts_with("a\\x") && line.ends_with("z")) << line;
  }
}

TEST(GroupNames, AreShownEscapedInMessages) {
  const testing::TemporaryFolder folder;
  Mesh box = make_box({1, 1, 1}, {1, 1, 1});
  box.groups[0].name =
      "\x1b[2J\x07"
      "bell";
  const InputError error("scene.toml:3: where.group", "one of " + box.groups[0].name, "\"bell\n\"");
  EXPECT_THAT(error.what(), AllOf(HasSubstr("\\x1b[2J\\x07"
                                            "bell"),
                                  Not(HasSubstr("\x1b")), Not(HasSubstr("\n"))));
}

}  // namespace
}  // namespace resilin
