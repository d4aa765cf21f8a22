#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "resilin/collision/edge_mollifier.hpp"
#include "resilin/contact/barrier.hpp"
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
  std::array<Index, most_pair_vertices> vertices;  ///< vertices of the surface, those of the first part first
  double stiffness;                                ///< [Pa m^2]
  double mollifier_threshold;  ///< threshold of EdgeMollifier [m^4]; 0 for pairs that have none
  double activation_distance;  ///< [m]
  double radius = 0;  ///< radius of the ball around the first vertex, from which the distance counts [m]

  bool operator==(const ContactTerm&) const = default;

  ClampedLogBarrier barrier() const { return {activation_distance, radius}; }
  std::optional<EdgeMollifier> mollifier() const {
    if (mollifier_threshold > 0) return EdgeMollifier{mollifier_threshold};
    return std::nullopt;
  }
  std::span<const Index> used_vertices() const {
    return std::span(vertices).first(static_cast<std::size_t>(num_vertices(kind)));
  }
};

/// Terms in an order that does not depend on the number of threads: those of the points, point by point, then
/// those of edges.
struct ContactTerms {
  std::vector<ContactTerm> terms;
  std::vector<std::size_t> point_begin{0};  ///< first term of each point, and the end of the last

  std::span<const ContactTerm> of_point(std::size_t point) const {
    return std::span(terms).subspan(point_begin[point], point_begin[point + 1] - point_begin[point]);
  }
  std::span<const ContactTerm> of_edges() const { return std::span(terms).subspan(point_begin.back()); }
  std::size_t num_points() const { return point_begin.size() - 1; }
};

/// Active candidates (nearer than their activation distance), one number each: not 0 if active.
struct NearCandidates {
  std::vector<std::uint8_t> points;  ///< against triangles, in 2D edges
  std::vector<std::uint8_t> edges;   ///< in 3D against edges

  /// Those that are near here or there.
  NearCandidates& operator|=(const NearCandidates& others);
  bool operator==(const NearCandidates&) const = default;
};

/// @param places  where the vertices are, dim numbers each [m]
NearCandidates near_candidates(const ContactSurface& surface, const SurfaceCandidates& candidates,
                               const VectorX& places, double activation_distance);

/// The terms of the near candidates with what belongs to them; candidates that are not near change nothing.
ContactTerms contact_terms(const ContactSurface& surface, const SurfaceCandidates& candidates,
                           const NearCandidates& near, double activation_distance);

/// Stiffness that a term follows, relative to its own: that of the softer body, or half of each of two
/// that are alike, the mean of the slopes to both sides.
struct SofterBodies {
  std::array<Index, 2> bodies;
  std::array<double, 2> shares;  ///< d(log stiffness of the term)/d(stiffness of the body) [1/Pa]
};
SofterBodies softer_bodies(const ContactSurface& surface, const ContactTerm& term);

/// The same sum of fewer terms, for vertices in these places: what several terms of a point have of one
/// feature (a corner of six triangles) is one term, and what is nothing is left out.
ContactTerms merged_terms(const ContactSurface& surface, const ContactTerms& terms, const VectorX& places);

/// Terms that differ by what all do: merged where a point has the same before and after.
std::vector<ContactTerm> terms_of_change(const ContactTerms& all, const ContactTerms& merged_before,
                                         const ContactTerms& merged_after);

/// The candidates whose parts are nearest to each other, the first of several.
struct NearestCandidate {
  double distance;  ///< [m]; infinite where there are none
  PairKind kind = PairKind::point_point;
  std::array<Index, most_pair_vertices> vertices{-1, -1, -1, -1};  ///< vertices of the surface
};
NearestCandidate nearest_candidate(const ContactSurface& surface, const SurfaceCandidates& candidates,
                                   const VectorX& places);

}  // namespace resilin
