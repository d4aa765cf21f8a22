#include "resilin/mesh/delaunay.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdlib>

namespace resilin {
namespace {

__extension__ using Integer = __int128;

// Bounds of the rounding errors of the determinants in double precision, by powers of the largest entry.
constexpr double orientation_error = 1e-14;
constexpr double sphere_error = 1e-13;

template <class Number>
using Row = std::array<Number, 3>;

template <class Number>
Number determinant(const Row<Number>& a, const Row<Number>& b, const Row<Number>& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

template <class Number>
Row<Number> difference(const Delaunay::Point& a, const Delaunay::Point& b) {
  return {static_cast<Number>(a[0] - b[0]), static_cast<Number>(a[1] - b[1]),
          static_cast<Number>(a[2] - b[2])};
}

/// Positive when the row of the origin lies in the sphere around four points of positive orientation.
template <class Number>
Number sphere_determinant(const std::array<Row<Number>, 4>& d) {
  const auto square = [](const Row<Number>& r) { return r[0] * r[0] + r[1] * r[1] + r[2] * r[2]; };
  return square(d[0]) * determinant(d[1], d[2], d[3]) - square(d[1]) * determinant(d[0], d[2], d[3]) +
         square(d[2]) * determinant(d[0], d[1], d[3]) - square(d[3]) * determinant(d[0], d[1], d[2]);
}

template <class Number>
int sign(Number value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

}  // namespace

Delaunay::Delaunay() {
  for (int i = 0; i < num_corners; ++i)
    points_.push_back({(i & 1) != 0 ? extent : 0, (i & 2) != 0 ? extent : 0, (i & 4) != 0 ? extent : 0});
  // Around the diagonal from corner 0 to 7: along the axes in each of their six orders.
  constexpr std::array<std::array<int, 2>, 6> middles = {{{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}}};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto [a, b] = middles[i];
    // Sides opposite the two middles lie against the next and the previous tetrahedron.
    const auto next = static_cast<Index>((i + 1) % 6), previous = static_cast<Index>((i + 5) % 6);
    tetrahedra_.push_back({{0, a, b, 7}, {-1, next, previous, -1}, 0});
    if (orientation(tetrahedra_.back().nodes, -1, {}) < 0) {
      std::swap(tetrahedra_.back().nodes[1], tetrahedra_.back().nodes[2]);
      std::swap(tetrahedra_.back().neighbors[1], tetrahedra_.back().neighbors[2]);
    }
  }
}

/// Sign of the volume, `p` in the place of node `replaced`; -1 for none.
int Delaunay::orientation(const std::array<Index, 4>& nodes, int replaced, const Point& p) const {
  const auto corner = [&](int i) -> const Point& {
    return i == replaced ? p : point(nodes[static_cast<std::size_t>(i)]);
  };
  const Point& origin = corner(0);
  const auto a = difference<double>(corner(1), origin), b = difference<double>(corner(2), origin),
             c = difference<double>(corner(3), origin);
  double largest = 0;
  for (std::size_t i = 0; i < 3; ++i)
    largest = std::max({largest, std::abs(a[i]), std::abs(b[i]), std::abs(c[i])});
  const double rough = determinant(a, b, c);
  if (std::abs(rough) > orientation_error * largest * largest * largest) return sign(rough);
  return sign(determinant(difference<Integer>(corner(1), origin), difference<Integer>(corner(2), origin),
                          difference<Integer>(corner(3), origin)));
}

bool Delaunay::is_in_sphere(const Tetrahedron& tetrahedron, const Point& p) const {
  std::array<Row<double>, 4> rows;
  double largest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    rows[i] = difference<double>(point(tetrahedron.nodes[i]), p);
    for (const double entry : rows[i]) largest = std::max(largest, std::abs(entry));
  }
  const double rough = sphere_determinant(rows), square = largest * largest;
  if (std::abs(rough) > sphere_error * square * square * largest) return rough > 0;
  std::array<Row<Integer>, 4> exact;
  for (std::size_t i = 0; i < 4; ++i) exact[i] = difference<Integer>(point(tetrahedron.nodes[i]), p);
  return sphere_determinant(exact) > 0;
}

/// Walks from the last tetrahedron through sides that have the point beyond them.
Index Delaunay::find_around(const Point& p) const {
  Index t = last_;
  int first = 0;
  while (true) {
    bool has_moved = false;
    for (int i = 0; i < 4 && !has_moved; ++i) {
      const int side = (first + i) % 4;
      if (orientation(at(t).nodes, side, p) >= 0) continue;
      t = at(t).neighbors[static_cast<std::size_t>(side)];
      first = side + 1;
      has_moved = true;
    }
    if (!has_moved) return t;
  }
}

Index Delaunay::take_place() {
  if (!free_.empty()) {
    const Index place = free_.back();
    free_.pop_back();
    return place;
  }
  tetrahedra_.push_back({});
  return static_cast<Index>(tetrahedra_.size()) - 1;
}

/// Makes neighbors of the two sides that share an edge.
void Delaunay::join(const Rim& rim) {
  const std::uint64_t hash = static_cast<std::uint64_t>(rim.edge) * 0x9e3779b97f4a7c15ULL;
  std::size_t slot = (hash ^ hash >> 32) & (rims_.size() - 1);
  while (rims_[slot].edge >= 0 && rims_[slot].edge != rim.edge) slot = (slot + 1) & (rims_.size() - 1);
  const Rim& other = rims_[slot];
  if (other.edge < 0) {
    rims_[slot] = rim;
    return;
  }
  at(rim.tetrahedron).neighbors[static_cast<std::size_t>(rim.side)] = other.tetrahedron;
  at(other.tetrahedron).neighbors[static_cast<std::size_t>(other.side)] = rim.tetrahedron;
}

Index Delaunay::insert(const Point& p) {
  assert(std::ranges::all_of(p, [](std::int32_t x) { return x > 0 && x < extent; }));
  const Index start = find_around(p);
  for (const Index node : at(start).nodes)
    if (point(node) == p) return node;
  const auto number = static_cast<Index>(points_.size());
  points_.push_back(p);

  // The cavity: tetrahedra whose spheres hold the point. A side of it that the point is level with would have
  // the point in the sphere beyond as well, so that no new tetrahedron is flat.
  is_in_cavity_.resize(tetrahedra_.size(), 0);
  cavity_ = {start};
  is_in_cavity_[static_cast<std::size_t>(start)] = 1;
  sides_.clear();
  for (std::size_t i = 0; i < cavity_.size(); ++i) {
    const Index t = cavity_[i];
    for (int side = 0; side < 4; ++side) {
      const Index other = at(t).neighbors[static_cast<std::size_t>(side)];
      if (other >= 0) {
        auto& is_in = is_in_cavity_[static_cast<std::size_t>(other)];
        if (is_in == 0 && is_in_sphere(at(other), p)) {
          is_in = 1;
          cavity_.push_back(other);
        }
        if (is_in != 0) continue;
      }
      sides_.emplace_back(t, side);
    }
  }
  rims_.assign(std::bit_ceil(4 * sides_.size()), {});  // each edge of the cavity's sides once
  for (const auto& [t, side] : sides_) {
    const Index made = take_place();
    const auto at_side = static_cast<std::size_t>(side);
    const Tetrahedron& old = at(t);
    const Index outside = old.neighbors[at_side];
    Tetrahedron tetrahedron{old.nodes, {-1, -1, -1, -1}, number};
    tetrahedron.nodes[at_side] = number;
    tetrahedron.neighbors[at_side] = outside;
    if (outside >= 0) {
      auto& back = at(outside).neighbors;
      *std::ranges::find(back, t) = made;
    }
    at(made) = tetrahedron;
    for (int other = 0; other < 4; ++other) {
      if (other == side) continue;
      std::array<Index, 2> edge{};
      std::size_t n = 0;
      for (int k = 0; k < 4; ++k)
        if (k != other && k != side) edge[n++] = tetrahedron.nodes[static_cast<std::size_t>(k)];
      const auto [low, high] = std::minmax(edge[0], edge[1]);
      join({(std::int64_t{low} << 32) | high, made, other});
    }
    last_ = made;
  }
  for (const Index t : cavity_) {
    is_in_cavity_[static_cast<std::size_t>(t)] = 0;
    at(t).nodes[0] = -1;
    free_.push_back(t);
  }
  return number;
}

}  // namespace resilin
