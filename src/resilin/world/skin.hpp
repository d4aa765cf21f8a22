#pragma once

#include <memory>
#include <string>
#include <vector>

#include "resilin/mesh/embedding.hpp"
#include "resilin/world/description.hpp"

namespace resilin {

struct Body;

/// The fine surface of a body, carried by its cells.
struct Skin {
  std::string name;        ///< the file, for messages
  CellBlock facets;        ///< triangles; in 2D also lines
  VectorX rest_positions;  ///< 3 per vertex, in 2D the third zero [m]
  Embedding embedding;     ///< embedding of its vertices; nodes are the world's

  Index num_vertices() const { return embedding.num_points(); }
};

/// Places the skin as the body's mesh and embeds it. A skin that stands out of the cells by more than a
/// twentieth of the body's extent is a warning, by more than its whole extent an error: then its unit or
/// place is not that of the mesh.
/// @param body            of the world, with its cells
/// @param rest_positions  of the world's nodes [m]
std::shared_ptr<const Skin> make_skin(const BodyDescription& description, const Body& body,
                                      const VectorX& rest_positions, int dim,
                                      std::vector<std::string>& warnings);

}  // namespace resilin
