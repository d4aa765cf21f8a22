#include "resilin/io/catalog.hpp"

#include <array>

namespace resilin {

std::span<const MeshFormat> mesh_formats() {
  static const std::array formats = {
      MeshFormat{"MSH",
                 {"msh"},
                 [](std::string_view bytes) { return bytes.starts_with("$MeshFormat"); },
                 read_msh,
                 write_msh},
      MeshFormat{"Medit",
                 {"mesh"},
                 [](std::string_view bytes) { return bytes.starts_with("MeshVersionFormatted"); },
                 read_medit,
                 write_medit},
  };
  return formats;
}

}  // namespace resilin
