#include "resilin/results/skinned_frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "resilin/view/shown_surface.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin {
namespace {

/// Least and greatest finite number.
std::array<double, 2> range_of(std::span<const double> values) {
  std::array<double, 2> range = {std::numeric_limits<double>::infinity(),
                                 -std::numeric_limits<double>::infinity()};
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    range = {std::min(range[0], value), std::max(range[1], value)};
  }
  return range;
}

class SkinnedFrame {
 public:
  SkinnedFrame(const World& world, const State& state, const VtuContent& frame)
      : world_(world), surface_(world), frame_(frame) {
    place(state);
  }

  VtuContent content() {
    VtuContent skinned;
    skinned.file.mesh.vertices = frame_.file.mesh.vertices;
    skinned.point_data = frame_.point_data;
    keep_bare_cells(skinned);
    for (const ShownSurface::Part& part : surface_.parts())
      if (part.kind == ShownSurface::Kind::skin) add(part, skinned);
    VtuValues bodies{.name = "body", .components = 1, .values = {}};
    for (const CellBlock& block : skinned.file.mesh.blocks) {
      const std::vector<double>& numbers = bodies_[block.kind];
      bodies.values.insert(bodies.values.end(), numbers.begin(), numbers.end());
    }
    skinned.cell_data.push_back(std::move(bodies));
    return skinned;
  }

 private:
  void place(const State& state) {
    const auto n = static_cast<std::size_t>(surface_.num_vertices());
    displacements_.resize(3 * n);
    surface_.positions(state.positions - world_.rest_positions, displacements_);
  }

  /// Cells of bodies without a skin; the frame has one number for each cell, that of its body, in their
  /// order.
  void keep_bare_cells(VtuContent& skinned) {
    const VtuValues& bodies = frame_.cell_data.front();
    std::size_t cell = 0;
    for (const CellBlock& block : frame_.file.mesh.blocks)
      for (Index i = 0; i < block.num_cells(); ++i, ++cell) {
        if (is_shown_by_skin(world_.bodies[static_cast<std::size_t>(bodies.values[cell])])) continue;
        std::vector<Index>& nodes = skinned.file.mesh.block(block.kind).nodes;
        nodes.insert(nodes.end(), block.cell(i).begin(), block.cell(i).end());
        bodies_[block.kind].push_back(bodies.values[cell]);
      }
  }

  void add(const ShownSurface::Part& part, VtuContent& skinned) {
    const auto base = static_cast<Index>(skinned.file.mesh.vertices.size());
    const auto first = static_cast<std::size_t>(part.first_vertex);
    const auto count = static_cast<std::size_t>(part.num_vertices);
    for (std::size_t v = first; v < first + count; ++v) {
      Vector3 place = world_.origin;
      for (std::size_t k = 0; k < 3; ++k)
        place[static_cast<Eigen::Index>(k)] += static_cast<double>(surface_.rest_positions()[3 * v + k]) +
                                               static_cast<double>(displacements_[3 * v + k]);
      skinned.file.mesh.vertices.push_back(place);
    }
    std::vector<Index>& nodes = skinned.file.mesh.block(CellKind::triangle).nodes;
    for (const auto& triangle : surface_.triangles().subspan(static_cast<std::size_t>(part.first_triangle),
                                                             static_cast<std::size_t>(part.num_triangles)))
      for (const std::uint32_t v : triangle)
        nodes.push_back(base + static_cast<Index>(v) - part.first_vertex);
    std::vector<double>& bodies = bodies_[CellKind::triangle];
    bodies.insert(bodies.end(), static_cast<std::size_t>(part.num_triangles), static_cast<double>(part.body));
    for (VtuValues& array : skinned.point_data) carry(part, array);
  }

  void carry(const ShownSurface::Part& part, VtuValues& array) {
    const Body& body = world_.bodies[part.body];
    const auto width = static_cast<std::size_t>(array.components);
    const auto first = static_cast<std::size_t>(part.first_vertex);
    const auto count = static_cast<std::size_t>(part.num_vertices);
    const std::size_t begin = array.values.size();
    array.values.resize(begin + width * count);
    if (array.name == "displacement") {
      std::copy_n(displacements_.begin() + static_cast<std::ptrdiff_t>(3 * first), 3 * count,
                  array.values.begin() + static_cast<std::ptrdiff_t>(begin));
      return;
    }
    std::vector<double> nodal(static_cast<std::size_t>(world_.num_nodes()));
    std::vector<float> carried(static_cast<std::size_t>(surface_.num_vertices()));
    for (std::size_t k = 0; k < width; ++k) {
      for (std::size_t node = 0; node < nodal.size(); ++node) nodal[node] = array.values[width * node + k];
      surface_.interpolate(nodal, carried);
      if (body.rigid) {  // affine maps are exact beyond the control nodes, too
        for (std::size_t v = 0; v < count; ++v)
          array.values[begin + width * v + k] = static_cast<double>(carried[first + v]);
        continue;
      }
      const auto [least, greatest] = range_of(std::span(nodal).subspan(
          static_cast<std::size_t>(body.first_node), static_cast<std::size_t>(body.num_nodes)));
      for (std::size_t v = 0; v < count; ++v) {
        const auto value = static_cast<double>(carried[first + v]);
        array.values[begin + width * v + k] =
            std::isfinite(value) && least <= greatest ? std::clamp(value, least, greatest) : value;
      }
    }
  }

  const World& world_;
  ShownSurface surface_;
  const VtuContent& frame_;
  std::vector<float> displacements_;
  std::map<CellKind, std::vector<double>> bodies_;  ///< number of the body of each cell that is kept, by kind
};

}  // namespace

VtuContent with_skins(const World& world, const State& state, const VtuContent& frame) {
  return SkinnedFrame(world, state, frame).content();
}

}  // namespace resilin
