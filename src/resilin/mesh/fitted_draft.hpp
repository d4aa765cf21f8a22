#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "resilin/mesh/delaunay.hpp"
#include "resilin/mesh/surface_features.hpp"
#include "resilin/mesh/surface_places.hpp"

namespace resilin {

/// A point of a fitted mesh and what it follows.
struct FittedVertex {
  enum class Kind : std::uint8_t { corner, line, surface, inside };

  Vector3 X;
  Kind kind = Kind::inside;
  Index line = -1;                   ///< line of the surface's features
  double s = 0;                      ///< place on that line [m]
  Vector3 normal = Vector3::Zero();  ///< normal of the surface there
  double thickness = 0;              ///< thickness of the solid below; infinity where it is not known [m]
  double size = 0;                   ///< wanted edge length there [m]
  Index triangle = -1;               ///< triangle of the surface, that it lies on; a hint
};

/// Points on and in a surface and the Delaunay tetrahedra between them that lie inside.
class FittedDraft {
 public:
  using Nodes = std::array<Index, 4>;

  static constexpr double most_grading =
      20;  ///< largest ratio of `spacing` to the shortest edges that are wanted

  /// @param spacing  of the lattice inside, about the edge length of the cells [m]
  /// @param finest   length of edges where the surface is curved or walls are thin, at least, and never below
  ///                 `spacing` by `most_grading` [m]; 0: two fifths of the spacing where it is curved
  FittedDraft(const SurfacePlaces& places, double spacing, double finest = 0);

  /// Moves the points towards the middles of the cells around them and connects them anew.
  void relax();

  const std::vector<FittedVertex>& vertices() const { return vertices_; }
  const std::vector<Nodes>& cells() const { return cells_; }
  const SurfaceFeatures& features() const { return features_; }
  double spacing() const { return spacing_; }
  /// Pairs of vertices that are neighbours on a line, smaller first, sorted.
  std::vector<std::array<Index, 2>> line_edges() const;
  /// Vertices along each line of `features()`.
  const std::vector<std::vector<Index>>& sequences() const { return sequences_; }

 private:
  struct Side {
    std::array<Index, 3> nodes;  ///< outward
    std::uint8_t* is_fine;       ///< remembers that it is near the surface
  };
  /// Known data of a tetrahedron of `delaunay_`.
  struct Known {
    Index birth = -1;  ///< when it was found out
    bool is_inside = false;
    std::array<std::uint8_t, 4> is_fine{};  ///< sides
  };

  void add_features();
  void add_line(Index line, std::vector<Index>& sequence);
  void add_surface();
  void add_inside();
  void add_finer_inside();
  Index near_feature(const Vector3& X) const;
  Delaunay::Point grid_point(const Vector3& X) const;
  void connect();
  void insert(Index vertex);
  void split_lines();
  void find_cells();
  std::vector<Side> sides();
  void refine_all();
  std::size_t refine();
  double size_at(const SurfacePlace& place) const;
  double most_turning_near(const SurfacePlace& place, double step) const;

  const SurfacePlaces* places_;
  double spacing_, edge_, finest_;
  bool is_graded_;    ///< by the thickness of walls too, and as far as `finest_`
  double least_gap_;  ///< between points that are added and others [m]
  Vector3 middle_;
  double unit_;  ///< unit of the Delaunay grid [m]
  SurfaceFeatures features_;
  std::vector<FittedVertex> vertices_;
  std::vector<std::vector<Index>> sequences_;
  Delaunay delaunay_;
  std::vector<Index> number_of_, vertex_of_;  ///< between vertices and points of `delaunay_`
  std::vector<Known> known_;
  std::vector<std::uint8_t> is_cell_;  ///< tetrahedra of `delaunay_`
  std::vector<Nodes> cells_;
  std::vector<Index> place_of_cell_;  ///< in `delaunay_`
};

}  // namespace resilin
