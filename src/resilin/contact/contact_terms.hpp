#pragma once

#include <array>
#include <span>
#include <vector>

#include "resilin/collision/moving_point.hpp"
#include "resilin/contact/contact_surface.hpp"

namespace resilin {

/// One pair's part of the energy of contact: stiffness m b(d), m a mollifier of edges that are nearly
/// parallel.
///
/// A point feels the surface as a whole: the sum over the triangles near it, less what their common edges
/// count twice, plus what vertices miss then. So a term may have a negative stiffness; the sum that a point
/// feels is never negative. Source: Li et al. 2023, "Convergent Incremental Potential Contact", 4.
struct ContactTerm {
  PairKind kind;
  std::array<Index, most_pair_vertices> vertices;  ///< of the surface, those of the first part first
  double stiffness;                                ///< [Pa m^2], in 2D [Pa m] on unit thickness
  double mollifier_threshold;                      ///< of EdgeMollifier [m^4]; 0 for pairs that have none

  std::span<const Index> used_vertices() const {
    return std::span(vertices).first(static_cast<std::size_t>(num_vertices(kind)));
  }
};

/// Those of the candidates that are nearer than the activation distance in one of the states, with what
/// belongs to them, in an order that does not depend on the number of threads.
/// @param states  where the vertices are, each of dim numbers per vertex [m]
std::vector<ContactTerm> contact_terms(const ContactSurface& surface, const SurfaceCandidates& candidates,
                                       std::span<const VectorX* const> states, double activation_distance);

}  // namespace resilin
