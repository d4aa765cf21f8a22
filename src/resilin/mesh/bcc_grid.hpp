#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "resilin/core/types.hpp"
#include "resilin/mesh/mesh.hpp"

namespace resilin {

/// The tetrahedra of a body-centred cubic lattice over a box of cubes, some of which are chosen.
///
/// Coordinates of the lattice are whole numbers: corners of cubes are even, middles odd, a cube is 2 wide. To
/// each cube belong the four tetrahedra around each of its three upper faces, which reach into the next cube.
class BccGrid {
 public:
  static constexpr std::size_t shapes = 12;  ///< tetrahedra of a cube
  using Node = std::array<int, 3>;

  static constexpr std::size_t most_cubes = std::size_t{1} << 26;

  /// Cubes of the side `spacing` around a box, and some more on every side; at most `most_cubes`.
  BccGrid(const Vector3& low, const Vector3& high, double spacing);

  /// Number of these cubes; more than `most_cubes` are not counted further.
  static std::size_t count_cubes(const Vector3& low, const Vector3& high, double spacing);

  std::size_t num_tetrahedra() const { return is_chosen_.size(); }
  bool is_chosen(std::size_t tetrahedron) const { return is_chosen_[tetrahedron] != 0; }
  void choose(std::size_t tetrahedron) { is_chosen_[tetrahedron] = 1; }

  Vector3 middle(std::size_t tetrahedron) const;  ///< [m]

  /// Selects all tetrahedra that a triangle intersects or touches.
  void choose_met_by(const std::array<Vector3, 3>& triangle);
  /// Chooses all tetrahedra of which the nodes, one at least, are corners. @return how many were not chosen
  Index choose_around(std::span<const Node> nodes);

  /// The chosen tetrahedra and their nodes, in the order of the lattice.
  struct Chosen {
    Mesh mesh;
    std::vector<Node> nodes;  ///< nodes of its vertices
  };
  Chosen chosen() const;

 private:
  using Cube = std::array<int, 3>;
  Cube cube(std::size_t tetrahedron) const;
  std::size_t first_tetrahedron(const Cube& cube) const;
  bool has(const Cube& cube) const;
  Vector3 place(const Node& node) const;

  std::array<int, 3> size_{};  ///< cubes along each axis
  Vector3 origin_ = Vector3::Zero();
  double half_ = 1;  ///< half a spacing: what 1 is in metres
  std::vector<std::uint8_t> is_chosen_;
};

}  // namespace resilin
