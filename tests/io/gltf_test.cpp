#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "refusal.hpp"

// Triangles in glTF files, written by hand.

namespace resilin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::refusal;
using ::testing::StartsWith;

/// Four corners of a square and the 6 indices of its two triangles, as a buffer of 60 bytes.
std::string square_buffer() {
  const float places[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::uint16_t indices[] = {0, 1, 2, 0, 2, 3};
  std::string bytes(60, '\0');
  std::memcpy(bytes.data(), places, 48);
  std::memcpy(bytes.data() + 48, indices, 12);
  return bytes;
}

constexpr const char* gltf_of_squares =
    R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0, "children": [1]}, {"mesh": 0, "translation": [0, 0, 2], "scale": [3, 3, 3]}],
"meshes": [{"name": "square", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
"buffers": [{"byteLength": 60, "uri": "square%201.bin"}],
"bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
{"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}]})";

const Companion square_beside = [](const std::string& name) {
  EXPECT_EQ(name, "square 1.bin");
  return square_buffer();
};

std::string gltf_with(const std::string& old, const std::string& changed) {
  std::string text = gltf_of_squares;
  const std::size_t at = text.find(old);
  EXPECT_NE(at, text.npos) << old;
  return text.replace(at, old.size(), changed);
}

TEST(Gltf, PlacesMeshesByTheNodesAboveThem) {
  const MeshFile file = read_mesh_from_memory("a.gltf", gltf_of_squares, square_beside);
  EXPECT_TRUE(file.is_surface);
  EXPECT_EQ(file.mesh.vertices.size(), 8u);
  EXPECT_EQ(file.mesh.blocks[0].num_cells(), 4);
  EXPECT_EQ(file.mesh.vertices[6], Vector3(3, 3, 2));
  ASSERT_EQ(file.mesh.groups.size(), 1u);
  EXPECT_EQ(file.mesh.groups[0].name, "square");
}

TEST(Gltf, TurnsNodesByQuaternionsAndByMatricesAndKeepsMirroredTrianglesFacingOut) {
  const auto last = [](const std::string& placement) {
    const std::string text = gltf_with("\"translation\": [0, 0, 2], \"scale\": [3, 3, 3]", placement);
    return read_mesh_from_memory("a.gltf", text, square_beside).mesh;
  };
  // A quarter of a turn about z: x becomes y.
  const Mesh turned = last("\"rotation\": [0, 0, 0.7071067811865476, 0.7071067811865476]");
  EXPECT_LT((turned.vertices[4] - Vector3(0, 1, 0)).norm() + (turned.vertices[5] - Vector3(-1, 1, 0)).norm(),
            2);
  const Mesh moved = last("\"matrix\": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]");
  EXPECT_EQ(moved.vertices[5], Vector3(0, 1, 5));
  const Mesh mirrored = last("\"scale\": [-1, 1, 1], \"translation\": [0, 0, 1]");
  for (Index t = 0; t < mirrored.blocks[0].num_cells(); ++t) {
    const auto c = mirrored.blocks[0].cell(t);
    const auto X = [&](std::size_t i) { return mirrored.vertices[static_cast<std::size_t>(c[i])]; };
    const Vector3 u = X(1) - X(0), v = X(2) - X(0);
    EXPECT_EQ(u.x() * v.y() - u.y() * v.x(), 1) << t;
  }
}

TEST(Gltf, CutsStripsAndFansIntoTriangles) {
  for (const char* mode : {"5", "6"}) {
    const std::string text = gltf_with("\"indices\": 1", std::string("\"mode\": ") + mode);
    const MeshFile file = read_mesh_from_memory("a.gltf", text, square_beside);
    EXPECT_EQ(file.mesh.blocks[0].num_cells(), 4) << mode;
  }
  const std::string lines = gltf_with("\"indices\": 1", "\"mode\": 1");
  EXPECT_THAT(refusal("a.gltf", lines, square_beside), HasSubstr("no triangles"));
}

TEST(Gltf, RefusesWhatIsWrongInOneLineThatSaysWhere) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {gltf_with("\"asset\": {\"version\": \"2.0\"}, ", ""), "an \"asset\""},
      {gltf_with("\"children\": [1]", "\"children\": [0]"), "nodes 0: expected a node with one parent"},
      {gltf_with("\"children\": [1]", "\"children\": [7]"), "nodes: expected an entry 7, got 2 entries"},
      {gltf_with("\"children\": [1]", "\"children\": [-1]"), "whole numbers"},
      {gltf_with("\"mesh\": 0, \"trans", "\"mesh\": \"x\", \"trans"),
       "nodes 1: mesh: expected a whole number"},
      {gltf_with("[0, 0, 2]", "[0, 0]"), "nodes 1: translation: expected 3 numbers"},
      {gltf_with("\"count\": 4", "\"count\": 40000000000"), "accessors 0"},
      {gltf_with("\"count\": 6", "\"count\": 7"), "accessors 1"},
      {gltf_with("\"count\": 6", "\"count\": 5"), "three corners for each triangle"},
      {gltf_with("5123", "5126"), "componentType 5121 or 5123 or 5125"},
      {gltf_with("5126", "5120"), "componentType 5126, got 5120; save it without quantization"},
      {gltf_with("\"VEC3\"", "\"VEC2\""), "type \"VEC3\""},
      {gltf_with("\"byteLength\": 60", "\"byteLength\": 61"), "buffers 0: expected 61 bytes, got 60"},
      {gltf_with("square%201.bin", "../secret"), "a file beside this one"},
      {gltf_with("square%201.bin", "https://x.y/z"), "a file beside this one"},
      {gltf_with("\"scene\": 0", "\"extensionsRequired\": [\"KHR_draco_mesh_compression\"], \"scene\": 0"),
       "save it without"},
      {gltf_with("\"byteOffset\": 48", "\"byteOffset\": 12"), "an index below 4"},
      {std::string(gltf_of_squares).substr(0, 300), "the JSON of glTF"},
      {"[1, 2]", "the JSON of glTF"},
  };
  for (const auto& [text, expected] : cases) {
    EXPECT_THAT(refusal("a.gltf", text, square_beside), AllOf(StartsWith("a.gltf"), HasSubstr(expected)));
  }
  EXPECT_THAT(refusal("a.gltf", gltf_of_squares), HasSubstr("save it as .glb"));
}

TEST(Vtp, ReadsPolygonsAndStripsAndSaysWhatIsWrong) {
  const auto file = [](const std::string& offsets, const std::string& more) {
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\">\n<PolyData>\n<Piece "
           "NumberOfPoints=\"4\" NumberOfPolys=\"1\" " +
           more +
           "><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 1 1 0 "
           "0 1 "
           "0</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\">0 1 2 "
           "3</DataArray><DataArray type=\"Int32\" Name=\"offsets\">" +
           offsets +
           "</DataArray></Polys><Strips><DataArray type=\"Int32\" Name=\"connectivity\">0 1 3 "
           "2</DataArray><DataArray type=\"Int32\" Name=\"offsets\">4</DataArray></Strips>"
           "</Piece></PolyData></VTKFile>\n";
  };
  EXPECT_EQ(read_mesh_from_memory("a.vtp", file("4", "")).mesh.blocks[0].num_cells(), 2);
  const Mesh both = read_mesh_from_memory("a.vtp", file("4", "NumberOfStrips=\"1\"")).mesh;
  ASSERT_EQ(both.blocks[0].num_cells(), 4);
  for (Index t = 0; t < 4; ++t) {
    const auto c = both.blocks[0].cell(t);
    const auto X = [&](std::size_t i) { return both.vertices[static_cast<std::size_t>(c[i])]; };
    const Vector3 u = X(1) - X(0), v = X(2) - X(0);
    EXPECT_EQ(u.x() * v.y() - u.y() * v.x(), 1) << t;
  }
  EXPECT_THAT(refusal("a.vtp", file("5", "")), HasSubstr("polygon 0: expected an offset from 0 to 4, got 5"));
  EXPECT_THAT(refusal("a.vtp", file("2", "")), HasSubstr("polygon 0: expected at least 3 points, got 2"));
  EXPECT_THAT(refusal("a.vtp", file("4 4", "")), HasSubstr("1 values, got 2"));
  EXPECT_THAT(refusal("a.vtp", file("x", "")), HasSubstr("expected numbers"));
}

}  // namespace
}  // namespace resilin
