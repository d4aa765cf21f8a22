#pragma once

#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/io/mesh_file.hpp"

namespace resilin {

/// The bytes that a reader works on.
struct MeshSource {
  std::string name;  ///< as the user wrote it
  std::string_view bytes;
  Companion companion;  ///< may be empty

  std::string extension() const;                                ///< "msh", lower case, without the point
  std::string name_beside(const std::string& extension) const;  ///< name of the companion with this extension
  /// The bytes of another file that this one names, which lies in its folder or below.
  /// @param place  where it is named, for messages
  /// @param cure   of a mesh whose companions cannot be had
  std::string file_beside(const std::string& other, const std::string& place, const std::string& cure) const;
};

/// A file format: recognised by its first bytes (`signature`, may be null) or by its extension.
struct MeshFormat {
  std::string_view name;
  std::vector<std::string_view> extensions;
  bool (*has_signature)(std::string_view bytes);
  MeshFile (*read)(const MeshSource& source);
  void (*write)(std::ostream& stream, const Mesh& mesh);  ///< null when the format is only read
  bool holds_surfaces = false;                            ///< never solids: see `check_mesh_file`
};

/// All formats. A new one is one file and one line here.
std::span<const MeshFormat> mesh_formats();

/// Readers, one for each format. They throw InputError with the line or byte of a mistake.
MeshFile read_3mf(const MeshSource& source);
MeshFile read_bdf(const MeshSource& source);
MeshFile read_feb(const MeshSource& source);
MeshFile read_gltf(const MeshSource& source);
MeshFile read_inp(const MeshSource& source);
MeshFile read_medit(const MeshSource& source);
MeshFile read_msh(const MeshSource& source);
MeshFile read_obj(const MeshSource& source);
MeshFile read_off(const MeshSource& source);
MeshFile read_ply(const MeshSource& source);
MeshFile read_stl(const MeshSource& source);
MeshFile read_tetgen(const MeshSource& source);
MeshFile read_unv(const MeshSource& source);
MeshFile read_vega(const MeshSource& source);
MeshFile read_vtk(const MeshSource& source);
MeshFile read_vtp(const MeshSource& source);
MeshFile read_vtu_mesh(const MeshSource& source);

/// Writers, one for each format.
void write_medit(std::ostream& stream, const Mesh& mesh);
void write_msh(std::ostream& stream, const Mesh& mesh);
void write_obj(std::ostream& stream, const Mesh& mesh);
void write_vtu_mesh(std::ostream& stream, const Mesh& mesh);

}  // namespace resilin
