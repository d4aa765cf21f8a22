#pragma once

#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// A rigid surface of triangles, edges and single points that bodies stay off, in 2D of edges and points.
struct ColliderMesh {
  std::vector<Vector3> vertices;  ///< at the start [m]; z = 0 in 2D
  /// By their vertices, as many as `dim` each. A facet that repeats one is an edge or a single point.
  std::vector<Index> facets;
};

/// The surface of a mesh of solid cells; else its triangles, quadrilaterals, lines and points, by their
/// corners. The vertices of a mesh without cells are points. Vertices of nothing are left out.
ColliderMesh collider_mesh(const Mesh& mesh, int dim);

/// Whether each edge belongs to two triangles, in 2D each vertex to two edges: it then has an inside.
bool is_closed(const ColliderMesh& mesh, int dim);

// Simple shapes, seen from outside anticlockwise.

/// A box along the axes, in 2D a rectangle.
ColliderMesh box_mesh(const Vector3& center, const Vector3& size, int dim);
/// A square of two triangles, in 2D a line of that length, across a normal.
ColliderMesh plate_mesh(const Vector3& center, const Vector3& normal, double side, int dim);
/// A ball, in 2D a disc, with facets as those of the ends of a capsule.
ColliderMesh ball_mesh(const Vector3& center, double radius, int dim);
/// All points within a radius of a segment. Vertices lie on it: flat facets are up to 0.0012 radii inside in
/// 2D and along the segment, and 0.0024 on the ends.
ColliderMesh capsule_mesh(const Vector3& start, const Vector3& end, double radius, int dim);
/// With flat ends, in space. Facets as those of a capsule.
ColliderMesh cylinder_mesh(const Vector3& start, const Vector3& end, double radius);

}  // namespace resilin
