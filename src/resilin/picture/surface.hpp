#pragma once

#include <array>
#include <type_traits>
#include <vector>

#include "resilin/io/vtu.hpp"

namespace resilin {

/// Visible surface of a body: the boundary of its cells, in 2D the cells themselves, cut into flat triangles
/// that follow curved facets.
struct DrawnSurface {
  struct Corner {
    Index cell;                                    ///< cell of the frame
    std::array<Index, max_facet_nodes> nodes{};    ///< nodes of the frame; `num_nodes` of them
    std::array<double, max_facet_nodes> shares{};  ///< values of the facet's shape functions
    /// The same, of functions that are linear on the parts that nodes cut the sides into: never negative.
    std::array<double, max_facet_nodes> part_shares{};
    int num_nodes = 0;
    Vector3 normal = Vector3::Zero();  ///< normal of length 1, smooth across facets but not across creases
  };
  struct Line {
    std::vector<Corner> points;
    bool is_feature;  ///< a crease, or the border of a plane body
  };
  int dimension = 3;
  std::vector<std::array<Corner, 3>> triangles;
  std::vector<Line> edges;  ///< edges of the cells' facets, each once

  /// Weighs what `values` has at the nodes, by the facet's shape functions or linearly on its parts.
  template <class Values>
  static auto at(const Corner& corner, const Values& values, bool is_by_parts = false) {
    const auto& shares = is_by_parts ? corner.part_shares : corner.shares;
    std::decay_t<decltype(values(Index{}))> sum = shares[0] * values(corner.nodes[0]);
    for (std::size_t a = 1; a < static_cast<std::size_t>(corner.num_nodes); ++a)
      sum += shares[a] * values(corner.nodes[a]);
    return sum;
  }
};

/// @param points     where the nodes of the frame are shown; normals and creases are those of this shape
/// @param has_skins  the frame lies in space, and its triangles are surfaces to be drawn
DrawnSurface find_surface(const std::vector<CellBlock>& blocks, const std::vector<Vector3>& points,
                          bool has_skins = false);

}  // namespace resilin
