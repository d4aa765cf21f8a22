#pragma once

#include <memory>
#include <string>
#include <vector>

#include "resilin/sensitivity/parameter.hpp"
#include "resilin/sensitivity/tangent.hpp"
#include "resilin/sensitivity/term_changes.hpp"
#include "resilin/simulation/potential.hpp"

namespace resilin {

/// Rest places of the vertices, by body, and deformed places of all nodes, in the scene's coordinates.
struct RestAndDeformed {
  std::vector<VectorX> rest;
  VectorX deformed;
};

/// Whether no support and no spring holds a body along an axis: what it lies on alone bears it.
bool is_free_along(const World& world, const Body& body, int axis);

/// The positions [m] after a translation by a vector [m].
VectorX places_moved(VectorX places, const Vector3& by, int dim);

/// g(x, X) = 0 at the free unknowns, x = support(X) at the fixed ones, and its derivative by
///
///   z = dx - dX,
///
/// in which both are one unknown of each node: at a vertex, which stays where it was drawn, z = -dX; of an
/// added node, whose rest place follows those of the vertices, z says where it goes. Unstrained dg = K z, K
/// being that without contact, which does not see X.
///
/// A rest shape as a whole may be anywhere along an axis along which no support holds the body: there the
/// mean of z is a way of the body as drawn, to where what it lies on bears it.
class RestBalance {
 public:
  /// @param names  of the parameters that are the rest places of each body
  /// @param part   of the loads and of the forces of contact
  RestBalance(Description description, const std::vector<std::string>& names, const RestAndDeformed& shape,
              double part);
  RestBalance(const RestBalance&) = delete;
  RestBalance& operator=(const RestBalance&) = delete;

  bool is_in_domain() const { return potential_.is_in_domain(x_); }
  /// The bodies are outside of what they touch.
  bool is_apart() const;

  /// Forms K; solutions with it are then to be had.
  void form();
  /// As far as solutions with it have told.
  Index unstable_modes() const { return tangent_.is_symmetric() ? tangent_.negative_eigenvalues() : 0; }

  /// Residual: forces at the free DOFs, distances at the fixed ones.
  VectorX residual() const;
  /// K z = residual at the free unknowns, z = residual at the fixed ones; of K the symmetric part, without
  /// contact where supports hold all bodies.
  VectorX preconditioned(const VectorX& residual);
  /// The change of the residual along z.
  VectorX product(const VectorX& z);

  RestAndDeformed moved(const RestAndDeformed& shape, const VectorX& z) const;

 private:
  /// dX of a body's vertices.
  VectorX of_vertices(std::size_t body, const VectorX& z) const;
  WorldChange change_of(const VectorX& z) const;
  /// Change of the collider forces with the reference positions, by their contact areas.
  void add_area_forces(const VectorX& change, VectorX& forces);

  World world_;
  TermLinks links_;
  Conditions conditions_;
  VectorX x_;
  Potential potential_;
  Tangent tangent_;
  std::unique_ptr<Potential> untouched_;  ///< without contact, and its K; null: not asked for
  std::unique_ptr<Tangent> untouched_tangent_;
  std::vector<Parameter> parameters_;
  World other_areas_;          ///< the same, measured on other rest places
  std::vector<bool> is_free_;  ///< for each body along each axis
};

}  // namespace resilin
