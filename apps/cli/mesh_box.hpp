#pragma once

#include <string>

#include "resilin/mesh/edit.hpp"

namespace resilin::cli {

/// "(0, 0, 0) to (1, 1, 1)"
std::string box_text(const BoundingBox& box);

/// Where a mesh file reaches, which has no unit: a long one asks for millimetres.
std::string file_box_text(const Mesh& mesh);

}  // namespace resilin::cli
