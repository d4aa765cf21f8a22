#include "resilin/mesh/improve_tetrahedra.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace resilin {
namespace {

using Nodes = std::array<Index, 4>;

constexpr double infinite_quality = std::numeric_limits<double>::infinity();
constexpr std::size_t most_in_ring = 9;  // tetrahedra around an edge that is removed
constexpr double better = 1e-6;          // least gain of a change

/// Faces opposite the nodes of a positive tetrahedron, seen from outside counterclockwise.
constexpr std::array<std::array<std::size_t, 3>, 4> face_nodes = {
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

class TetrahedronImprover {
 public:
  TetrahedronImprover(TetrahedronSet& set, const VertexGuide& guide, double wanted)
      : x_(set.positions),
        cells_(set.cells),
        guide_(guide),
        wanted_(wanted),
        star_(set.positions.size()),
        is_settled_(set.positions.size(), 0) {
    for (const Nodes& cell : cells_) known_.push_back(quality(cell));
    for (std::size_t t = 0; t < cells_.size(); ++t) link(static_cast<Index>(t));
  }

  double run(int passes) {
    for (int pass = 0; pass < passes; ++pass) {
      for (Index v = 0; v < static_cast<Index>(x_.size()); ++v) smooth(v, pass < 2);
      std::size_t num_changes = 0;
      for (Index t = 0; t < static_cast<Index>(cells_.size()); ++t) {
        if (!is_there(t) || quality(t) >= wanted_) continue;
        num_changes += static_cast<std::size_t>(exchange(t));
        if (!is_there(t)) continue;
        for (const Index v : Nodes(nodes(t))) num_changes += static_cast<std::size_t>(smooth(v, false));
      }
      if (num_changes == 0 && pass >= 2) break;
    }
    std::erase_if(cells_, [](const Nodes& cell) { return cell[0] < 0; });
    double least = 1;
    for (const Nodes& cell : cells_) least = std::min(least, quality(cell));
    return least;
  }

 private:
  const Nodes& nodes(Index t) const { return cells_[static_cast<std::size_t>(t)]; }
  bool is_there(Index t) const { return nodes(t)[0] >= 0; }
  const Vector3& x(Index v) const { return x_[static_cast<std::size_t>(v)]; }
  std::vector<Index>& star(Index v) { return star_[static_cast<std::size_t>(v)]; }
  const std::vector<Index>& star(Index v) const { return star_[static_cast<std::size_t>(v)]; }
  double quality(const Nodes& n) const { return least_sine({x(n[0]), x(n[1]), x(n[2]), x(n[3])}); }
  double quality(Index t) const { return known_[static_cast<std::size_t>(t)]; }

  void link(Index t) {
    for (const Index v : nodes(t)) star(v).push_back(t);
    unsettle(t);
  }
  void unsettle(Index t) {
    for (const Index v : nodes(t)) is_settled_[static_cast<std::size_t>(v)] = 0;
  }
  void remove(Index t) {
    unsettle(t);
    for (const Index v : nodes(t)) std::erase(star(v), t);
    cells_[static_cast<std::size_t>(t)][0] = -1;
    free_.push_back(t);
  }
  void add(const Nodes& cell) {
    if (free_.empty()) {
      cells_.push_back(cell);
      known_.push_back(quality(cell));
      return link(static_cast<Index>(cells_.size()) - 1);
    }
    const Index t = free_.back();
    free_.pop_back();
    cells_[static_cast<std::size_t>(t)] = cell;
    known_[static_cast<std::size_t>(t)] = quality(cell);
    link(t);
  }
  static bool has(const Nodes& cell, Index v) { return std::ranges::find(cell, v) != cell.end(); }

  /// Least quality of the cells in `worst_first_`; stops at `floor` or below.
  double least_quality(double floor) const {
    double least = infinite_quality;
    for (const auto& [before, t] : worst_first_) {
      least = std::min(least, quality(nodes(t)));
      if (least <= floor) break;
    }
    return least;
  }

  /// Tries some places of a vertex and keeps the best. @return whether it has moved
  bool smooth(Index v, bool is_to_relax) {
    if (star(v).empty() || is_settled_[static_cast<std::size_t>(v)] != 0) return false;
    const Vector3 old = x(v);
    double least = infinite_quality;
    Index worst = -1;
    for (const Index t : star(v)) {
      if (quality(t) >= least) continue;
      least = quality(t);
      worst = t;
    }
    if (!is_to_relax && least >= wanted_) return false;
    Vector3 middle = Vector3::Zero();
    double total = 0, size = 0;
    worst_first_.clear();
    for (const Index t : star(v)) {
      worst_first_.emplace_back(quality(t), t);
      Vector3 sum = Vector3::Zero();
      for (const Index node : nodes(t)) sum += x(node);
      const Vector3 arm = x(nodes(t)[1]) - x(nodes(t)[0]);
      const double volume =
          std::abs(arm.dot((x(nodes(t)[2]) - x(nodes(t)[0])).cross(x(nodes(t)[3]) - x(nodes(t)[0]))));
      middle += volume * sum / 4;
      total += volume;
      size = std::max(size, (sum - 4 * old).norm() / 3);
    }
    std::ranges::sort(worst_first_);
    Vector3 best = old;
    double best_quality = least;
    const auto quality_at = [&](const Vector3& place) {
      x_[static_cast<std::size_t>(v)] = place;
      const double q = least_quality(best_quality);
      x_[static_cast<std::size_t>(v)] = old;
      return q;
    };
    const auto attempt = [&](Vector3 place) {
      // A candidate that is no better before it is moved to the surface is rarely better then.
      if (quality_at(place) <= best_quality || !guide_.project(v, place)) return false;
      const double q = quality_at(place);
      if (q <= best_quality + better) return false;
      best_quality = q;
      best = place;
      return true;
    };
    if (total > 0) {
      middle /= total;
      for (const double share : {1.0, 0.5, 0.2}) {
        if (attempt(old + share * (middle - old))) break;
      }
    }
    if (least < wanted_) {
      // Along the height of the worst cell, towards its other corners, along axes and diagonals.
      std::vector<Vector3> directions;
      std::array<Vector3, 3> others;
      std::size_t n = 0;
      for (const Index node : nodes(worst))
        if (node != v) others[n++] = x(node);
      Vector3 height = (others[1] - others[0]).cross(others[2] - others[0]);
      if (height.norm() > 0) directions.push_back(height.normalized());
      for (const Vector3& other : others) {
        const Vector3 side = (other - old);
        if (side.norm() > 0) directions.push_back(side.normalized());
      }
      for (int axis = 0; axis < 3; ++axis) directions.push_back(Vector3::Unit(axis));
      for (const double y : {1.0, -1.0})
        for (const double z : {1.0, -1.0}) directions.push_back(Vector3(1, y, z).normalized());
      for (double step = 0.25 * size; step > 0.02 * size; step *= 0.5)
        for (const Vector3& direction : directions)
          if (!attempt(best + step * direction)) attempt(best - step * direction);
    }
    if (best == old) {
      is_settled_[static_cast<std::size_t>(v)] = 1;
      return false;
    }
    x_[static_cast<std::size_t>(v)] = best;
    for (const Index t : star(v)) {
      known_[static_cast<std::size_t>(t)] = quality(nodes(t));
      unsettle(t);
    }
    return true;
  }

  /// Removes an edge of a bad cell or flips one of its faces, whichever is found first. @return whether it
  /// did
  bool exchange(Index t) {
    const Nodes cell = nodes(t);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (remove_edge(cell[i], cell[j])) return true;
    for (std::size_t i = 0; i < 4; ++i)
      if (flip_face(t, i)) return true;
    return false;
  }

  /// Cells around an edge; `ring` is the polygon of their other vertices, counterclockwise seen from b.
  struct Ring {
    std::vector<Index> cells, vertices;
    bool is_closed = false;
  };

  /// @return whether cells around the edge form one fan
  bool find_ring(Index a, Index b, Ring& ring) const {
    std::vector<std::array<Index, 2>> arcs;
    for (const Index t : star(a)) {
      const Nodes& n = nodes(t);
      if (!has(n, b)) continue;
      std::array<Index, 2> arc{};
      std::size_t k = 0;
      for (const Index node : n)
        if (node != a && node != b) arc[k++] = node;
      // Even permutations of a positive cell are positive.
      const auto at = [&](Index v) { return std::ranges::find(n, v) - n.begin(); };
      std::array<std::ptrdiff_t, 4> order = {at(a), at(b), at(arc[0]), at(arc[1])};
      int inversions = 0;
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j) inversions += static_cast<int>(order[i] > order[j]);
      if (inversions % 2 == 1) std::swap(arc[0], arc[1]);
      arcs.push_back(arc);
      ring.cells.push_back(t);
    }
    if (arcs.empty() || arcs.size() > most_in_ring) return false;
    // The first arc is one that none leads to; any where they close.
    std::size_t first = 0;
    for (std::size_t i = 0; i < arcs.size(); ++i)
      if (std::ranges::none_of(arcs, [&](const auto& arc) { return arc[1] == arcs[i][0]; })) first = i;
    ring.vertices = {arcs[first][0]};
    for (std::size_t i = 0; i < arcs.size(); ++i) {
      const auto next =
          std::ranges::find_if(arcs, [&](const auto& arc) { return arc[0] == ring.vertices.back(); });
      if (next == arcs.end()) return false;
      ring.vertices.push_back((*next)[1]);
    }
    ring.is_closed = ring.vertices.front() == ring.vertices.back();
    if (ring.is_closed) ring.vertices.pop_back();
    std::vector<Index> sorted = ring.vertices;
    std::ranges::sort(sorted);
    return std::ranges::adjacent_find(sorted) == sorted.end();
  }

  bool has_edge(Index a, Index b) const {
    return std::ranges::any_of(star(a), [&](Index t) { return has(nodes(t), b); });
  }

  bool has_face(Index a, Index b, Index c) const {
    return std::ranges::any_of(star(a), [&](Index t) { return has(nodes(t), b) && has(nodes(t), c); });
  }

  bool remove_edge(Index a, Index b) {
    Ring ring;
    if (!find_ring(a, b, ring)) return false;
    double old = infinite_quality;
    for (const Index t : ring.cells) old = std::min(old, quality(t));
    const std::size_t n = ring.vertices.size();
    if (!ring.is_closed) {
      const Index first = ring.vertices.front(), last = ring.vertices.back();
      if (guide_.is_kept(a, b)) return false;
      if (!guide_.may_be_side(first, last, a) || !guide_.may_be_side(first, last, b)) return false;
      if (n > 2 && has_edge(first, last)) return false;
      if (n == 2) return cut_off(ring.cells[0], a, b, first, last, old);
    } else if (n < 3) {
      return false;
    }
    // best[i][j]: of the polygon of vertices i to j, by the triangle on its edge from i to j.
    std::array<std::array<double, most_in_ring + 2>, most_in_ring + 2> best{};
    std::array<std::array<std::size_t, most_in_ring + 2>, most_in_ring + 2> middle{};
    for (std::size_t i = 0; i + 1 < n; ++i) best[i][i + 1] = infinite_quality;
    for (std::size_t width = 2; width < n; ++width)
      for (std::size_t i = 0; i + width < n; ++i) {
        const std::size_t j = i + width;
        best[i][j] = -infinite_quality;
        for (std::size_t k = i + 1; k < j; ++k) {
          double q = std::min(best[i][k], best[k][j]);
          if (q <= best[i][j] || q <= old) continue;
          const auto pair = pair_on(ring, a, b, i, k, j);
          q = std::min({q, quality(pair[0]), quality(pair[1])});
          if (q <= best[i][j]) continue;
          best[i][j] = q;
          middle[i][j] = k;
        }
      }
    if (best[0][n - 1] <= old + better) return false;
    std::vector<Nodes> made;
    std::vector<std::array<std::size_t, 2>> left = {{0, n - 1}};
    while (!left.empty()) {
      const auto [i, j] = left.back();
      left.pop_back();
      if (j - i < 2) continue;
      const std::size_t k = middle[i][j];
      // Near concave parts of the boundary other cells may have such a face or edge already.
      if (has_face(ring.vertices[i], ring.vertices[k], ring.vertices[j])) return false;
      if (k - i > 1 && has_edge(ring.vertices[i], ring.vertices[k])) return false;
      if (j - k > 1 && has_edge(ring.vertices[k], ring.vertices[j])) return false;
      for (const Nodes& cell : pair_on(ring, a, b, i, k, j)) made.push_back(cell);
      left.push_back({i, k});
      left.push_back({k, j});
    }
    for (const Index t : ring.cells) remove(t);
    for (const Nodes& cell : made) add(cell);
    return true;
  }

  static std::array<Nodes, 2> pair_on(const Ring& ring, Index a, Index b, std::size_t i, std::size_t k,
                                      std::size_t j) {
    return {Nodes{a, ring.vertices[i], ring.vertices[k], ring.vertices[j]},
            Nodes{b, ring.vertices[i], ring.vertices[j], ring.vertices[k]}};
  }

  /// Drops a flat cell that has two sides on the boundary, at the edge from a to b.
  bool cut_off(Index t, Index a, Index b, Index c, Index d, double old) {
    constexpr double flat = 0.1;
    if (old > std::min(flat, wanted_)) return false;
    if (star(a).size() < 2 || star(b).size() < 2 || star(c).size() < 2 || star(d).size() < 2) return false;
    // The other edge must not lie on the boundary yet: it would have four sides there.
    Ring opposite;
    if (!find_ring(c, d, opposite) || !opposite.is_closed) return false;
    remove(t);
    return true;
  }

  /// Face opposite node i of a cell: two cells become three around a new edge.
  bool flip_face(Index t, std::size_t i) {
    const Nodes cell = nodes(t);
    const Index c = cell[face_nodes[i][0]], d = cell[face_nodes[i][1]], e = cell[face_nodes[i][2]];
    Index other = -1;
    for (const Index u : star(c))
      if (u != t && has(nodes(u), d) && has(nodes(u), e)) other = u;
    if (other < 0) return false;
    const Index apex = cell[i];
    Index beyond = -1;
    for (const Index v : nodes(other))
      if (v != c && v != d && v != e) beyond = v;
    if (has_edge(apex, beyond)) return false;
    const double old = std::min(quality(t), quality(other));
    const std::array<Nodes, 3> made = {{{apex, beyond, c, d}, {apex, beyond, d, e}, {apex, beyond, e, c}}};
    double least = infinite_quality;
    for (const Nodes& n : made) least = std::min(least, quality(n));
    if (least <= old + better) return false;
    remove(t);
    remove(other);
    for (const Nodes& n : made) add(n);
    return true;
  }

  std::vector<Vector3>& x_;
  std::vector<Nodes>& cells_;
  const VertexGuide& guide_;
  double wanted_;
  std::vector<std::vector<Index>> star_;  ///< cells of each vertex
  std::vector<double> known_;             ///< quality of each cell
  std::vector<std::uint8_t>
      is_settled_;  ///< vertices whose places were tried in vain since their star changed
  std::vector<Index> free_;
  std::vector<std::pair<double, Index>>
      worst_first_;  ///< cells of the vertex that is moved, by their quality
};

}  // namespace

double least_sine(const std::array<Vector3, 4>& corners) {
  const Vector3 a = corners[1] - corners[0], b = corners[2] - corners[0], c = corners[3] - corners[0];
  const double volume = a.dot(b.cross(c));  // six times
  std::array<double, 4> areas;              // twice, squared
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& [p, q, r] = face_nodes[i];
    areas[i] = (corners[q] - corners[p]).cross(corners[r] - corners[p]).squaredNorm();
  }
  // sin = 3 V l / (2 A B), with l the edge that the faces A and B share.
  const double smallest = std::ranges::min(areas);
  if (!(smallest * smallest > 0)) return 0;
  const auto square = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
    return (corners[k] - corners[l]).squaredNorm() / (areas[i] * areas[j]);
  };
  const std::array<double, 6> squares = {square(0, 1, 2, 3), square(0, 2, 1, 3), square(0, 3, 1, 2),
                                         square(1, 2, 0, 3), square(1, 3, 0, 2), square(2, 3, 0, 1)};
  const auto [least, most] = std::ranges::minmax(squares);
  return volume * std::sqrt(volume > 0 ? least : most);
}

double improve_tetrahedra(TetrahedronSet& set, const VertexGuide& guide, double wanted, int passes) {
  return TetrahedronImprover(set, guide, wanted).run(passes);
}

}  // namespace resilin
