#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "resilin/core/error.hpp"
#include "resilin/io/mesh_file.hpp"
#include "shared_data.hpp"
#include "test_names.hpp"

// Every file of tests/data/bad_inputs/index.json gets the answer that the index asks for.

namespace resilin {
namespace {

struct Answer {
  std::string error;                  ///< empty when the file is accepted
  std::vector<std::string> warnings;  ///< one line each
};

std::filesystem::path folder() { return testing::source_folder() / "tests" / "data" / "bad_inputs"; }

/// Message to a user of the file: a surface format is examined as a surface, the others as a 3D solid.
Answer answer_to(const std::string& name) {
  Answer answer;
  try {
    MeshFile file = read_mesh(folder() / name);
    if (file.is_surface) {
      const MeshReport report = check_mesh_file(file);
      report.require_no_errors();
      for (const MeshIssue& issue : report.warnings) answer.warnings.push_back(issue.text());
    } else {
      prepare_solid_mesh(file, 3);
      answer.warnings = file.warnings;
    }
  } catch (const InputError& error) {
    answer.error = error.what();
  }
  return answer;
}

struct Expectation {
  std::string file;
  bool is_error;
  std::vector<std::string> names;  ///< each stands in the message (the error, or one of the warnings)
};

// The words of index.json, "message_must_name", split into what to look for.
const std::vector<Expectation> expectations = {
    {"tet_inverted.msh", false, {"tet_inverted.msh", "element 2"}},
    {"tet_degenerate_flat.msh", true, {"tet_degenerate_flat.msh", "element 1", "volume"}},
    {"vertices_duplicate.msh", false, {"vertices 3 and 6"}},
    {"vertex_unreferenced.msh", false, {"vertex 5"}},
    {"coord_nan.msh", true, {"coord_nan.msh", "line 15", "node 4"}},
    {"empty_file.msh", true, {"empty_file.msh"}},
    {"empty_mesh.msh", true, {"empty_mesh.msh: no elements"}},
    {"truncated_in_nodes.msh", true, {"truncated_in_nodes.msh", "line 16", "$Nodes"}},
    {"count_too_big.msh", true, {"count_too_big.msh", "line 5"}},
    {"index_huge.msh", true, {"index_huge.msh", "element 2", "node id"}},
    {"index_negative.vtk", true, {"index_negative.vtk", "cell 0"}},
    {"binary_garbage.msh", true, {"binary_garbage.msh"}},
    {"wrong_version.msh", true, {"wrong_version.msh", "version 7.3"}},
    {"msh22.msh", false, {}},
    {"crlf.msh", false, {}},
    {"decimal_comma.msh", true, {"decimal_comma.msh", "line 13"}},
    {"mesh2d_in_3d.msh", true, {"mesh2d_in_3d.msh: no tetrahedra (found triangles)"}},
    {"nonmanifold_edge.obj", false, {"edge 1-2"}},
    {"duplicate_element.msh", true, {"elements 1, 3"}},
    {"disconnected.msh", false, {"component 2"}},
    {"obj_index_out_of_range.obj", true, {"obj_index_out_of_range.obj", "line 4"}},
    {"obj_truncated.obj", true, {"obj_truncated.obj", "line 4"}},
    {"vtk_truncated.vtk", true, {"vtk_truncated.vtk", "POINTS"}},
};

class BadInput : public ::testing::TestWithParam<Expectation> {};

TEST_P(BadInput, GetsTheAnswerThatTheIndexAsksFor) {
  const Expectation& expected = GetParam();
  const Answer answer = answer_to(expected.file);
  EXPECT_EQ(!answer.error.empty(), expected.is_error) << answer.error;
  EXPECT_EQ(answer.error.find('\n'), std::string::npos) << "more than one line";
  const std::vector<std::string> lines = expected.is_error ? std::vector{answer.error} : answer.warnings;
  for (const std::string& name : expected.names) {
    const bool is_named = std::any_of(lines.begin(), lines.end(),
                                      [&](const std::string& line) { return line.find(name) != line.npos; });
    EXPECT_TRUE(is_named) << "\"" << name << "\" is not in: " << ::testing::PrintToString(lines);
  }
}

INSTANTIATE_TEST_SUITE_P(Index, BadInput, ::testing::ValuesIn(expectations),
                         [](const auto& test) { return testing::as_test_name(test.param.file); });

TEST(BadInputs, AreAllOfTheIndex) {
  std::ifstream stream(folder() / "index.json");
  std::set<std::string> in_index;
  const nlohmann::json index = nlohmann::json::parse(stream);
  for (const auto& entry : index["files"]) in_index.insert(entry["file"].get<std::string>());
  std::set<std::string> in_test;
  for (const Expectation& expected : expectations) in_test.insert(expected.file);
  EXPECT_EQ(in_test, in_index);
}

TEST(BadInputs, AreTheSharedOnesByteForByte) {
  RESILIN_NEEDS_SHARED_DATA();
  const auto bytes = [](const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  for (const Expectation& expected : expectations) {
    EXPECT_EQ(bytes(folder() / expected.file),
              bytes(*testing::shared_folder() / "bad_inputs" / expected.file))
        << expected.file;
  }
}

TEST(BadInputs, WindowsLineEndsMakeNoDifference) {
  std::ifstream stream(folder() / "crlf.msh", std::ios::binary);
  std::string text(std::istreambuf_iterator<char>(stream), {});
  const MeshFile with_cr = read_mesh_from_memory("crlf.msh", text);
  text.erase(std::remove(text.begin(), text.end(), '\r'), text.end());
  const MeshFile without = read_mesh_from_memory("lf.msh", text);
  EXPECT_EQ(with_cr.mesh.vertices, without.mesh.vertices);
  EXPECT_EQ(with_cr.mesh.blocks[0].nodes, without.mesh.blocks[0].nodes);
}

}  // namespace
}  // namespace resilin
