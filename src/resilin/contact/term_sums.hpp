#pragma once

#include <span>

#include "resilin/contact/contact_terms.hpp"
#include "resilin/core/projection.hpp"
#include "resilin/linear/block_matrix.hpp"

/// Sums over the terms of contact, with vertices in places of `dim` numbers each [m]. Terms are evaluated in
/// parallel and added in their order: the same bits for any number of threads.
namespace resilin {

/// The terms and what they are terms of.
struct TermSet {
  const ContactSurface& surface;
  std::span<const ContactTerm> terms;
};

/// [J]; infinite where parts touch.
double sum_of_values(const TermSet& set, const VectorX& places);

/// Difference of the energies between two places of the vertices [J], small differences with their digits.
double sum_of_differences(const TermSet& set, const VectorX& from, const VectorX& to);

/// dE/dy [N] of the vertices, or the sum of its |parts|.
enum class GradientParts { signed_sum, magnitudes };
VectorX sum_of_gradients(const TermSet& set, const VectorX& places,
                         GradientParts parts = GradientParts::signed_sum);

/// dE/dy . along [J] of each term, `along` one number for each of the vertices' coordinates [m].
std::vector<double> slopes_along(const TermSet& set, const VectorX& places, const VectorX& along);

/// Adds `weight` d2E/dx2 [N/m] of the nodes that the vertices follow, projected term by term.
void add_node_hessian(const TermSet& set, const VectorX& places, double weight, Projection projection,
                      BlockMatrix& hessian);

/// Normal force between two features.
struct PartForce {
  PairKind kind;
  std::array<Index, most_pair_vertices> vertices;  ///< vertices of the surface, those of the first part first
  std::array<double, most_pair_vertices> weights;  ///< weights of the closest points: see PairDistance
  Vector3 normal;                                  ///< unit vector from the second to the first
  double distance;                                 ///< [m]
  double force;  ///< on the first part along the normal [N]; negative for a term that others count twice
};
std::vector<PartForce> part_forces(const TermSet& set, const VectorX& places);

/// Its derivatives by the vertex positions.
struct PartForceSlopes {
  std::size_t term;                                        ///< its number
  std::array<Vector3, most_pair_vertices> force;           ///< [N/m]
  std::array<Eigen::Matrix3d, most_pair_vertices> normal;  ///< [1/m]
  std::array<std::array<Vector3, most_pair_vertices>, most_pair_vertices>
      weights;  ///< weights of each, by each [1/m]
};
/// In the order of the forces.
std::vector<PartForceSlopes> part_force_slopes(const TermSet& set, const VectorX& places);

/// d2E/dy2 times displacements of the vertices [N].
VectorX hessian_times(const TermSet& set, const VectorX& places, const VectorX& displacements);

}  // namespace resilin
