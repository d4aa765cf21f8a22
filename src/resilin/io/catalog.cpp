#include "resilin/io/catalog.hpp"

#include <array>

namespace resilin {
namespace {

constexpr char msh_start[] = "$MeshFormat";
constexpr char medit_start[] = "MeshVersionFormatted";
constexpr char xml_start[] = "<?xml";
constexpr char binary_gltf_start[] = "glTF";
constexpr char vtk_start[] = "# vtk DataFile";

template <const char* start>
bool starts_with(std::string_view bytes) {
  return bytes.starts_with(start);
}

bool is_ply(std::string_view bytes) { return bytes.starts_with("ply\n") || bytes.starts_with("ply\r"); }

/// XML of VTK that says so before its data begin; other XML is taken for an unstructured grid.
bool is_poly_data(std::string_view bytes) {
  constexpr std::size_t head = 1000;
  return bytes.starts_with(xml_start) && bytes.substr(0, head).find("type=\"PolyData\"") != bytes.npos;
}

}  // namespace

std::span<const MeshFormat> mesh_formats() {
  static const std::array formats = {
      MeshFormat{"MSH", {"msh"}, starts_with<msh_start>, read_msh, write_msh},
      MeshFormat{"Medit", {"mesh"}, starts_with<medit_start>, read_medit, write_medit},
      MeshFormat{.name = "VTP",
                 .extensions = {"vtp"},
                 .has_signature = is_poly_data,
                 .read = read_vtp,
                 .write = nullptr,
                 .holds_surfaces = true},
      MeshFormat{"VTU", {"vtu"}, starts_with<xml_start>, read_vtu_mesh, write_vtu_mesh},
      MeshFormat{"VTK", {"vtk"}, starts_with<vtk_start>, read_vtk, nullptr},
      MeshFormat{"TetGen", {"node", "ele"}, nullptr, read_tetgen, nullptr},
      MeshFormat{"Vega", {"veg"}, nullptr, read_vega, nullptr},
      MeshFormat{.name = "OBJ",
                 .extensions = {"obj"},
                 .has_signature = nullptr,
                 .read = read_obj,
                 .write = write_obj,
                 .holds_surfaces = true},
      MeshFormat{.name = "STL",
                 .extensions = {"stl"},
                 .has_signature = nullptr,
                 .read = read_stl,
                 .write = nullptr,
                 .holds_surfaces = true},
      MeshFormat{.name = "PLY",
                 .extensions = {"ply"},
                 .has_signature = is_ply,
                 .read = read_ply,
                 .write = nullptr,
                 .holds_surfaces = true},
      MeshFormat{.name = "glTF",
                 .extensions = {"gltf", "glb"},
                 .has_signature = starts_with<binary_gltf_start>,
                 .read = read_gltf,
                 .write = nullptr,
                 .holds_surfaces = true},
  };
  return formats;
}

}  // namespace resilin
