#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "resilin/energy/material_point.hpp"
#include "resilin/view/normals.hpp"
#include "resilin/world/world.hpp"

namespace resilin {

/// Drawn surfaces of a moving world (docs/view_protocol.md): of each body the surface of its cells (in 2D the
/// cells themselves), and its skin when it has one. Cells of a rigid body are those of its mesh. Vertices,
/// triangles and edges are numbered over all parts; every vertex belongs to one of them or to a tetrahedron.
///
/// Facets of second order are cut into four flat triangles at the nodes in the middle of their edges,
/// quadrilaterals into two. What is inside, for a cut to show, are tetrahedra between the nodes: cells of
/// second order are cut into eight, hexahedra into six. Nodes on no facet stand behind those of the surface.
class ShownSurface {
 public:
  enum class Kind { skin, cells };
  /// For all bodies together: beyond that the inside is left out, for it would make most of what is sent.
  static constexpr std::size_t most_inside_vertices = 200'000;

  struct Part {
    std::string name;      ///< name of the body
    std::size_t body = 0;  ///< number in World::bodies
    Kind kind = Kind::cells;
    Index first_vertex = 0, num_vertices = 0;
    Index first_triangle = 0, num_triangles = 0;
    Index first_edge = 0, num_edges = 0;
    Index first_tetrahedron = 0, num_tetrahedra = 0;
    Index num_inside = 0;  ///< number of the last vertices, inside, which no triangle has
  };
  using Triangle = VertexNormals::Triangle;
  using Edge = std::array<std::uint32_t, 2>;
  using Tetrahedron = std::array<std::uint32_t, 4>;

  /// Keeps no reference to the world: a world with the same bodies and cells may take its place later (such
  /// as one with other materials). A body's skin stands before its cells.
  enum class Inside { shown_by_cuts, left_out };
  explicit ShownSurface(const World& world, Inside inside = Inside::shown_by_cuts);

  int dimension() const { return dim_; }
  std::span<const Part> parts() const { return parts_; }
  Index num_vertices() const { return num_vertices_; }
  std::span<const Triangle> triangles() const { return triangles_; }  ///< outward; in 2D towards +z
  std::span<const Edge> edges() const { return edges_; }  ///< edges of the cells' facets, each once
  std::span<const Tetrahedron> tetrahedra() const { return tetrahedra_; }    ///< empty in 2D
  std::span<const float> rest_positions() const { return rest_positions_; }  ///< 3 per vertex [m]

  /// @param x    positions of the world's nodes [m]
  /// @param out  3 num_vertices() numbers; in 2D the third is zero
  void positions(const VectorX& x, std::span<float> out) const;

  /// Area-weighted normals of length 1 of the surface at `positions`; (0, 0, 1) where there is no area.
  /// @param positions  3 num_vertices() numbers, as `positions` gives them
  /// @param out        3 num_vertices() numbers
  void normals(std::span<const float> positions, std::span<float> out) const {
    normals_.evaluate(positions, out);
  }

  /// Where a vertex is in the material, for a hand to pull there: of the cells it is the node itself; of a
  /// smooth skin the part that is linear in each cell; of a rigid body what its control nodes carry.
  MaterialPoint material_point(Index vertex) const;

  /// The vertex of the cells that is this node of the world, for a control node the nearest one; none where
  /// the inside is not shown.
  std::optional<Index> vertex_of(Index node) const;

  /// Whether a vertex belongs to what is seen, not to the inside.
  bool is_outside(Index vertex) const;

  /// Where a place lies on the triangles around a vertex.
  struct Touch {
    std::optional<std::size_t> triangle;        ///< none where the vertex itself is nearest
    std::array<std::uint32_t, 3> corners = {};  ///< corners of it, else the vertex
    std::array<double, 3> shares = {1, 0, 0};   ///< shares of the corners, in sum 1
  };
  /// The point of the surface near a vertex that is nearest to a place.
  /// @param positions  3 num_vertices() numbers, as `positions` gives them
  Touch touch(Index vertex, const Vector3& place, std::span<const float> positions) const;
  /// The same as a point of the material.
  MaterialPoint touched_place(Index vertex, const Vector3& place, std::span<const float> positions) const;

  /// The node with the greatest weight in the material point: the one to pin.
  Index nearest_node(Index vertex) const;

  /// A number per node of the world, carried to the vertices.
  void interpolate(std::span<const double> nodal_values, std::span<float> out) const;

 private:
  void add_skin(const std::shared_ptr<const Skin>& skin);
  void add_cells(const Body& body, bool with_inside);
  void carry_by_control_nodes(const World& world, const Body& body);
  void begin_part(const Body& body, std::size_t number, Kind kind);
  void end_part();
  /// Where the vertices of a part come from.
  struct Source {
    std::shared_ptr<const Embedding> carrier;  ///< carrier of a skin and of a rigid body; else null
    std::vector<Index> nodes;                  ///< nodes of cells: the world's node of each vertex
    std::vector<float> own_rest;               ///< at rest, without the rounding of a carrier's weights
    std::map<Index, Index> nearest;            ///< to the control nodes of a rigid body: vertices of the part
  };

  int dim_ = 3;
  Index num_vertices_ = 0;
  std::vector<Part> parts_;
  std::vector<Source> sources_;  ///< by part
  std::vector<Triangle> triangles_;
  std::vector<Edge> edges_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<float> rest_positions_;
  VertexNormals normals_;
};

}  // namespace resilin
