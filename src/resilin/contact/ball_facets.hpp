#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "resilin/contact/contact_surface.hpp"
#include "resilin/contact/contact_terms.hpp"
#include "resilin/contact/term_sums.hpp"

namespace resilin {

/// Place and size of a rigid ball.
struct Ball {
  Vector3 center;
  double radius;  ///< [m]
};

/// The facets of bodies' surfaces that a ball meets: its centre is a point that stays farther than the radius
/// away from them, and feels each surface as a whole, once (contact_terms.hpp).
///
/// Nodes are kept out by `ColliderBarrier`. A ball that is large beside the facets touches nodes before it
/// dips into a facet, so that the facets of such bodies are left out here.
class BallFacets {
 public:
  /// @param surface            whose last body is an obstacle of one point, at the centre
  /// @param rest_positions     of all nodes [m]
  /// @param radius             the least that the ball has [m]
  BallFacets(ContactSurface surface, const VectorX& rest_positions, double radius,
             double activation_distance);

  /// True where no body has facets that are large beside the ball.
  bool empty() const { return facets_.empty(); }
  const ContactSurface& surface() const { return surface_; }
  Index center() const { return static_cast<Index>(surface_.parts.num_vertices()) - 1; }

  /// The places of the vertices, the centre's last, and the terms of the facets within the activation
  /// distance.
  struct Contact {
    VectorX places;
    std::vector<ContactTerm> terms;
  };
  Contact contact(const VectorX& x, const Ball& ball) const;
  TermSet set(const Contact& contact) const { return {surface_, contact.terms}; }
  /// Their forces on the centre [N], with the distances from the ball.
  std::vector<PartForce> part_forces(const VectorX& x, const Ball& ball) const;

  /// E(to) - E(from) [J].
  double difference(const VectorX& from, const VectorX& to, const Ball& ball) const;

  /// How much of their ways, from 0 to 1, nodes and centre may go until some facet is left with
  /// `left(distance)` of its distance [m], which has to be less.
  double free_share(const VectorX& x, const VectorX& p, const Ball& ball, const Vector3& way_of_ball,
                    const std::function<double(double)>& left) const;

  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  ///< from the ball [m]; negative: it dips in
    std::array<Index, 3> vertices{-1, -1, -1};                  ///< vertices of the facet, in 2D two
  };
  Nearest nearest(const VectorX& x, const Ball& ball) const;

  /// The gradient of a coordinate vector at the centre.
  Vector3 at_center(const VectorX& of_vertices) const;
  /// A vector that is zero but for the centre.
  VectorX only_center(const Vector3& value) const;

 private:
  VectorX places(const VectorX& x, const Ball& ball) const;
  const std::vector<Index>& all_corners() const;  ///< corners of the surface's triangles, in 2D edges
  std::span<const Index> corners(Index facet) const;
  double distance_of(Index facet, const VectorX& places) const;
  /// Candidates of the centre within its reach.
  void add_near(const VectorX& places, double reach, std::vector<Candidate>& near) const;
  template <int dim>
  void add_near_in(const VectorX& places, double reach, std::vector<Candidate>& near) const;
  template <int dim>
  double free_share_in(const VectorX& x, const VectorX& p, const Ball& ball, const Vector3& way_of_ball,
                       const std::function<double(double)>& left) const;
  ContactTerms terms(std::vector<Candidate> near, double radius) const;

  ContactSurface surface_;
  double activation_distance_;
  std::vector<Index> facets_;  ///< triangles, in 2D edges
};

}  // namespace resilin
