#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "refusal.hpp"
#include "resilin/io/mesh_file.hpp"

namespace resilin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::refusal;

const std::string head_22 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string nodes_22 = "$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 1 1 1\n$EndNodes\n";
const std::string elements_22 =
    "$Elements\n3\n7 2 2 3 1 10 20 30\n8 4 2 -1 1 10 20 30 40\n9 4 2 0 1 20 30 40 50\n$EndElements\n";

TEST(Msh, KeepsTheNumbersOfTheFileForMessages) {
  const MeshFile file = read_mesh_from_memory("a.msh", head_22 + nodes_22 + elements_22);
  EXPECT_EQ(file.numbering.vertex(2), 30);
  ASSERT_EQ(file.mesh.blocks[1].kind, CellKind::tetrahedron);
  EXPECT_EQ(file.numbering.cell(1, 0), 8);
  EXPECT_EQ(file.mesh.blocks[1].nodes, (std::vector<Index>{0, 1, 2, 3, 1, 2, 3, 4}));
}

TEST(Msh, NamesGroupsByDimensionAndNumberWhenTheFileHasNoName) {
  const MeshFile file = read_mesh_from_memory("a.msh", head_22 + nodes_22 + elements_22);
  EXPECT_EQ(file.mesh.groups.size(), 2u);
  EXPECT_EQ(file.mesh.find_group("surface_3")->vertices, (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(file.mesh.find_group("volume_1")->cells[1],
            (std::vector<Index>{0}));  // the sign is an orientation
}

TEST(Msh, ReadsNamesWithSpaces) {
  const std::string names = "$PhysicalNames\n2\n2 3 \"left side\"\n3 1 \"body\"\n$EndPhysicalNames\n";
  const MeshFile file = read_mesh_from_memory("a.msh", head_22 + names + nodes_22 + elements_22);
  EXPECT_EQ(file.mesh.find_group("left side")->vertices.size(), 3u);
  EXPECT_NE(file.mesh.find_group("body"), nullptr);
}

TEST(Msh, ReadsAScalarPerElementAsAField) {
  const std::string data = "$ElementData\n1\n\"young\"\n1\n0.0\n3\n0\n1\n2\n8 1e5\n9 2e5\n$EndElementData\n";
  const MeshFile file = read_mesh_from_memory("a.msh", head_22 + nodes_22 + elements_22 + data);
  ASSERT_EQ(file.mesh.cell_fields.size(), 1u);
  EXPECT_EQ(file.mesh.cell_fields[0].block, 1u);
  EXPECT_EQ(file.mesh.cell_fields[0].values, (std::vector<double>{1e5, 2e5}));
}

TEST(Msh, WarnsOfAFieldThatLeavesCellsOut) {
  const std::string data = "$ElementData\n1\n\"young\"\n1\n0.0\n3\n0\n1\n1\n8 1e5\n$EndElementData\n";
  const MeshFile file = read_mesh_from_memory("a.msh", head_22 + nodes_22 + elements_22 + data);
  EXPECT_TRUE(file.mesh.cell_fields.empty());
  ASSERT_EQ(file.warnings.size(), 1u);
  EXPECT_THAT(file.warnings[0], HasSubstr("young"));
}

TEST(Msh, PassesOverVectorsPerElementAndSectionsOfOthers) {
  const std::string data =
      "$ElementData\n1\n\"u\"\n1\n0.0\n3\n0\n3\n1\n8 1 2 3\n$EndElementData\n$Surface\n1 2 3\n$EndSurface\n";
  const MeshFile file = read_mesh_from_memory("a.msh", head_22 + nodes_22 + elements_22 + data);
  EXPECT_TRUE(file.mesh.cell_fields.empty());
  EXPECT_TRUE(file.warnings.empty());
}

TEST(Msh, RefusesNumbersGivenTwiceAndSectionsGivenTwice) {
  EXPECT_THAT(refusal("a.msh", head_22 + "$Nodes\n2\n1 0 0 0\n1 1 0 0\n$EndNodes\n"),
              HasSubstr("node 1: given twice"));
  EXPECT_THAT(refusal("a.msh", head_22 + nodes_22 + nodes_22), HasSubstr("second one"));
}

TEST(Msh, AcceptsTheLargestNumbersThatThereAre) {
  const std::string nodes =
      "$Nodes\n4\n9223372036854775807 0 0 0\n-9223372036854775808 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";
  const std::string elements =
      "$Elements\n1\n9223372036854775807 4 1 -9223372036854775808 9223372036854775807 -9223372036854775808 3 "
      "4\n"
      "$EndElements\n";
  const MeshFile file = read_mesh_from_memory("a.msh", head_22 + nodes + elements);
  EXPECT_EQ(file.mesh.blocks[0].nodes, (std::vector<Index>{0, 1, 2, 3}));
}

TEST(Msh, RefusesElementsItDoesNotKnow) {
  EXPECT_THAT(refusal("a.msh", head_22 + nodes_22 + "$Elements\n1\n5 29 0 10 20 30 40\n$EndElements\n"),
              AllOf(HasSubstr("element 5"), HasSubstr("type 29")));
  EXPECT_THAT(refusal("a.msh", head_22 + nodes_22 + "$Elements\n1\n5 4 2 1 1 10 20 30 60\n$EndElements\n"),
              AllOf(HasSubstr("element 5"), HasSubstr("got 60")));
}

TEST(Msh, RefusesCountsThatDoNotAddUp) {
  const std::string head = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  EXPECT_THAT(refusal("a.msh", head + "$Nodes\n1 2 1 2\n3 1 0 1\n1\n0 0 0\n$EndNodes\n"),
              HasSubstr("2 nodes"));
  EXPECT_THAT(refusal("a.msh", head_22 + "$Nodes\n1\n1 0 0 0\n2 1 0 0\n$EndNodes\n"), HasSubstr("$EndNodes"));
}

TEST(Msh, RefusesVersion1WithoutElements) {
  EXPECT_THAT(refusal("a.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n"), HasSubstr("no elements"));
  EXPECT_THAT(refusal("a.msh", "$NOD\n2\n1 0 0 0\n$ENDNOD\n"), HasSubstr("line 4"));
}

/// Numbers as bytes, in either order.
struct Bytes {
  bool is_swapped;
  std::string text;

  template <class T>
  Bytes& add(T value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    if (is_swapped) std::reverse(bytes.begin(), bytes.end());
    text += bytes;
    return *this;
  }
};

/// Gmsh 4.15 no longer writes 4.0 in binary, so the bytes follow the manual: node by node, int tags.
std::string binary_40(bool is_swapped) {
  Bytes file{is_swapped, "$MeshFormat\n4 1 8\n"};
  file.add<std::int32_t>(1).text += "\n$EndMeshFormat\n$Nodes\n";
  file.add<std::uint64_t>(1).add<std::uint64_t>(4);
  file.add<std::int32_t>(1).add<std::int32_t>(3).add<std::int32_t>(0).add<std::uint64_t>(4);
  for (std::int32_t node = 0; node < 4; ++node) {
    file.add<std::int32_t>(node + 1);
    for (std::int32_t axis = 1; axis <= 3; ++axis) file.add<double>(node == axis ? 1 : 0);
  }
  file.text += "\n$EndNodes\n$Elements\n";
  file.add<std::uint64_t>(1).add<std::uint64_t>(1);
  file.add<std::int32_t>(1).add<std::int32_t>(3).add<std::int32_t>(4).add<std::uint64_t>(1);
  for (const std::int32_t number : {1, 1, 2, 3, 4}) file.add<std::int32_t>(number);
  file.text += "\n$EndElements\n";
  return file.text;
}

TEST(Msh, ReadsBinaryOfEitherByteOrder) {
  for (const bool is_swapped : {false, true}) {
    const MeshFile file = read_mesh_from_memory("a.msh", binary_40(is_swapped));
    EXPECT_EQ(file.format, "MSH 4.0");
    EXPECT_EQ(file.mesh.vertices[2], Vector3(0, 1, 0));
    EXPECT_EQ(file.mesh.blocks[0].nodes, (std::vector<Index>{0, 1, 2, 3}));
  }
}

TEST(Msh, RefusesBinaryThatIsCutAnywhere) {
  const std::string whole = binary_40(false);
  const std::size_t last = whole.rfind("$EndElements");
  for (std::size_t size = 0; size < last; ++size)
    EXPECT_NE(refusal("a.msh", whole.substr(0, size)), "") << size;
}

}  // namespace
}  // namespace resilin
