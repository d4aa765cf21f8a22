#include "resilin/mesh/bcc_grid.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace resilin {
namespace {

constexpr double touching = 1e-9;  // tolerance relative to half a spacing: nearer points are met
constexpr int padding = 2;         // cubes on every side: what is added around a node is there

/// A tetrahedron beside the corner of its cube: corners, and sides n . x <= c with whole numbers.
struct Shape {
  std::array<std::array<int, 3>, 4> corners{};
  std::array<Vector3, 4> normals{};
  std::array<double, 4> offsets{};
  Vector3 low, high;
};

Vector3 as_vector(const std::array<int, 3>& node) { return Vector3(node[0], node[1], node[2]); }

Shape make_shape(int axis, int edge) {
  const auto d = static_cast<std::size_t>(axis), e = (d + 1) % 3, f = (d + 2) % 3;
  constexpr std::array<std::array<int, 2>, 4> around = {{{0, 0}, {2, 0}, {2, 2}, {0, 2}}};
  const auto corner_of_face = [&](int i) {
    const auto& place = around[static_cast<std::size_t>(i) % 4];
    std::array<int, 3> corner{};
    corner[d] = 2;
    corner[e] = place[0];
    corner[f] = place[1];
    return corner;
  };
  Shape shape;
  std::array<int, 3> next = {1, 1, 1};
  next[d] = 3;
  shape.corners = {{{1, 1, 1}, corner_of_face(edge), corner_of_face(edge + 1), next}};
  shape.low = shape.high = as_vector(shape.corners[0]);
  for (const auto& corner : shape.corners) {
    shape.low = shape.low.cwiseMin(as_vector(corner));
    shape.high = shape.high.cwiseMax(as_vector(corner));
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3 a = as_vector(shape.corners[(i + 1) % 4]), b = as_vector(shape.corners[(i + 2) % 4]),
                  c = as_vector(shape.corners[(i + 3) % 4]);
    Vector3 n = (b - a).cross(c - a);
    if (n.dot(as_vector(shape.corners[i]) - a) > 0) n = -n;
    shape.normals[i] = n.normalized();
    shape.offsets[i] = shape.normals[i].dot(a);
  }
  return shape;
}

/// By axis, then by edge of the face.
const std::array<Shape, BccGrid::shapes>& all_shapes() {
  static const std::array<Shape, BccGrid::shapes> made = [] {
    std::array<Shape, BccGrid::shapes> all;
    for (int i = 0; i < static_cast<int>(BccGrid::shapes); ++i)
      all[static_cast<std::size_t>(i)] = make_shape(i / 4, i % 4);
    return all;
  }();
  return made;
}

/// Whether something is left of the triangle when all that is outside a side has been cut off.
bool meets(const Shape& shape, const std::array<Vector3, 3>& triangle) {
  std::array<Vector3, 8> polygon, cut;  // each side adds one corner at most: 3 + 4
  std::copy(triangle.begin(), triangle.end(), polygon.begin());
  std::size_t size = 3;
  for (std::size_t side = 0; side < 4 && size > 0; ++side) {
    std::size_t left = 0;
    const auto excess = [&](const Vector3& x) {
      return shape.normals[side].dot(x) - shape.offsets[side] - touching;
    };
    for (std::size_t i = 0; i < size; ++i) {
      const Vector3 &a = polygon[i], &b = polygon[(i + 1) % size];
      const double at_a = excess(a), at_b = excess(b);
      if (at_a <= 0) cut[left++] = a;
      if ((at_a <= 0) != (at_b <= 0)) cut[left++] = a + at_a / (at_a - at_b) * (b - a);
    }
    std::swap(polygon, cut);
    size = left;
  }
  return size > 0;
}

}  // namespace

std::size_t BccGrid::count_cubes(const Vector3& low, const Vector3& high, double spacing) {
  double count = 1;
  for (int i = 0; i < 3; ++i) count *= std::floor((high[i] - low[i]) / spacing) + 1 + 2 * padding;
  return count <= most_cubes ? static_cast<std::size_t>(count) : most_cubes + 1;
}

BccGrid::BccGrid(const Vector3& low, const Vector3& high, double spacing) : half_(0.5 * spacing) {
  assert(count_cubes(low, high, spacing) <= most_cubes);
  std::size_t count = shapes;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double extent = high[axis] - low[axis];
    size_[i] = static_cast<int>(std::floor(extent / spacing)) + 1 + 2 * padding;
    origin_[axis] = low[axis] + 0.5 * extent - half_ * size_[i];
    count *= static_cast<std::size_t>(size_[i]);
  }
  is_chosen_.assign(count, 0);
}

BccGrid::Cube BccGrid::cube(std::size_t tetrahedron) const {
  const auto number = static_cast<int>(tetrahedron / shapes);
  return {number % size_[0], number / size_[0] % size_[1], number / (size_[0] * size_[1])};
}

std::size_t BccGrid::first_tetrahedron(const Cube& cube) const {
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  return shapes * (at(cube[0]) + at(size_[0]) * (at(cube[1]) + at(size_[1]) * at(cube[2])));
}

/// The last cubes have no next one: their tetrahedra are none.
bool BccGrid::has(const Cube& cube) const {
  for (std::size_t i = 0; i < 3; ++i)
    if (cube[i] < 0 || cube[i] >= size_[i]) return false;
  return true;
}

Vector3 BccGrid::place(const Node& node) const { return origin_ + half_ * as_vector(node); }

Vector3 BccGrid::middle(std::size_t tetrahedron) const {
  const Cube corner = cube(tetrahedron);
  Vector3 sum = Vector3::Zero();
  for (const auto& offset : all_shapes()[tetrahedron % shapes].corners) sum += as_vector(offset);
  return origin_ + half_ * (2 * as_vector(corner) + sum / 4);
}

void BccGrid::choose_met_by(const std::array<Vector3, 3>& triangle) {
  std::array<Vector3, 3> corners;
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (std::size_t i = 0; i < 3; ++i) {
    corners[i] = (triangle[i] - origin_) / half_;
    low = low.cwiseMin(corners[i]);
    high = high.cwiseMax(corners[i]);
  }
  Cube first{}, last{};
  for (std::size_t i = 0; i < 3; ++i) {  // a tetrahedron lies within its cube and the next
    const auto axis = static_cast<Eigen::Index>(i);
    first[i] = std::max(static_cast<int>(std::floor(0.5 * low[axis])) - 1, 0);
    last[i] = std::min(static_cast<int>(std::floor(0.5 * high[axis])), size_[i] - 1);
  }
  const auto& list = all_shapes();
  for (int k = first[2]; k <= last[2]; ++k)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int i = first[0]; i <= last[0]; ++i) {
        const Vector3 corner(2 * i, 2 * j, 2 * k);
        const std::size_t number = first_tetrahedron({i, j, k});
        for (std::size_t s = 0; s < shapes; ++s) {
          const Shape& shape = list[s];
          if (is_chosen_[number + s] != 0) continue;
          if (((corner + shape.low).array() > high.array() + touching).any()) continue;
          if (((corner + shape.high).array() < low.array() - touching).any()) continue;
          if (meets(shape, {corners[0] - corner, corners[1] - corner, corners[2] - corner}))
            choose(number + s);
        }
      }
}

Index BccGrid::choose_around(std::span<const Node> nodes) {
  Index num_new = 0;
  const Node& center = nodes[0];
  for (int dk = -2; dk <= 1; ++dk)
    for (int dj = -2; dj <= 1; ++dj)
      for (int di = -2; di <= 1; ++di) {
        const Cube corner = {center[0] / 2 + di, center[1] / 2 + dj, center[2] / 2 + dk};
        if (!has(corner)) continue;
        for (std::size_t s = 0; s < shapes; ++s) {
          const auto& corners = all_shapes()[s].corners;
          const bool has_all = std::ranges::all_of(nodes, [&](const Node& node) {
            return std::ranges::any_of(corners, [&](const auto& offset) {
              return 2 * corner[0] + offset[0] == node[0] && 2 * corner[1] + offset[1] == node[1] &&
                     2 * corner[2] + offset[2] == node[2];
            });
          });
          const std::size_t number = first_tetrahedron(corner) + s;
          if (!has_all || is_chosen(number)) continue;
          choose(number);
          ++num_new;
        }
      }
  return num_new;
}

BccGrid::Chosen BccGrid::chosen() const {
  Chosen result;
  std::vector<Index>& cells = result.mesh.block(CellKind::tetrahedron).nodes;
  // Corners and middles of cubes, those beside the last cubes too, in one array each of a cube more.
  const std::array<std::size_t, 3> width = {static_cast<std::size_t>(size_[0]) + 1,
                                            static_cast<std::size_t>(size_[1]) + 1,
                                            static_cast<std::size_t>(size_[2]) + 1};
  std::vector<Index> numbers(2 * width[0] * width[1] * width[2], -1);
  const auto number_of = [&](const Node& node) -> Index& {
    const auto half = [&](std::size_t i) { return static_cast<std::size_t>(node[i] / 2); };
    return numbers[2 * (half(0) + width[0] * (half(1) + width[1] * half(2))) +
                   static_cast<std::size_t>(node[0] % 2)];
  };
  for (std::size_t t = 0; t < num_tetrahedra(); ++t) {
    if (!is_chosen(t)) continue;
    const Cube corner = cube(t);
    for (const auto& offset : all_shapes()[t % shapes].corners) {
      const Node node = {2 * corner[0] + offset[0], 2 * corner[1] + offset[1], 2 * corner[2] + offset[2]};
      Index& number = number_of(node);
      if (number < 0) {
        number = static_cast<Index>(result.nodes.size());
        result.nodes.push_back(node);
        result.mesh.vertices.push_back(place(node));
      }
      cells.push_back(number);
    }
  }
  return result;
}

}  // namespace resilin
