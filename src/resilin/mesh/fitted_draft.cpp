#include "resilin/mesh/fitted_draft.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>

#include "resilin/core/parallel.hpp"
#include "resilin/mesh/edit.hpp"

namespace resilin {
namespace {

using Kind = FittedVertex::Kind;

// Lengths by the spacing of the lattice inside (`spacing_`) or the edges on the surface (`edge_`).
constexpr double edge_share = 0.93;   // edges on the surface, by the spacing
constexpr double disk_radius = 0.78;  // between points of the surface, by the edge: as many as edges of 1
constexpr double line_clearance =
    0.45;  // line clearance of points of the surface from lines: outside the spheres of edges
constexpr double feature_clearance = 0.7;  // feature clearance of points of the surface from points of lines
constexpr double same_feature = 0.15;      // points of lines that are nearer are one
constexpr double inside_clearance = 0.5;   // inside clearance of points inside, by the spacing
constexpr double finest_line = 1.5;        // see find_features
constexpr double edge_turning = 1.0;       // largest turning of the surface along an edge [rad]
constexpr double finest_size = 0.4;        // finest size of edges where the surface is curved
constexpr double most_tried = 2e7;
constexpr double disks_tried = 12;                     // points that are tried on the area of a disk
constexpr double most_turning = std::numbers::pi / 3;  // most turning of a line between two of its points
constexpr double flat_enough = 0.07;                   // tolerance of sides of cells from the surface
constexpr double thin_enough = 0.2;                    // the same by the thickness of the solid
constexpr double finest_edge = 0.12;                   // points are not added nearer to others
// Inside of graded cells: share of the edges below which finer points come, growth of edges by the distance
// from shorter ones, distance up to which short edges count.
constexpr double finer_inside = 0.7, grading = 0.5, reach_of_grading = 1.5;
constexpr int most_line_splits = 6, most_refinements = 6;
constexpr std::size_t most_growth = 4;  // largest growth of the number of points, by refinement
constexpr std::size_t points_per_chunk = 64;

constexpr std::array<std::array<std::size_t, 3>, 4> side_nodes = {
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// Points in cubes, to find near ones.
class PointCubes {
 public:
  explicit PointCubes(double size) : size_(size), slots_(64) {}

  void add(const Vector3& X, Index number) {
    if (2 * (num_cubes_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[find(key(cube(X)))];
    const auto added = static_cast<Index>(points_.size());
    points_.push_back({X, number, -1});
    if (slot.first < 0) {
      slot.key = key(cube(X));
      slot.first = added;
      ++num_cubes_;
    } else {
      points_[static_cast<std::size_t>(slot.last)].next = added;
    }
    slot.last = added;
  }

  /// Calls `visit(point, number)` for all that are nearer than the size of the cubes, and some more.
  template <class Visit>
  void visit_near(const Vector3& X, const Visit& visit) const {
    const auto center = cube(X);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz)
          any_in({center[0] + dx, center[1] + dy, center[2] + dz}, [&](const Vector3& point, Index number) {
            visit(point, number);
            return false;
          });
  }

  /// Whether `is_met(point, number)` holds for one that is nearer than `radius`, at most the size of the
  /// cubes; it may be asked of others too.
  template <class IsMet>
  bool any_near(const Vector3& X, double radius, const IsMet& is_met) const {
    const auto center = cube(X), low = cube(X - Vector3::Constant(radius)),
               high = cube(X + Vector3::Constant(radius));
    if (any_in(center, is_met)) return true;  // most are met there
    for (std::int64_t x = low[0]; x <= high[0]; ++x)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t z = low[2]; z <= high[2]; ++z)
          if (Cube{x, y, z} != center && any_in({x, y, z}, is_met)) return true;
    return false;
  }

 private:
  using Cube = std::array<std::int64_t, 3>;
  struct Slot {
    std::int64_t key = 0;
    Index first = -1, last = -1;  ///< points of the cube; -1: the slot is free
  };
  struct Point {
    Vector3 X;
    Index number;
    Index next;  ///< point of the same cube, -1 after the last
  };

  template <class IsMet>
  bool any_in(const Cube& cube, const IsMet& is_met) const {
    Index i = slots_[find(key(cube))].first;
    for (; i >= 0; i = points_[static_cast<std::size_t>(i)].next)
      if (is_met(points_[static_cast<std::size_t>(i)].X, points_[static_cast<std::size_t>(i)].number))
        return true;
    return false;
  }

  Cube cube(const Vector3& X) const {
    Cube result{};
    for (std::size_t i = 0; i < 3; ++i)
      result[i] = static_cast<std::int64_t>(std::floor(X[static_cast<Eigen::Index>(i)] / size_));
    return result;
  }
  static std::int64_t key(const Cube& c) {
    return (c[0] & 0x1fffff) | (c[1] & 0x1fffff) << 21 | (c[2] & 0x1fffff) << 42;
  }

  /// The slot of a cube, or the free one where it belongs: open addressing, a power of two of slots.
  std::size_t find(std::int64_t key) const {
    const std::uint64_t hash = static_cast<std::uint64_t>(key) * 0x9e3779b97f4a7c15ULL;
    std::size_t slot = (hash ^ hash >> 32) & (slots_.size() - 1);
    while (slots_[slot].first >= 0 && slots_[slot].key != key) slot = (slot + 1) & (slots_.size() - 1);
    return slot;
  }

  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old)
      if (slot.first >= 0) slots_[find(slot.key)] = slot;
  }

  double size_;
  std::size_t num_cubes_ = 0;
  std::vector<Slot> slots_;
  std::vector<Point> points_;
};

std::int64_t edge_key(Index a, Index b) {
  const auto [low, high] = std::minmax(a, b);
  return (std::int64_t{low} << 32) | high;
}

std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

/// Place of a point in an order in which near points are near.
std::uint64_t morton(const Delaunay::Point& p) {
  std::uint64_t code = 0;
  for (std::size_t i = 0; i < 3; ++i) code |= spread_bits(static_cast<std::uint64_t>(p[i]) >> 3) << i;
  return code;
}

}  // namespace

FittedDraft::FittedDraft(const SurfacePlaces& places, double spacing, double finest)
    : places_(&places),
      spacing_(spacing),
      edge_(edge_share * spacing),
      finest_(finest > 0 ? std::clamp(finest, edge_ / most_grading, edge_) : finest_size * edge_),
      is_graded_(finest > 0 && finest_ < edge_),
      least_gap_(std::min(finest_edge * edge_, 0.5 * finest_)) {
  const BoundingBox box = bounding_box(places.surface().mesh);
  middle_ = 0.5 * (box.min + box.max);
  unit_ = (box.max - box.min).maxCoeff() / (Delaunay::extent / 4);
  features_ = find_features(places.surface(), finest_line * edge_);
  add_features();
  add_surface();
  add_inside();
  connect();
  refine_all();
}

void FittedDraft::refine_all() {
  const std::size_t most = most_growth * vertices_.size() + 200;
  for (int round = 0; round < most_refinements && vertices_.size() < most; ++round) {
    if (refine() == 0) break;
    split_lines();
    find_cells();
  }
}

/// A point of corners and lines at about the same place; -1 where there is none.
Index FittedDraft::near_feature(const Vector3& X) const {
  for (Index v = 0; v < static_cast<Index>(vertices_.size()); ++v)
    if ((vertices_[static_cast<std::size_t>(v)].X - X).norm() < same_feature * edge_) return v;
  return -1;
}

void FittedDraft::add_features() {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  // Where shells overlap, features inside are none.
  const auto is_at_rim = [&](const Vector3& X) {
    if (!places_->has_overlaps()) return true;
    const double step = 0.02 * edge_;
    bool has_inside = false, has_outside = false;
    for (int i = 0; i < 8; ++i) {
      const Vector3 offset((i & 1) != 0 ? step : -step, (i & 2) != 0 ? step : -step,
                           (i & 4) != 0 ? step : -step);
      (places_->is_inside(X + offset) ? has_inside : has_outside) = true;
    }
    return has_inside && has_outside;
  };
  std::vector<Index> corner_vertices;
  for (const Vector3& X : features_.corners) {
    Index v = near_feature(X);
    if (v < 0 && is_at_rim(X)) {
      v = static_cast<Index>(vertices_.size());
      vertices_.push_back({.X = X, .kind = Kind::corner, .thickness = unknown});
    }
    corner_vertices.push_back(v);
  }
  for (Index l = 0; l < static_cast<Index>(features_.lines.size()); ++l) {
    const CreaseLine& line = features_.lines[static_cast<std::size_t>(l)];
    const double length = line.length();
    double parts = std::max({1.0, std::round(length / edge_), std::ceil(line.turning / most_turning - 0.01)});
    parts = std::min(parts, std::max(1.0, std::floor(length / (2 * same_feature * edge_))));
    std::vector<Index> sequence;
    const auto put = [&](Index v) {
      if (v >= 0 && (sequence.empty() || sequence.back() != v)) sequence.push_back(v);
    };
    if (!line.is_closed()) put(corner_vertices[static_cast<std::size_t>(line.first)]);
    if (!line.is_closed() || parts >= 3) {
      for (int i = line.is_closed() ? 0 : 1; i < static_cast<int>(parts); ++i) {
        const double s = length * i / parts;
        const Vector3 X = line.at(s);
        Index v = near_feature(X);
        if (v < 0 && is_at_rim(X)) {
          v = static_cast<Index>(vertices_.size());
          vertices_.push_back({.X = X, .kind = Kind::line, .line = l, .s = s, .thickness = unknown});
        } else if (v >= 0) {
          vertices_[static_cast<std::size_t>(v)].kind = Kind::corner;  // where lines meet
        }
        put(v);
      }
    }
    if (!line.is_closed()) {
      put(corner_vertices[static_cast<std::size_t>(line.last)]);
    } else if (sequence.size() > 2) {
      put(sequence.front());
    }
    sequences_.push_back(std::move(sequence));
  }
}

void FittedDraft::add_surface() {
  const auto radius = disk_radius * edge_;
  PointCubes cubes(std::max(radius, feature_clearance * edge_));
  for (Index v = 0; v < static_cast<Index>(vertices_.size()); ++v)
    cubes.add(vertices_[static_cast<std::size_t>(v)].X, v);
  PointCubes on_lines(line_clearance * edge_);
  for (const auto& sequence : sequences_)
    for (std::size_t i = 0; i + 1 < sequence.size(); ++i) {
      const Vector3 &a = vertices_[static_cast<std::size_t>(sequence[i])].X,
                    &b = vertices_[static_cast<std::size_t>(sequence[i + 1])].X;
      constexpr int parts = 6;
      for (int k = 1; k < parts; ++k) on_lines.add(a + k * (b - a) / parts, -1);
    }
  const auto first = vertices_.size();
  const auto try_places = [&](double disk, const auto& size_near) {
    const std::vector<SurfacePlace> tried = places_->spread(static_cast<std::size_t>(
        std::min(most_tried, 8 + disks_tried * places_->surface().area / (0.7 * disk * disk))));
    // In a scattered order, so that accepted ones do not line up with the triangles.
    std::vector<std::size_t> order(tried.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [](std::size_t i) { return i * 0x9e3779b97f4a7c15ULL; });
    for (const std::size_t i : order) {
      const SurfacePlace& place = tried[i];
      const double size = size_near(place);
      if (!(size > 0)) continue;
      const auto is_too_near = [&](const Vector3& X, Index v) {
        const FittedVertex& other = vertices_[static_cast<std::size_t>(v)];
        const double distance = (X - place.X).norm();
        if (other.kind != Kind::surface) return distance < feature_clearance * size;
        if (other.normal.dot(place.normal) > 0.3) return distance < disk_radius * size;
        return distance < least_gap_;  // the other side of a thin wall
      };
      const double reach = std::max({feature_clearance * size, disk_radius * size, least_gap_});
      if (cubes.any_near(place.X, reach, is_too_near)) continue;
      const double clearance = line_clearance * size;
      if (on_lines.any_near(place.X, clearance,
                            [&](const Vector3& X, Index) { return (X - place.X).norm() < clearance; }))
        continue;
      if (places_->has_overlaps() && !places_->is_rim(place)) continue;
      const auto v = static_cast<Index>(vertices_.size());
      vertices_.push_back({.X = place.X,
                           .kind = Kind::surface,
                           .normal = place.normal,
                           .size = size,
                           .triangle = place.triangle});
      cubes.add(place.X, v);
    }
  };
  try_places(disk_radius * edge_, [&](const SurfacePlace&) { return edge_; });
  // Where the surface is curved there are more.
  const auto is_near_line = [&](const Vector3& place) {
    bool is_found = false;
    cubes.visit_near(place, [&](const Vector3&, Index v) {
      is_found = is_found || vertices_[static_cast<std::size_t>(v)].kind != Kind::surface;
    });
    return is_found;
  };
  const auto size_of_nearest = [&](const SurfacePlace& place) {
    double least = std::numeric_limits<double>::infinity(), size = 0;
    cubes.visit_near(place.X, [&](const Vector3& X, Index v) {
      const FittedVertex& other = vertices_[static_cast<std::size_t>(v)];
      const double distance = (X - place.X).squaredNorm();
      if (other.kind != Kind::surface || distance >= least || other.normal.dot(place.normal) < 0) return;
      least = distance;
      size = other.size;
    });
    return size < 0.9 * edge_ ? size : 0.0;
  };
  double tried = edge_;
  for (std::size_t seen = first; seen < vertices_.size();) {
    const std::size_t last = vertices_.size();
    parallel_for(last - seen, points_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = seen + begin; i < seen + end; ++i) {
        FittedVertex& vertex = vertices_[i];
        const SurfacePlace place{vertex.X, vertex.normal, vertex.triangle};
        if (!is_near_line(vertex.X)) vertex.size = size_at(place);
        if (is_graded_) vertex.size = std::max(finest_, std::min(vertex.size, places_->thickness(place)));
      }
    });
    double finest = edge_;
    for (std::size_t i = first; i < last; ++i) finest = std::min(finest, vertices_[i].size);
    seen = last;
    if (!(finest < 0.9 * tried)) break;
    try_places(disk_radius * finest, size_of_nearest);
    tried = finest;
    if (!is_graded_) break;
  }
  parallel_for(vertices_.size() - first, points_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = first + begin; i < first + end; ++i)
      vertices_[i].thickness = places_->thickness({vertices_[i].X, vertices_[i].normal});
  });
}

/// From how much the normal turns within half an edge on four sides.
double FittedDraft::size_at(const SurfacePlace& place) const {
  double size = edge_;
  while (true) {
    const double step = 0.4 * size;
    const double wanted =
        size * std::clamp(edge_turning * step / size / std::max(most_turning_near(place, step), 1e-9),
                          finest_size, 1.0);
    if (!is_graded_ || wanted > 0.95 * size || wanted <= finest_) return std::max(wanted, finest_);
    size = wanted;
  }
}

/// Largest angle between the normal and those a step away on four sides [rad].
double FittedDraft::most_turning_near(const SurfacePlace& place, double step) const {
  const Vector3 u = place.normal.unitOrthogonal(), v = place.normal.cross(u);
  double most = 0;
  for (const Vector3& way : {u, Vector3(-u), v, Vector3(-v)}) {
    const SurfacePlace other = places_->nearest(place.X + step * way, place.triangle);
    most = std::max(most, std::acos(std::clamp(other.normal.dot(place.normal), -1.0, 1.0)));
  }
  return most;
}

void FittedDraft::add_inside() {
  const BoundingBox box = bounding_box(places_->surface().mesh);
  std::array<int, 3> counts{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    counts[i] = static_cast<int>(std::ceil((box.max[axis] - box.min[axis]) / spacing_)) + 1;
  }
  std::vector<Vector3> lattice;
  for (int k = 0; k < counts[2]; ++k)
    for (int j = 0; j < counts[1]; ++j)
      for (int i = 0; i < counts[0]; ++i)
        for (const double half : {0.0, 0.5}) {
          const Vector3 node(i + half - 0.5 * counts[0], j + half - 0.5 * counts[1],
                             k + half - 0.5 * counts[2]);
          lattice.emplace_back(middle_ + spacing_ * node);
        }
  std::vector<std::uint8_t> is_taken(lattice.size(), 0);
  parallel_for(lattice.size(), points_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3& X = lattice[i];
      if (!(box.min.array() < X.array()).all() || !(X.array() < box.max.array()).all()) continue;
      if (places_->is_known_outside(X) || places_->is_near(X, inside_clearance * spacing_) ||
          !places_->is_inside(X))
        continue;
      is_taken[i] = 1;
    }
  });
  for (std::size_t i = 0; i < lattice.size(); ++i)
    if (is_taken[i] != 0) vertices_.push_back({.X = lattice[i], .kind = Kind::inside});
  if (is_graded_) add_finer_inside();
}

/// Points of lattices with halves, quarters, ... of the spacing where edges on the surface nearby are
/// shorter.
void FittedDraft::add_finer_inside() {
  std::vector<std::size_t> fine;
  PointCubes cubes(reach_of_grading * spacing_), inside(0.5 * spacing_);
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    const FittedVertex& vertex = vertices_[v];
    if (vertex.kind == Kind::inside) inside.add(vertex.X, static_cast<Index>(v));
    if (vertex.kind != Kind::surface || vertex.size > finer_inside * edge_) continue;
    fine.push_back(v);
    cubes.add(vertex.X, static_cast<Index>(v));
  }
  const auto wanted_at = [&](const Vector3& X) {
    double wanted = edge_;
    cubes.visit_near(X, [&](const Vector3& place, Index v) {
      wanted = std::min(wanted, vertices_[static_cast<std::size_t>(v)].size + grading * (X - place).norm());
    });
    return wanted;
  };
  for (double spacing = 0.5 * spacing_; spacing > finer_inside * finest_; spacing *= 0.5) {
    const double largest = finer_inside * edge_share * 2 * spacing;  // wanted edges of points of this lattice
    std::set<std::array<std::int64_t, 3>> nodes;  // in halves of the spacing: all even or all odd
    for (const std::size_t v : fine) {
      const double reach = std::min((largest - vertices_[v].size) / grading, reach_of_grading * spacing_);
      if (!(reach > 0)) continue;
      std::array<std::int64_t, 3> low{}, high{};
      for (std::size_t i = 0; i < 3; ++i) {
        const auto axis = static_cast<Eigen::Index>(i);
        const double at = vertices_[v].X[axis] - middle_[axis];
        low[i] = static_cast<std::int64_t>(std::ceil(2 * (at - reach) / spacing));
        high[i] = static_cast<std::int64_t>(std::floor(2 * (at + reach) / spacing));
      }
      for (std::int64_t k = low[2]; k <= high[2]; ++k)
        for (std::int64_t j = low[1]; j <= high[1]; ++j)
          for (std::int64_t i = low[0]; i <= high[0]; ++i)
            if ((i & 1) == (j & 1) && (j & 1) == (k & 1)) nodes.insert({k, j, i});
    }
    for (const auto& [k, j, i] : nodes) {
      const Vector3 X =
          middle_ +
          0.5 * spacing * Vector3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
      if (wanted_at(X) > largest || places_->is_known_outside(X) ||
          places_->is_near(X, inside_clearance * spacing) || !places_->is_inside(X))
        continue;
      bool is_free = true;
      inside.visit_near(X, [&](const Vector3& other, Index) {
        is_free = is_free && (other - X).norm() > inside_clearance * spacing;
      });
      if (!is_free) continue;
      inside.add(X, static_cast<Index>(vertices_.size()));
      vertices_.push_back({.X = X, .kind = Kind::inside});
    }
  }
}

Delaunay::Point FittedDraft::grid_point(const Vector3& X) const {
  Delaunay::Point point{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    point[i] =
        Delaunay::extent / 2 + static_cast<std::int32_t>(std::lround((X[axis] - middle_[axis]) / unit_));
  }
  return point;
}

void FittedDraft::insert(Index vertex) {
  const Index number = delaunay_.insert(grid_point(vertices_[static_cast<std::size_t>(vertex)].X));
  number_of_.resize(vertices_.size(), -1);
  number_of_[static_cast<std::size_t>(vertex)] = number;
  if (number == static_cast<Index>(vertex_of_.size())) vertex_of_.push_back(vertex);
}

void FittedDraft::connect() {
  delaunay_ = Delaunay();
  known_.clear();
  number_of_.assign(vertices_.size(), -1);
  vertex_of_.assign(Delaunay::num_corners, -1);
  std::vector<std::pair<std::uint64_t, Index>> order;
  for (Index v = 0; v < static_cast<Index>(vertices_.size()); ++v)
    order.emplace_back(morton(grid_point(vertices_[static_cast<std::size_t>(v)].X)), v);
  std::ranges::sort(order);
  for (const auto& [code, v] : order) insert(v);
  split_lines();
  find_cells();
}

/// Adds points in the middle of edges of lines that are no edges of tetrahedra.
void FittedDraft::split_lines() {
  for (int round = 0; round < most_line_splits; ++round) {
    std::vector<std::int64_t> edges;
    for (const auto& tetrahedron : delaunay_.tetrahedra()) {
      if (!tetrahedron.is_there()) continue;
      const auto& n = tetrahedron.nodes;
      const auto is_on_line = [&](Index number) {
        const Index v = vertex_of_[static_cast<std::size_t>(number)];
        return v >= 0 && vertices_[static_cast<std::size_t>(v)].kind <= Kind::line;
      };
      std::array<bool, 4> is_on{};
      for (std::size_t i = 0; i < 4; ++i) is_on[i] = is_on_line(n[i]);
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j)
          if (is_on[i] && is_on[j]) edges.push_back(edge_key(n[i], n[j]));
    }
    std::ranges::sort(edges);
    std::vector<Index> added;
    for (std::size_t l = 0; l < sequences_.size(); ++l) {
      std::vector<Index>& sequence = sequences_[l];
      const CreaseLine& line = features_.lines[l];
      std::vector<Index> longer;
      for (std::size_t i = 0; i < sequence.size(); ++i) {
        longer.push_back(sequence[i]);
        if (i + 1 == sequence.size()) break;
        const auto a = static_cast<std::size_t>(sequence[i]), b = static_cast<std::size_t>(sequence[i + 1]);
        if (std::ranges::binary_search(edges, edge_key(number_of_[a], number_of_[b]))) continue;
        const double size = (vertices_[a].X - vertices_[b].X).norm();
        if (size < 2 * least_gap_) continue;
        const Vector3 halfway = 0.5 * (vertices_[a].X + vertices_[b].X);
        const double s = line.nearest(halfway);
        const Vector3 X = line.at(s);
        if ((X - halfway).norm() > 0.5 * size) continue;
        longer.push_back(static_cast<Index>(vertices_.size()));
        added.push_back(longer.back());
        vertices_.push_back({.X = X,
                             .kind = Kind::line,
                             .line = static_cast<Index>(l),
                             .s = s,
                             .thickness = std::numeric_limits<double>::infinity()});
      }
      sequence = std::move(longer);
    }
    if (added.empty()) return;
    for (const Index v : added) insert(v);
  }
}

/// Tetrahedra with their middle inside, without those of no volume.
void FittedDraft::find_cells() {
  const auto& tetrahedra = delaunay_.tetrahedra();
  is_cell_.assign(tetrahedra.size(), 0);
  known_.resize(tetrahedra.size());
  const auto vertices_of = [&](const Delaunay::Tetrahedron& tetrahedron) {
    Nodes nodes{};
    for (std::size_t i = 0; i < 4; ++i) nodes[i] = vertex_of_[static_cast<std::size_t>(tetrahedron.nodes[i])];
    return nodes;
  };
  parallel_for(tetrahedra.size(), points_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      if (!tetrahedra[t].is_there() || std::ranges::min(tetrahedra[t].nodes) < Delaunay::num_corners)
        continue;
      Known& known = known_[t];
      if (known.birth != tetrahedra[t].birth) {
        Vector3 sum = Vector3::Zero();
        for (const Index v : vertices_of(tetrahedra[t])) sum += vertices_[static_cast<std::size_t>(v)].X;
        known = {tetrahedra[t].birth, places_->is_inside(sum / 4), {}};
      }
      is_cell_[t] = static_cast<std::uint8_t>(known.is_inside);
    }
  });
  cells_.clear();
  place_of_cell_.clear();
  for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
    if (is_cell_[t] == 0) continue;
    cells_.push_back(vertices_of(tetrahedra[t]));
    place_of_cell_.push_back(static_cast<Index>(t));
  }
}

std::vector<FittedDraft::Side> FittedDraft::sides() {
  std::vector<Side> result;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const auto t = static_cast<std::size_t>(place_of_cell_[c]);
    for (std::size_t i = 0; i < 4; ++i) {
      const Index other = delaunay_.tetrahedra()[t].neighbors[i];
      if (other >= 0 && is_cell_[static_cast<std::size_t>(other)] != 0) continue;
      const auto& [a, b, d] = side_nodes[i];
      result.push_back({{cells_[c][a], cells_[c][b], cells_[c][d]}, &known_[t].is_fine[i]});
    }
  }
  return result;
}

/// Adds points of the surface where sides of cells are far from it. @return how many
std::size_t FittedDraft::refine() {
  const std::vector<Side> all = sides();
  std::vector<SurfacePlace> nearest(all.size());
  std::vector<std::uint8_t> is_far(all.size(), 0);
  parallel_for(all.size(), points_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (*all[i].is_fine != 0) continue;
      double thickness = std::numeric_limits<double>::infinity();
      Vector3 sum = Vector3::Zero();
      Index hint = -1;
      for (const Index v : all[i].nodes) {
        const FittedVertex& vertex = vertices_[static_cast<std::size_t>(v)];
        sum += vertex.X;
        hint = std::max(hint, vertex.triangle);
        if (vertex.kind != Kind::inside) thickness = std::min(thickness, vertex.thickness);
      }
      const double allowed = std::min(flat_enough * edge_, thin_enough * thickness);
      nearest[i] = places_->nearest(sum / 3, hint);
      if ((nearest[i].X - sum / 3).norm() <= allowed) {
        *all[i].is_fine = 1;
        continue;
      }
      bool has_room = true;
      for (const Index v : all[i].nodes)
        has_room = has_room &&
                   (vertices_[static_cast<std::size_t>(v)].X - nearest[i].X).norm() > finest_edge * edge_;
      is_far[i] =
          static_cast<std::uint8_t>(has_room && (!places_->has_overlaps() || places_->is_rim(nearest[i])));
    }
  });
  PointCubes cubes(0.5 * edge_);
  std::size_t num_added = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (is_far[i] == 0) continue;
    double longest = 0;
    for (const Index a : all[i].nodes)
      for (const Index b : all[i].nodes)
        longest = std::max(
            longest,
            (vertices_[static_cast<std::size_t>(a)].X - vertices_[static_cast<std::size_t>(b)].X).norm());
    bool is_free = true;
    const double room = std::min(0.4 * longest, 0.5 * edge_);
    cubes.visit_near(nearest[i].X, [&](const Vector3& X, Index) {
      is_free = is_free && (X - nearest[i].X).norm() >= room;
    });
    if (!is_free) continue;
    cubes.add(nearest[i].X, 0);
    vertices_.push_back({.X = nearest[i].X,
                         .kind = Kind::surface,
                         .normal = nearest[i].normal,
                         .thickness = places_->thickness(nearest[i]),
                         .triangle = nearest[i].triangle});
    insert(static_cast<Index>(vertices_.size()) - 1);
    ++num_added;
  }
  return num_added;
}

void FittedDraft::relax() {
  std::vector<Vector3> sums(vertices_.size(), Vector3::Zero());
  std::vector<double> weights(vertices_.size(), 0);
  for (const Nodes& cell : cells_) {
    const auto X = [&](std::size_t i) -> const Vector3& {
      return vertices_[static_cast<std::size_t>(cell[i])].X;
    };
    const double volume = std::abs((X(1) - X(0)).dot((X(2) - X(0)).cross(X(3) - X(0))));
    const Vector3 middle = (X(0) + X(1) + X(2) + X(3)) / 4;
    for (const Index v : cell) {
      if (vertices_[static_cast<std::size_t>(v)].kind != Kind::inside) continue;
      sums[static_cast<std::size_t>(v)] += volume * middle;
      weights[static_cast<std::size_t>(v)] += volume;
    }
  }
  for (const Side& side : sides()) {
    const auto X = [&](std::size_t i) -> const Vector3& {
      return vertices_[static_cast<std::size_t>(side.nodes[i])].X;
    };
    const double area = (X(1) - X(0)).cross(X(2) - X(0)).norm();
    const Vector3 middle = (X(0) + X(1) + X(2)) / 3;
    for (const Index v : side.nodes) {
      if (vertices_[static_cast<std::size_t>(v)].kind != Kind::surface) continue;
      sums[static_cast<std::size_t>(v)] += area * middle;
      weights[static_cast<std::size_t>(v)] += area;
    }
  }
  parallel_for(vertices_.size(), points_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (!(weights[v] > 0)) continue;
      FittedVertex& vertex = vertices_[v];
      const Vector3 wanted = sums[v] / weights[v];
      if (vertex.kind == Kind::inside) {
        vertex.X = wanted;
        continue;
      }
      const SurfacePlace place = places_->nearest(wanted, vertex.triangle);
      if (place.normal.dot(vertex.normal) < 0.5 || (place.X - vertex.X).norm() > 0.5 * edge_) continue;
      vertex.X = place.X;
      vertex.normal = place.normal;
      vertex.triangle = place.triangle;
    }
  });
  connect();
  refine_all();
}

std::vector<std::array<Index, 2>> FittedDraft::line_edges() const {
  std::vector<std::array<Index, 2>> edges;
  for (const auto& sequence : sequences_)
    for (std::size_t i = 0; i + 1 < sequence.size(); ++i)
      edges.push_back({std::min(sequence[i], sequence[i + 1]), std::max(sequence[i], sequence[i + 1])});
  std::ranges::sort(edges);
  return edges;
}

}  // namespace resilin
