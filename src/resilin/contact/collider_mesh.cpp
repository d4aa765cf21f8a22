#include "resilin/contact/collider_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <span>

#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr Index sides_around = 64;  ///< number of sides of round shapes

/// Facets around an axis, ring by ring from its start to its end.
class Lathe {
 public:
  explicit Lathe(const Vector3& axis)
      : axis_(axis.normalized()), first_(axis_.unitOrthogonal()), second_(axis_.cross(first_)) {}

  void add_tip(const Vector3& place) {
    mesh_.vertices.push_back(place);
    const Index tip = last();
    if (previous_ >= 0) add_fan(tip, previous_, false);
    previous_ = -1;
    tip_ = tip;
  }
  void add_ring(const Vector3& center, double radius) {
    const auto ring = static_cast<Index>(mesh_.vertices.size());
    for (Index i = 0; i < sides_around; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides_around;
      mesh_.vertices.push_back(center + radius * (std::cos(angle) * first_ + std::sin(angle) * second_));
    }
    if (tip_ >= 0) add_fan(tip_, ring, true);
    tip_ = -1;
    if (previous_ >= 0) add_band(previous_, ring);
    previous_ = ring;
  }
  ColliderMesh take() { return std::move(mesh_); }

 private:
  Index last() const { return static_cast<Index>(mesh_.vertices.size()) - 1; }
  void add(Index a, Index b, Index c) { mesh_.facets.insert(mesh_.facets.end(), {a, b, c}); }
  void add_fan(Index tip, Index ring, bool is_start) {
    for (Index i = 0; i < sides_around; ++i) {
      const Index a = ring + i, b = ring + (i + 1) % sides_around;
      is_start ? add(tip, b, a) : add(tip, a, b);
    }
  }
  void add_band(Index low, Index high) {
    for (Index i = 0; i < sides_around; ++i) {
      const Index j = (i + 1) % sides_around;
      add(low + i, low + j, high + j);
      add(low + i, high + j, high + i);
    }
  }

  Vector3 axis_, first_, second_;
  ColliderMesh mesh_;
  Index previous_ = -1;  ///< ring
  Index tip_ = -1;
};

/// A closed polyline.
ColliderMesh loop(std::vector<Vector3> vertices) {
  ColliderMesh mesh{.vertices = std::move(vertices), .facets = {}};
  const auto count = static_cast<Index>(mesh.vertices.size());
  for (Index i = 0; i < count; ++i) mesh.facets.insert(mesh.facets.end(), {i, (i + 1) % count});
  return mesh;
}

ColliderMesh flat_capsule(const Vector3& start, const Vector3& end, double radius) {
  const Vector3 along = (end - start).normalized(), across = Vector3(-along.y(), along.x(), 0);
  std::vector<Vector3> vertices;
  const auto add_half = [&](const Vector3& center, double turn) {
    for (Index i = 0; i <= sides_around / 2; ++i) {
      const double angle = turn + 2 * std::numbers::pi * i / sides_around;
      vertices.push_back(center + radius * (std::cos(angle) * along + std::sin(angle) * across));
    }
  };
  add_half(end, -0.5 * std::numbers::pi);
  add_half(start, 0.5 * std::numbers::pi);
  return loop(std::move(vertices));
}

/// Corners in 2D, by which signs they have along x and y.
constexpr std::array<std::array<double, 2>, 4> corners_of_square = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};

}  // namespace

ColliderMesh collider_mesh(const Mesh& mesh, int dim) {
  ColliderMesh result;
  std::vector<Index> new_numbers(mesh.vertices.size(), -1);
  const auto add = [&](std::initializer_list<Index> corners) {
    for (const Index old : corners) {
      Index& number = new_numbers[static_cast<std::size_t>(old)];
      if (number < 0) {
        number = static_cast<Index>(result.vertices.size());
        result.vertices.push_back(mesh.vertices[static_cast<std::size_t>(old)]);
      }
      result.facets.push_back(number);
    }
  };
  const auto add_cell = [&](CellKind kind, std::span<const Index> v) {
    const bool is_flat = dim == 2;
    switch (first_order(kind)) {
      case CellKind::point:
        return is_flat ? add({v[0], v[0]}) : add({v[0], v[0], v[0]});
      case CellKind::line:
        return is_flat ? add({v[0], v[1]}) : add({v[0], v[1], v[1]});
      case CellKind::triangle:
        return add({v[0], v[1], v[2]});
      case CellKind::quadrilateral:
        add({v[0], v[1], v[2]});
        return add({v[0], v[2], v[3]});
      default:
        return;
    }
  };
  const auto add_block = [&](const CellBlock& block) {
    for (Index cell = 0; cell < block.num_cells(); ++cell) add_cell(block.kind, block.cell(cell));
  };
  if (const CellBlock* solid = mesh.find_solid(dim)) {
    add_block(boundary(*solid).facets);
    return result;
  }
  for (const CellBlock& block : mesh.blocks)
    if (dimension(block.kind) < dim) add_block(block);
  const bool is_cloud = mesh.blocks.empty();
  for (Index v = 0; is_cloud && v < static_cast<Index>(mesh.vertices.size()); ++v)
    dim == 2 ? add({v, v}) : add({v, v, v});
  return result;
}

bool is_closed(const ColliderMesh& mesh, int dim) {
  const auto corners = static_cast<std::size_t>(dim);
  std::vector<std::array<Index, 2>> sides;
  for (std::size_t f = 0; f + corners <= mesh.facets.size(); f += corners)
    for (std::size_t k = 0; k < corners; ++k) {
      const Index a = mesh.facets[f + k], b = mesh.facets[f + (k + 1) % corners];
      if (a == b) return false;
      sides.push_back(dim == 2 ? std::array{a, a} : std::array{std::min(a, b), std::max(a, b)});
    }
  std::ranges::sort(sides);
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    const bool is_pair = i + 1 < sides.size() && sides[i] == sides[i + 1];
    if (!is_pair || (i + 2 < sides.size() && sides[i + 2] == sides[i])) return false;
  }
  return true;
}

ColliderMesh box_mesh(const Vector3& center, const Vector3& size, int dim) {
  std::vector<Vector3> vertices;
  const auto add_square = [&](double z) {
    for (const auto& [x, y] : corners_of_square)
      vertices.push_back(center + 0.5 * Vector3(x, y, z).cwiseProduct(size));
  };
  if (dim == 2) {
    add_square(0);
    return loop(std::move(vertices));
  }
  add_square(-1);
  add_square(1);
  return {.vertices = std::move(vertices), .facets = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                                      1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7}};
}

ColliderMesh plate_mesh(const Vector3& center, const Vector3& normal, double side, int dim) {
  const double half = 0.5 * side;
  if (dim == 2) {
    const Vector3 along = half * Vector3(-normal.y(), normal.x(), 0).normalized();
    return {.vertices = {center + along, center - along}, .facets = {0, 1}};
  }
  const Vector3 first = normal.unitOrthogonal(), second = normal.normalized().cross(first);
  ColliderMesh mesh{.vertices = {}, .facets = {0, 1, 2, 0, 2, 3}};
  for (const auto& [x, y] : corners_of_square)
    mesh.vertices.push_back(center + half * (x * first + y * second));
  return mesh;
}

ColliderMesh ball_mesh(const Vector3& center, double radius, int dim) {
  if (dim == 2) {
    std::vector<Vector3> vertices;
    for (Index i = 0; i < sides_around; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides_around;
      vertices.push_back(center + radius * Vector3(std::cos(angle), std::sin(angle), 0));
    }
    return loop(std::move(vertices));
  }
  Lathe lathe(Vector3::UnitZ());
  constexpr Index rings = sides_around / 2;
  lathe.add_tip(center - radius * Vector3::UnitZ());
  for (Index i = 1; i < rings; ++i) {
    const double angle = std::numbers::pi * i / rings;
    lathe.add_ring(center - radius * std::cos(angle) * Vector3::UnitZ(), radius * std::sin(angle));
  }
  lathe.add_tip(center + radius * Vector3::UnitZ());
  return lathe.take();
}

ColliderMesh capsule_mesh(const Vector3& start, const Vector3& end, double radius, int dim) {
  if (dim == 2) return flat_capsule(start, end, radius);
  const Vector3 along = (end - start).normalized();
  Lathe lathe(along);
  constexpr Index rings = sides_around / 4;  // rings of each half ball
  const auto add_ring = [&](const Vector3& center, double latitude) {
    lathe.add_ring(center + radius * std::sin(latitude) * along, radius * std::cos(latitude));
  };
  lathe.add_tip(start - radius * along);
  for (Index i = 1; i <= rings; ++i) add_ring(start, 0.5 * std::numbers::pi * (i - rings) / rings);
  for (Index i = 0; i < rings; ++i) add_ring(end, 0.5 * std::numbers::pi * i / rings);
  lathe.add_tip(end + radius * along);
  return lathe.take();
}

ColliderMesh cylinder_mesh(const Vector3& start, const Vector3& end, double radius) {
  Lathe lathe(end - start);
  lathe.add_tip(start);
  lathe.add_ring(start, radius);
  lathe.add_ring(end, radius);
  lathe.add_tip(end);
  return lathe.take();
}

}  // namespace resilin
