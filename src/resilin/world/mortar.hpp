#pragma once

#include <functional>
#include <string>
#include <vector>

#include "resilin/mesh/mesh.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// How the nodes of a surface follow another surface in the weak sense (docs/theory/ties.md):
///
///   own v_a = sum_m weight_m u_m,   u = v, but for middles of edges, which also follow the edge's ends
///
/// by dual shape functions, integrated exactly over the parts where facets of both overlap.
struct MortarRow {
  Index node;
  double own = 0;  ///< [m^2], in 2D [m]
  std::vector<WeightedNode> of_leader{};
  std::vector<Index> neighbours{};  ///< nodes of its facets
  std::vector<Index> ends{};        ///< ends of the edge in whose middle it is; empty for a corner
  double share_of_ends = 0;         ///< u = (1 - 2 share) v + share (u_0 + u_1)
};

/// @param facets, leader  outward facets in the world's numbering
/// @param max_distance    [m]
/// @param is_plain        nodes whose displacement is known: theirs is not spread on corners
/// Throws InputError beginning with `place` where facets of the surface have no counterpart.
std::vector<MortarRow> mortar_rows(int dim, const CellBlock& facets, const CellBlock& leader,
                                   const VectorX& rest_positions, double max_distance,
                                   const std::function<bool(Index)>& is_plain, const std::string& place);

/// The mean size of facets: a length [m].
double mean_size(int dim, const CellBlock& facets, const VectorX& rest_positions);

}  // namespace resilin
