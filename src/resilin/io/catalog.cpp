#include "resilin/io/catalog.hpp"

#include <array>

namespace resilin {
namespace {

constexpr char medit_start[] = "MeshVersionFormatted";
constexpr char binary_gltf_start[] = "glTF";
constexpr char zip_start[] = "PK\3\4";
constexpr char vtk_start[] = "# vtk DataFile";

template <const char* start>
bool starts_with(std::string_view bytes) {
  return bytes.starts_with(start);
}

bool is_msh(std::string_view bytes) { return bytes.starts_with("$MeshFormat") || bytes.starts_with("$NOD"); }

bool is_ply(std::string_view bytes) { return bytes.starts_with("ply\n") || bytes.starts_with("ply\r"); }

/// XML with this word before its data begin.
bool is_xml_with(std::string_view bytes, std::string_view word) {
  constexpr std::size_t head = 1000;
  const bool is_xml =
      bytes.starts_with("<?xml") || bytes.starts_with("<VTKFile") || bytes.starts_with("<febio");
  return is_xml && bytes.substr(0, head).find(word) != bytes.npos;
}

bool is_poly_data(std::string_view bytes) { return is_xml_with(bytes, "type=\"PolyData\""); }
bool is_xml_of_vtk(std::string_view bytes) { return is_xml_with(bytes, "<VTKFile"); }
bool is_feb(std::string_view bytes) { return is_xml_with(bytes, "<febio_spec"); }

}  // namespace

std::span<const MeshFormat> mesh_formats() {
  static const std::array formats = {
      MeshFormat{"MSH", {"msh"}, is_msh, read_msh, write_msh},
      MeshFormat{"Medit", {"mesh"}, starts_with<medit_start>, read_medit, write_medit},
      MeshFormat{.name = "VTP",
                 .extensions = {"vtp"},
                 .has_signature = is_poly_data,
                 .read = read_vtp,
                 .write = nullptr,
                 .holds_surfaces = true},
      MeshFormat{"VTU", {"vtu"}, is_xml_of_vtk, read_vtu_mesh, write_vtu_mesh},
      MeshFormat{"VTK", {"vtk"}, starts_with<vtk_start>, read_vtk, nullptr},
      MeshFormat{"TetGen", {"node", "ele"}, nullptr, read_tetgen, nullptr},
      MeshFormat{"Vega", {"veg"}, nullptr, read_vega, nullptr},
      MeshFormat{"Abaqus", {"inp"}, nullptr, read_inp, nullptr},
      MeshFormat{"FEBio", {"feb"}, is_feb, read_feb, nullptr},
      MeshFormat{"Nastran", {"bdf", "nas"}, nullptr, read_bdf, nullptr},
      MeshFormat{"UNV", {"unv"}, nullptr, read_unv, nullptr},
      MeshFormat{.name = "OBJ",
                 .extensions = {"obj"},
                 .has_signature = nullptr,
                 .read = read_obj,
                 .write = write_obj,
                 .holds_surfaces = true},
      MeshFormat{.name = "OFF",
                 .extensions = {"off"},
                 .has_signature = nullptr,
                 .read = read_off,
                 .write = nullptr,
                 .holds_surfaces = true},
      MeshFormat{.name = "3MF",
                 .extensions = {"3mf"},
                 .has_signature = starts_with<zip_start>,
                 .read = read_3mf,
                 .write = nullptr,
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
