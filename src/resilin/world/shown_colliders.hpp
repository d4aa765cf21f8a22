#pragma once

#include <string>
#include <vector>

#include "resilin/world/world.hpp"

namespace resilin {

/// A collider as it is drawn: rigid facets, and how they move.
struct ShownCollider {
  std::string name;
  ColliderMesh mesh;  ///< as it was made [m]; of a half-space a square, in 2D a line, below the bodies
  ColliderMotion motion;
  bool is_closed = false;   ///< has an inside
  bool is_endless = false;  ///< a half-space

  RigidPlace place(const Conditions& c) const { return motion.place(c.time - c.delay); }
};

/// All colliders of a world in the order of its reactions: those with an exact distance, then those of
/// facets.
std::vector<ShownCollider> shown_colliders(const World& world);

/// Whether one of them moves.
bool any_collider_moves(const World& world);

/// Colliders as they are at one time, for files and pictures.
struct ColliderFacets {
  Mesh mesh;  ///< triangles, lines and points, in the scene's coordinates [m]
  std::vector<double>
      numbers;  ///< number of each cell's collider in the order of the scene, block after block
};
/// Facets of all colliders, moved to the time of `c`.
ColliderFacets collider_facets(const World& world, const Conditions& c);

}  // namespace resilin
