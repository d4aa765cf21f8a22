#pragma once

#include <cstddef>

#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// Cuts triangles in two, three or four at the middles of edges that are longer than `longest` [m], again and
/// again until there is none: the same surface, without gaps, of smaller triangles. Vertices keep their
/// numbers, and groups of triangles their pieces; fields on triangles go. Other cells stay. Ends early where
/// there would be more than `most_triangles`.
void refine_surface(Mesh& surface, double longest, std::size_t most_triangles = 1'000'000);

}  // namespace resilin
