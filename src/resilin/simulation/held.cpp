// Which rigid motions of a body nothing holds.

#include <Eigen/Eigenvalues>
#include <string>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/energy/facet.hpp"
#include "resilin/mesh/topology.hpp"
#include "resilin/simulation/world.hpp"

namespace resilin {
namespace {

/// Rows: components of a node's motion; columns: 3 translations and 3 rotations (2D: 2 and 1) about `center`,
/// lengths in units of `size` so that all columns count alike.
Eigen::MatrixXd rigid_motions(int dim, const Vector3& X, const Vector3& center, double size) {
  const Vector3 r = (X - center) / size;
  if (dim == 2) {
    Eigen::MatrixXd motions(2, 3);
    motions << 1, 0, -r.y(), 0, 1, r.x();
    return motions;
  }
  Eigen::MatrixXd motions(3, 6);
  motions << 1, 0, 0, 0, r.z(), -r.y(), 0, 1, 0, -r.z(), 0, r.x(), 0, 0, 1, r.y(), -r.x(), 0;
  return motions;
}

struct Part {
  Vector3 center = Vector3::Zero();
  double size = 0;
  Index num_vertices = 0;
  Eigen::MatrixXd gram;  ///< sum of r^T r over the held components: its rank is the number of held motions
};

}  // namespace

void check_is_held(const World& world, const std::vector<Index>& held_nodes) {
  const int dim = world.dimension;
  const int num_motions = dim == 3 ? 6 : 3;
  std::vector<std::uint8_t> is_held(world.is_fixed.size(), 0);
  for (std::size_t i = 0; i < is_held.size(); ++i) is_held[i] = world.support_of[i] >= 0 ? 1 : 0;
  for (const Index node : held_nodes) {
    for (int k = 0; k < dim; ++k) is_held[static_cast<std::size_t>(node * dim + k)] = 1;
  }
  for (const Body& body : world.bodies) {
    CellBlock block{.kind = body.cell_kind, .nodes = body.cells};
    for (Index& node : block.nodes) node -= body.first_node;
    const Components components = connected_components(block, body.num_nodes);
    std::vector<Part> parts(static_cast<std::size_t>(components.count));
    const auto for_each_vertex = [&](const auto& visit) {
      for (Index v = 0; v < body.num_nodes; ++v) {
        const Index part = components.of_vertex[static_cast<std::size_t>(v)];
        if (part >= 0) visit(parts[static_cast<std::size_t>(part)], body.first_node + v);
      }
    };
    for_each_vertex([&](Part& part, Index node) {
      part.center += node_position(dim, node, world.rest_positions);
      ++part.num_vertices;
    });
    for (Part& part : parts) part.center /= part.num_vertices;
    for_each_vertex([&](Part& part, Index node) {
      part.size = std::max(part.size, (node_position(dim, node, world.rest_positions) - part.center).norm());
    });
    for (Part& part : parts) part.gram = Eigen::MatrixXd::Zero(num_motions, num_motions);
    for_each_vertex([&](Part& part, Index node) {
      const Eigen::MatrixXd motions =
          rigid_motions(dim, node_position(dim, node, world.rest_positions), part.center, part.size);
      for (int k = 0; k < dim; ++k) {
        if (is_held[static_cast<std::size_t>(node * dim + k)] == 0) continue;
        part.gram += motions.row(k).transpose() * motions.row(k);
      }
    });
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(parts[p].gram);
      const double largest = std::max(solver.eigenvalues().maxCoeff(), 1e-300);
      const auto held = (solver.eigenvalues().array() > 1e-12 * largest).count();
      if (held == num_motions) continue;
      std::string where = "body \"" + body.name + "\"";
      if (parts.size() > 1) {
        where += ", component " + std::to_string(p + 1) + " (" + std::to_string(parts[p].num_vertices) +
                 " vertices around (" + format_number(parts[p].center.x()) + ", " +
                 format_number(parts[p].center.y()) + ", " + format_number(parts[p].center.z()) + "))";
      }
      throw InputError(
          world.place,
          where + " is not held: " + std::to_string(num_motions - held) + " of " +
              std::to_string(num_motions) +
              " rigid motions are free in a static run; add a [[fix]] on three vertices that are not in "
              "a line (2D: two vertices), or let simulation.kind be \"dynamic\"");
    }
  }
}

}  // namespace resilin
