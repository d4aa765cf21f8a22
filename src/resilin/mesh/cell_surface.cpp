#include "resilin/mesh/cell_surface.hpp"

#include "resilin/mesh/cell_kind.hpp"
#include "resilin/mesh/closest_point.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr int cuts_of_a_curved_side = 6;

}  // namespace

CellSurface::CellSurface(const CellMap& map) : map_(map) {
  const auto num_sides = cell_sides(cell_kind(map.element())).size();
  std::vector<std::vector<Corners>> flat, fine;  // by side
  for (int side = 0; side < static_cast<int>(num_sides); ++side) {
    flat.push_back(cut_side(map.element(), side, 1));
    fine.push_back(cut_side(map.element(), side, cuts_of_a_curved_side));
  }
  std::vector<Box> boxes;
  for (const Facet& facet : boundary(map.block()).owners) {
    const auto& cut = map.is_affine(facet.cell) ? flat : fine;
    for (const Corners& corners : cut[static_cast<std::size_t>(facet.local)]) {
      Piece piece{facet.cell, corners, {}};
      boxes.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) {
        piece.places[i] = map.place(facet.cell, corners[i]);
        boxes.back().add(piece.places[i]);
      }
      pieces_.push_back(piece);
    }
  }
  tree_ = BoxTree(boxes);
}

/// n x n pieces of a side of the reference cell (of quadrilaterals twice as many), in 2D n segments, which
/// have their second end twice.
std::vector<CellSurface::Corners> CellSurface::cut_side(const ElementInfo& element, int side, int n) {
  const auto corners = cell_sides(cell_kind(element))[static_cast<std::size_t>(side)].corners();
  const auto corner = [&](std::size_t i) -> const Vector3& {
    return element.nodes[static_cast<std::size_t>(corners[i])];
  };
  const Vector3 along = corner(1) - corner(0), across = corner(corners.size() - 1) - corner(0);
  const auto at = [&](int i, int j) -> Vector3 { return corner(0) + (i * along + j * across) / n; };
  std::vector<Corners> pieces;
  if (corners.size() == 2) {
    for (int i = 0; i < n; ++i) pieces.push_back({at(i, 0), at(i + 1, 0), at(i + 1, 0)});
    return pieces;
  }
  const bool is_triangle = corners.size() == 3;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < (is_triangle ? n - j : n); ++i) {
      pieces.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (!is_triangle || i + j < n - 1) pieces.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return pieces;
}

std::array<double, 3> CellSurface::shares(const Piece& piece, const Vector3& X) const {
  if (map_.element().dim == 3)
    return closest_on_triangle(X, piece.places[0], piece.places[1], piece.places[2]);
  const auto [first, second] = closest_on_segment(X, piece.places[0], piece.places[1]);
  return {first, second, 0};
}

double CellSurface::squared_distance(const Piece& piece, const Vector3& X) const {
  const auto share = shares(piece, X);
  return (share[0] * piece.places[0] + share[1] * piece.places[1] + share[2] * piece.places[2] - X)
      .squaredNorm();
}

CellSurface::Nearest CellSurface::nearest(const Vector3& X) const {
  const auto piece_at = [&](Index i) -> const Piece& { return pieces_[static_cast<std::size_t>(i)]; };
  const Piece& piece = piece_at(tree_.nearest(X, [&](Index i) { return squared_distance(piece_at(i), X); }));
  const auto share = shares(piece, X);
  const Vector3 xi = share[0] * piece.xi[0] + share[1] * piece.xi[1] + share[2] * piece.xi[2];
  return {piece.cell, xi, (map_.place(piece.cell, xi) - X).norm()};
}

}  // namespace resilin
