#pragma once

#include <functional>
#include <string>
#include <vector>

#include "resilin/world/description.hpp"

namespace resilin {

/// Progress of an inverse-design search.
struct RestShapeProgress {
  bool is_judging = false;  ///< a run from the shape that was found goes on
  double share = 0;         ///< share of the loads for which a shape is found, or that the run has raised
  double towards = 0;       ///< share of the loads at which a shape is sought
  int iterations = 0;       ///< iterations of Newton's method, of the search or of the run

  std::string text() const;  ///< "a shape for 50 % of the loads, towards 75 %, iteration 34"
};

/// Tolerances and limits of the search for a stress-free shape.
struct RestShapeOptions {
  double meets = 1e-8;  ///< relative to the size: how near to the target a run from the shape found must end
  double step = 1e-10;  ///< relative to the size: Newton's method ends with a step below
  int max_iterations = 30;      ///< maximum iterations of Newton's method, for each part of the loads
  int max_products = 150;       ///< maximum products of GMRES
  double smallest_part = 0.01;  ///< smallest part of the loads, by which they are raised
  /// Asked between iterations; false: the search is given up (Interrupted).
  std::function<bool(const RestShapeProgress&)> goes_on{};
};

/// A rest shape that its loads deform into what was drawn.
struct RestShape {
  struct OfBody {
    std::string name;
    VectorX rest, deformed;  ///< rest and deformed of its vertices, in the scene [m]
  };
  std::vector<OfBody> bodies;
  /// The given scene from that reference shape: meshes in the bodies' own coordinates, what was selected by
  /// place as drawn by the numbers of its vertices, and where no run begins in the rest shape the one drawn
  /// as its start.
  Description scene;
  /// Largest of a deformed vertex, by a run of its own, from where it was drawn, or from where a body that is
  /// only borne by what it lies on stands in the shape that was drawn [m].
  double distance = 0;
  double size = 0;     ///< size of the bodies as drawn, along the axes [m]
  int iterations = 0;  ///< iterations of Newton's method
  /// Colliders that leave no stress-free shape with the default activation distance: names, and activation
  /// distances at which they do not press on what is drawn, which `scene` has [m].
  std::vector<std::pair<std::string, double>> kept_off;
  /// A line each: colliders that are kept off, where no run begins in the rest shape, inside of a collider,
  /// and which body comes to stand beside where it was drawn.
  std::vector<std::string> warnings;
};

/// Inverse design: finds the reference positions X of all vertices whose equilibrium is the drawn shape of a
/// static scene.
///
/// At deformed places x that are given, balance g(x, X) = 0 is an equation in X alone (and in the places of
/// nodes that an element adds). Newton's method needs no equilibrium on its way; dg/dX acts on vectors, and
/// GMRES solves with dg/dx as preconditioner, of which it is the negative where nothing is strained. Where
/// the loads cannot be taken at once, they are raised in parts. The verdict is that of a run of the scene
/// from the shape found (docs/theory/gradients.md).
///
/// Surfaces that touch in the target shape press there; that force is raised with the loads. Rest shapes on
/// the way may be anywhere, inside of colliders as well: only what is drawn has to be outside. The rest shape
/// found may lie inside, too: a body that is held pressed on a floor. The areas that barriers bear, and how
/// far the scene lets them reach by default, follow the rest shape; of that Newton's method has the areas on
/// exact shapes in its matrix, leaves the rest out and comes to the same place.
///
/// @throws InputError  for motion, for friction, and when no such shape is found: why
RestShape find_rest_shape(Description description, const RestShapeOptions& options = {});

}  // namespace resilin
