#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <string>

#include "fuzz_driver.hpp"
#include "resilin/core/error.hpp"
#include "resilin/io/catalog.hpp"
#include "resilin/io/mesh_file.hpp"

// Every outcome of reading a mesh other than a sound mesh or an InputError of one line is a failure.

namespace resilin {
namespace {

void require(bool is_true, const char* what) {
  if (!is_true) throw std::logic_error(what);
}

/// Promises of every reader about its mesh.
void require_sound(const MeshFile& file) {
  const Mesh& mesh = file.mesh;
  const auto is_vertex = [&](Index v) {
    return v >= 0 && static_cast<std::size_t>(v) < mesh.vertices.size();
  };
  require(!mesh.blocks.empty(), "no blocks");
  for (const Vector3& X : mesh.vertices) require(X.allFinite(), "a coordinate is not finite");
  for (const CellBlock& block : mesh.blocks) {
    require(block.nodes.size() % static_cast<std::size_t>(num_nodes(block.kind)) == 0, "half a cell");
    require(std::all_of(block.nodes.begin(), block.nodes.end(), is_vertex), "a node that does not exist");
  }
  for (const Group& group : mesh.groups) {
    require(std::is_sorted(group.vertices.begin(), group.vertices.end()), "group vertices not sorted");
    require(std::all_of(group.vertices.begin(), group.vertices.end(), is_vertex),
            "a group vertex that does not exist");
    require(group.cells.size() <= mesh.blocks.size(), "a group of cells of no block");
    for (std::size_t b = 0; b < group.cells.size(); ++b) {
      for (const Index cell : group.cells[b]) {
        require(cell >= 0 && cell < mesh.blocks[b].num_cells(), "a group cell that does not exist");
      }
    }
  }
  for (const CellField& field : mesh.cell_fields) {
    require(field.values.size() == static_cast<std::size_t>(mesh.blocks[field.block].num_cells()),
            "a field of wrong size");
  }
}

void require_one_line(const std::string& message) {
  require(!message.empty() && message.find('\n') == message.npos, "the message is not one line");
}

/// Runs `work`, which may refuse in words.
template <class Work>
void allow_refusal(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    require_one_line(error.what());
  }
}

/// Whatever can be done with a mesh just read ends in a result or a refusal.
void use(const MeshFile& file) {
  require_sound(file);
  for (const MeshIssue& issue : check_mesh_file(file).warnings) require_one_line(issue.text());
  for (const int dimension : {2, 3}) {
    allow_refusal([&] {
      MeshFile solid = file;
      prepare_solid_mesh(solid, dimension);
      require_sound(solid);
    });
  }
  for (const MeshFormat& format : mesh_formats()) {
    std::ostringstream stream;
    if (format.write != nullptr) allow_refusal([&] { format.write(stream, file.mesh); });
  }
}

void read_and_use(const std::string& name, std::string_view bytes, const Companion& companion) {
  allow_refusal([&] { use(read_mesh_from_memory(name, bytes, companion)); });
}

}  // namespace
}  // namespace resilin

/// Entry for libFuzzer and its kin: the first byte chooses the extension.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array extensions = {"msh", "mesh", "vtu", "vtk", "node", "ele", "veg", "obj", "stl", "ply",
                                     "vtp", "gltf", "glb", "inp", "feb",  "bdf", "unv", "off", "3mf"};
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::string name = std::string("input.") + extensions[data[0] % extensions.size()];
  resilin::read_and_use(name, bytes, [bytes](const std::string&) { return std::string(bytes); });
  return 0;
}

int main(int argc, char** argv) {
  return resilin::testing::fuzz_main(argc, argv, [](const resilin::testing::FuzzInput& input) {
    resilin::read_and_use(input.name, input.bytes, [&input](const std::string& name) {
      const auto found = input.corpus.find(std::filesystem::path(input.name).replace_filename(name).string());
      return found == input.corpus.end() ? std::string() : found->second;
    });
  });
}
