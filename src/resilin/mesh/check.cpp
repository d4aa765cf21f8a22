#include "resilin/mesh/check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/overlap.hpp"
#include "resilin/mesh/quality.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

constexpr std::size_t most_issues_of_a_kind = 3;

/// Collects the issues of one mesh.
class Examiner {
 public:
  Examiner(const Mesh& mesh, const Numbering& numbering) : mesh_(mesh), numbering_(numbering) {}

  MeshReport report;

  /// The block of `kind`, when cells and vertices are fit to be computed with; else errors say why not.
  const CellBlock* usable_block(CellKind kind) {
    check_kinds(kind);
    check_coordinates();
    for (std::size_t b = 0; b < mesh_.blocks.size(); ++b) check_indices(b);
    if (!report.errors.empty()) return nullptr;
    block_number_ = static_cast<std::size_t>(mesh_.find_block(kind) - mesh_.blocks.data());
    return &mesh_.blocks[block_number_];
  }

  void check_plane() {
    std::vector<Index> outside;
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) {
      if (mesh_.vertices[v].z() != 0) outside.push_back(static_cast<Index>(v));
    }
    if (!outside.empty()) {
      error(numbering_.vertex_list(outside), "z is not zero, but a 2D mesh lies in the plane z = 0");
    }
  }

  void check_volumes(const CellBlock& block) {
    const bool is_solid = dimension(block.kind) == 3;
    const std::string volume = is_solid ? "volume" : "area";
    const CellSigns signs = cell_signs(mesh_, block);
    if (!signs.not_finite.empty()) {
      error(cells(signs.not_finite), volume + " is not finite: the coordinates are too large");
    }
    if (!signs.flat.empty()) {
      error(cells(signs.flat), "zero " + volume + " (flat, up to rounding): remove or reshape it");
    }
    for (std::size_t i = 0; i < std::min(signs.folded.size(), most_issues_of_a_kind); ++i) {
      const std::vector<Index> one = {signs.folded[i].cell};
      error(cells(one), fold_text(mesh_, block, signs.folded[i], numbering_) + more(signs.folded.size(), i));
    }
    if (!signs.inverted.empty()) {
      warning(cells(signs.inverted), "inverted (negative " + volume +
                                         "): re-oriented by exchanging nodes; the shape stays the same");
    }
  }

  /// Every edge of second-order cells has one node of its own in its middle.
  void check_middles(const CellBlock& block) {
    if (!is_second_order(block.kind)) return;
    struct Middle {
      std::array<Index, 2> edge;
      Index node, cell;
    };
    std::vector<Middle> middles;
    const auto corners = static_cast<std::size_t>(num_corners(block.kind));
    const auto local_edges = cell_edges(block.kind);
    for (Index cell = 0; cell < block.num_cells(); ++cell) {
      const auto nodes = block.cell(cell);
      for (std::size_t e = 0; e < local_edges.size(); ++e) {
        const Index a = nodes[static_cast<std::size_t>(local_edges[e][0])],
                    b = nodes[static_cast<std::size_t>(local_edges[e][1])];
        middles.push_back({{std::min(a, b), std::max(a, b)}, nodes[corners + e], cell});
        if (std::count(nodes.begin(), nodes.end(), nodes[corners + e]) == 1) continue;
        return error(cells(std::vector<Index>{cell}),
                     "node " + std::to_string(numbering_.vertex(nodes[corners + e])) +
                         " twice: the node in the middle of edge " + edge_text(a, b) +
                         " is missing; save the mesh again, as second order or as first order");
      }
    }
    std::ranges::stable_sort(middles, {}, &Middle::edge);
    for (std::size_t i = 1; i < middles.size(); ++i) {
      if (middles[i].edge != middles[i - 1].edge || middles[i].node == middles[i - 1].node) continue;
      return error(cells(std::vector<Index>{middles[i - 1].cell, middles[i].cell}),
                   "different nodes in the middle of edge " +
                       edge_text(middles[i].edge[0], middles[i].edge[1]) +
                       ": the cells would come apart; join the nodes (resilin mesh --merge)");
    }
  }

  void check_duplicate_cells(const CellBlock& block, bool is_error) {
    const auto pairs = duplicate_cells(block);
    for (std::size_t i = 0; i < std::min(pairs.size(), most_issues_of_a_kind); ++i) {
      const std::vector<Index> pair = {pairs[i].first, pairs[i].second};
      const std::string problem = "the same cell twice" + more(pairs.size(), i) +
                                  ": its mass and stiffness would count double; remove one";
      is_error ? error(cells(pair), problem) : warning(cells(pair), problem);
    }
  }

  void check_overlap(const CellBlock& block) {
    std::vector<std::vector<Index>> crowded;
    visit_facets(block, [&](std::span<const Facet> uses) {
      if (uses.size() < 3) return;
      std::vector<Index>& owners = crowded.emplace_back();
      for (const Facet& use : uses) owners.push_back(use.cell);
    });
    std::sort(crowded.begin(), crowded.end());
    for (std::size_t i = 0; i < std::min(crowded.size(), most_issues_of_a_kind); ++i) {
      error(cells(crowded[i]), "share one side" + more(crowded.size(), i) +
                                   ": only two cells fit there, so some of them overlap; remove the surplus");
    }
    check_sides(block);
  }

  void check_sides(const CellBlock& block) {
    const auto pairs = cells_on_one_side(mesh_, block);
    for (std::size_t i = 0; i < std::min(pairs.size(), most_issues_of_a_kind); ++i) {
      error(cells(pairs[i]),
            "lie on the same side of the side that they share" + more(pairs.size(), i) +
                ": they overlap, and their mass would count twice; remove one or move its vertices");
    }
  }

  void check_vertices(const CellBlock& block) {
    const auto is_used = used_vertices(block, num_vertices());
    std::vector<Index> unused;
    for (Index v = 0; v < num_vertices(); ++v) {
      if (!is_used[static_cast<std::size_t>(v)]) unused.push_back(v);
    }
    if (!unused.empty()) {
      warning(numbering_.vertex_list(unused), "used by no " + std::string(singular(first_order(block.kind))) +
                                                  ": without effect on the simulation");
    }
    const auto pairs = duplicate_vertices(mesh_);
    for (std::size_t i = 0; i < std::min(pairs.size(), most_issues_of_a_kind); ++i) {
      warning(numbering_.vertex_list(std::vector<Index>{pairs[i].first, pairs[i].second}),
              "at the same place" + more(pairs.size(), i) + ": they are not joined");
    }
  }

  void check_components(const CellBlock& block) {
    const Components components = connected_components(block, num_vertices());
    for (Index c = 1; c < components.count; ++c) {
      if (static_cast<std::size_t>(c) > most_issues_of_a_kind) {
        warning({}, std::to_string(components.count) + " separate components in all");
        break;
      }
      std::vector<Index> members;
      for (Index cell = 0; cell < block.num_cells(); ++cell) {
        if (components.of_cell[static_cast<std::size_t>(cell)] == c) members.push_back(cell);
      }
      warning("component " + std::to_string(c + 1), "not connected to the rest (" + cells(members) +
                                                        "): it needs its own boundary conditions in statics");
    }
    for (const ComponentOverlap& found :
         overlapping_components(mesh_, block, components, most_issues_of_a_kind)) {
      warning(cells(found.cells),
              "share space, though components " + std::to_string(found.components[0] + 1) + " and " +
                  std::to_string(found.components[1] + 1) + " are not connected: nothing keeps them apart");
    }
    check_pinches(block);
  }

  /// Vertices and edges through which alone cells hang together.
  void check_pinches(const CellBlock& block) {
    const Pinches pinches = find_pinches(block, num_vertices());
    if (!pinches.vertices.empty()) {
      const bool is_one = pinches.vertices.size() == 1;
      warning(numbering_.vertex_list(pinches.vertices),
              std::string(is_one ? "a bow tie: " : "bow ties: ") + std::string(name(block.kind)) +
                  " are connected only through " + (is_one ? "it" : "each of them") +
                  "; such a joint transmits no moment");
    }
    for (std::size_t i = 0; i < std::min(pinches.edges.size(), most_issues_of_a_kind); ++i) {
      warning("edge " + edge_text(pinches.edges[i][0], pinches.edges[i][1]),
              std::string(name(block.kind)) + " are connected only along it" + more(pinches.edges.size(), i) +
                  "; such a hinge may swing freely");
    }
  }

  void check_closed(const CellBlock& block) {
    const auto edges = open_edges(mesh_, block);
    if (edges.empty()) return;
    const std::string more_edges =
        edges.size() > 1 ? " (and " + std::to_string(edges.size() - 1) + " more such)" : "";
    warning("edge " + edge_text(edges[0][0], edges[0][1]),
            "of one triangle only" + more_edges + ": the surface is open there and encloses no volume");
  }

  void check_surface_edges(const CellBlock& block) {
    const auto edges = nonmanifold_edges(block);
    for (std::size_t i = 0; i < std::min(edges.size(), most_issues_of_a_kind); ++i) {
      warning("edge " + edge_text(edges[i][0], edges[i][1]), "shared by more than two triangles" +
                                                                 more(edges.size(), i) +
                                                                 ": the surface is not manifold there");
    }
  }

  void check_areas(const CellBlock& block) {
    const std::vector<double> areas = triangle_areas(mesh_, block);
    std::vector<Index> flat;
    for (Index cell = 0; cell < block.num_cells(); ++cell) {
      const double area = areas[static_cast<std::size_t>(cell)];
      if (!(area > volume_round_off(mesh_, block, cell)) || !std::isfinite(area)) flat.push_back(cell);
    }
    if (!flat.empty()) warning(cells(flat), "zero area (a line or a point)");
  }

 private:
  Index num_vertices() const { return static_cast<Index>(mesh_.vertices.size()); }
  std::string cells(std::span<const Index> list) const { return numbering_.cell_list(block_number_, list); }
  std::string place(const std::string& what) const {
    return what.empty() ? numbering_.file : numbering_.file + ": " + what;
  }
  std::string edge_text(Index a, Index b) const {
    return std::to_string(numbering_.vertex(a)) + "-" + std::to_string(numbering_.vertex(b));
  }
  void error(const std::string& what, const std::string& problem) {
    report.errors.push_back({place(what), problem});
  }
  void warning(const std::string& what, const std::string& problem) {
    report.warnings.push_back({place(what), problem});
  }
  /// Said with the last issue shown, when there are more of the kind.
  static std::string more(std::size_t count, std::size_t i) {
    return i + 1 == most_issues_of_a_kind && count > i + 1
               ? " (and " + std::to_string(count - i - 1) + " more such)"
               : "";
  }

  void check_kinds(CellKind wanted) {
    const CellBlock* block = mesh_.find_block(wanted);
    std::vector<std::string> found;
    for (const CellBlock& b : mesh_.blocks) {
      if (b.num_cells() > 0 && b.kind != wanted) found.emplace_back(name(b.kind));
    }
    if (block == nullptr || block->num_cells() == 0) {
      error({}, found.empty() ? "no elements"
                              : "no " + std::string(name(wanted)) + " (found " + join(found) + ")");
    }
    for (const CellBlock& b : mesh_.blocks) {
      if (b.num_cells() > 0 && b.kind != wanted && dimension(b.kind) == dimension(wanted) &&
          block != nullptr) {
        error({}, std::to_string(b.num_cells()) + " " + std::string(name(b.kind)) + " beside " +
                      std::string(name(wanted)) +
                      ": a body has cells of one kind; split the others or make them a body of their own");
      }
    }
  }

  void check_coordinates() {
    std::vector<Index> bad;
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) {
      if (!mesh_.vertices[v].allFinite()) bad.push_back(static_cast<Index>(v));
    }
    if (!bad.empty()) error(numbering_.vertex_list(bad), "a coordinate is not a finite number");
  }

  void check_indices(std::size_t b) {
    const CellBlock& block = mesh_.blocks[b];
    for (Index cell = 0; cell < block.num_cells(); ++cell) {
      for (const Index node : block.cell(cell)) {
        if (node >= 0 && node < num_vertices()) continue;
        error(numbering_.cell_list(b, std::vector<Index>{cell}),
              "node " + std::to_string(numbering_.first_vertex + node) + " does not exist (the mesh has " +
                  std::to_string(num_vertices()) + ")");
        return;
      }
    }
  }

  const Mesh& mesh_;
  const Numbering& numbering_;
  std::size_t block_number_ = 0;
};

}  // namespace

void MeshReport::require_no_errors() const {
  if (!errors.empty()) throw InputError(errors[0].place, errors[0].problem);
}

std::string fold_text(const Mesh& mesh, const CellBlock& block, const FoldedCell& folded,
                      const Numbering& numbering) {
  const auto nodes = block.cell(folded.cell);
  const auto X = [&](std::size_t i) -> const Vector3& {
    return mesh.vertices[static_cast<std::size_t>(nodes[i])];
  };
  std::string text = "inverted: its Jacobian is " + format_short(folded.jacobian) + " at " +
                     format_point(folded.xi, dimension(block.kind)) + " of its reference cell";
  if (!is_second_order(block.kind)) {
    return text + (dimension(block.kind) == 3
                       ? ", so it is distorted too much or its vertices are not in the order of MSH: four "
                         "anticlockwise below, seen from above, then the four above them"
                       : ", so it is not convex or its vertices are not in order around it");
  }
  const auto corners = static_cast<std::size_t>(num_corners(block.kind));
  const auto local_edges = cell_edges(block.kind);
  std::size_t worst = 0;
  double farthest = -1;
  for (std::size_t e = 0; e < local_edges.size(); ++e) {
    const Vector3 &a = X(static_cast<std::size_t>(local_edges[e][0])),
                  &b = X(static_cast<std::size_t>(local_edges[e][1]));
    const double distance = (X(corners + e) - 0.5 * (a + b)).norm() / (b - a).norm();
    if (!(distance > farthest)) continue;
    farthest = distance;
    worst = e;
  }
  const auto end = [&](std::size_t i) {
    return std::to_string(numbering.vertex(nodes[static_cast<std::size_t>(local_edges[worst][i])]));
  };
  return text + ", node " + std::to_string(numbering.vertex(nodes[corners + worst])) + " stands " +
         format_short(farthest) + " edge lengths from the middle of its edge " + end(0) + "-" + end(1) +
         ": move it there, or use the corners alone (element = \"P1\")";
}

MeshReport check_mesh(const Mesh& mesh, int dimension, const Numbering& numbering) {
  Examiner examiner(mesh, numbering);
  const CellBlock* solid = mesh.find_solid(dimension);
  const CellKind simplex = dimension == 3 ? CellKind::tetrahedron : CellKind::triangle;
  const CellBlock* block = examiner.usable_block(solid != nullptr ? solid->kind : simplex);
  if (block == nullptr) return std::move(examiner.report);
  if (dimension == 2) examiner.check_plane();
  examiner.check_middles(*block);
  if (examiner.report.errors.empty()) examiner.check_volumes(*block);
  examiner.check_duplicate_cells(*block, true);
  if (examiner.report.errors.empty()) examiner.check_overlap(*block);
  examiner.check_vertices(*block);
  examiner.check_components(*block);
  return std::move(examiner.report);
}

MeshReport check_surface(const Mesh& mesh, const Numbering& numbering) {
  Examiner examiner(mesh, numbering);
  const CellBlock* block = examiner.usable_block(CellKind::triangle);
  if (block == nullptr) return std::move(examiner.report);
  examiner.check_areas(*block);
  examiner.check_duplicate_cells(*block, false);
  examiner.check_surface_edges(*block);
  examiner.check_closed(*block);
  examiner.check_pinches(*block);
  examiner.check_vertices(*block);
  return std::move(examiner.report);
}

}  // namespace resilin
