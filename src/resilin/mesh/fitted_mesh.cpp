#include "resilin/mesh/fitted_mesh.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/curved_cells.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/fitted_draft.hpp"
#include "resilin/mesh/improve_tetrahedra.hpp"
#include "resilin/mesh/second_order.hpp"
#include "resilin/mesh/topology.hpp"

namespace resilin {
namespace {

using Kind = FittedVertex::Kind;
using Nodes = FittedDraft::Nodes;

constexpr double near_at_first = 0.2,
                 near_enough = 0.1;  // tolerances relative to the wanted number: no further attempt
constexpr int most_attempts = 4;
constexpr int fewest_cells = 60;  // fewer follow no surface
constexpr int relaxations = 3;
constexpr double inside_distance = 0.5;  // distance of points inside from the surface, by the spacing
constexpr double wanted_sine = 0.3;      // 17 degrees
constexpr int improvement_passes = 10;
constexpr int most_in_crumb = 4;  // cells of a part that is dropped
constexpr double least_sine_allowed = 1e-3;
// While cells are improved, by the spacing: movement along the surface, distance of sides from it.
constexpr double most_slide = 0.8, most_gap = 0.08;
constexpr int fitting_rounds = 2;
constexpr double most_fit = 0.1;  // largest movement of a vertex to fit the sides, relative to the spacing
// Middles of edges of quadratic cells, by the length of the edge: least and largest movement onto the
// surface.
constexpr double least_bend = 1e-5, most_bend = 0.25;
constexpr double smooth_cosine = 0.5;  // between sides of cells at an edge that is no sharp one
constexpr double good_sine = 0.2;      // a better one is not given up for it: 11.5 degrees

class FittedMaker {
 public:
  FittedMaker(const Mesh& surface, const std::string& name, const FittedMeshOptions& options)
      : name_(name),
        min_size_(options.min_size),
        is_quadratic_(options.is_quadratic),
        surface_(make_solid_surface(without_copies(surface), name)),
        places_(surface_) {}

  FittedMesh make_by_size(double size) {
    require_volume(surface_, name_);
    const double count = count_at(size);
    if (count > FittedMeshOptions::most_cells || count < 1)
      throw InputError(name_,
                       "a size of cells that makes 1 to " + std::to_string(FittedMeshOptions::most_cells),
                       format_short(size) + ", which makes about " + format_short(count),
                       "sizes are lengths of the file, before scale");
    places_.expect_points(inside_distance * size);
    FittedDraft draft(places_, size, min_size_);
    relax(draft);
    if (draft.cells().size() > static_cast<std::size_t>(FittedMeshOptions::most_cells))
      throw InputError(
          name_, "a min_size that makes at most " + std::to_string(FittedMeshOptions::most_cells) + " cells",
          format_short(min_size_) + ", which makes " + std::to_string(draft.cells().size()));
    return finish(draft);
  }

  FittedMesh make(int wanted) {
    require_volume(surface_, name_);
    double spacing = first_spacing(wanted);
    places_.expect_points(inside_distance * spacing);
    // Drafts whose points do not move yet bring the spacing near; of those that do, some more cells come.
    double too_small = 0, too_large = std::numeric_limits<double>::infinity(), power = 0.4;
    const auto next = [&](double count) {
      (count > wanted ? too_small : too_large) = spacing;
      spacing *= std::pow(count / wanted, power);  // between that of a sheet, 1/2, and of a solid, 1/3
      if (spacing <= too_small || spacing >= too_large) spacing = std::sqrt(too_small * too_large);
    };
    const auto miss = [&](double count) { return std::abs(std::log(count / wanted)); };
    FittedDraft best(places_, spacing, min_size_);
    for (int attempt = 0; attempt < most_attempts && miss(count_of(best)) >= near_at_first; ++attempt) {
      next(count_of(best));
      best = FittedDraft(places_, spacing, min_size_);
    }
    too_small = 0;
    too_large = std::numeric_limits<double>::infinity();
    relax(best);
    for (int attempt = 1; attempt < most_attempts && miss(count_of(best)) > near_enough; ++attempt) {
      next(count_of(best));
      FittedDraft draft(places_, spacing, min_size_);
      relax(draft);
      const bool is_beyond = (count_of(draft) > wanted) != (count_of(best) > wanted);
      const bool is_better = miss(count_of(draft)) < miss(count_of(best));
      if (is_better) best = std::move(draft);
      // Thin walls take another layer of cells at once: no spacing between gives a number between.
      if (is_beyond && !is_better) break;
    }
    return finish(best);
  }

 private:
  static Mesh without_copies(const Mesh& given) {
    Mesh mesh = given;
    to_first_order(mesh);
    if (mesh.find_block(CellKind::triangle) == nullptr) return mesh;
    merge_duplicate_vertices(mesh);
    std::vector<Index>& nodes = mesh.block(CellKind::triangle).nodes;
    std::set<std::array<Index, 3>> seen;
    std::vector<Index> kept;
    for (std::size_t i = 0; i + 2 < nodes.size(); i += 3) {
      std::array<Index, 3> key = {nodes[i], nodes[i + 1], nodes[i + 2]};
      std::ranges::sort(key);
      if (seen.insert(key).second) kept.insert(kept.end(), {nodes[i], nodes[i + 1], nodes[i + 2]});
    }
    nodes = std::move(kept);
    return mesh;
  }

  static double count_of(const FittedDraft& draft) {
    return std::max(static_cast<double>(draft.cells().size()), 0.1);  // its logarithm is taken
  }

  static void relax(FittedDraft& draft) {
    for (int i = 0; i < relaxations; ++i) draft.relax();
  }

  /// About how many cells there will be.
  double count_at(double spacing) const {
    return 12 * places_.volume() / (spacing * spacing * spacing) + surface_.area / (spacing * spacing);
  }

  double first_spacing(int wanted) const {
    const double extent = std::sqrt(surface_.area);
    double low = 0, high = 4 * extent;
    for (int i = 0; i < 60; ++i) {
      const double spacing = 0.5 * (low + high);
      (count_at(spacing) > wanted ? low : high) = spacing;
    }
    return 0.5 * (low + high);
  }

  VertexGuide guide_for(const FittedDraft& draft, const TetrahedronSet& set,
                        const std::vector<Index>& draft_vertex,
                        const std::vector<std::array<Index, 2>>& line_edges) const {
    const auto vertex = [&](Index v) -> const FittedVertex& {
      return draft.vertices()[static_cast<std::size_t>(draft_vertex[static_cast<std::size_t>(v)])];
    };
    const double edge = draft.spacing();
    VertexGuide guide;
    guide.project = [&, vertex, edge](Index v, Vector3& X) {
      const FittedVertex& from = vertex(v);
      switch (from.kind) {
        case Kind::inside:
          return true;
        case Kind::corner:
          return false;
        case Kind::line: {
          const CreaseLine& line = draft.features().lines[static_cast<std::size_t>(from.line)];
          X = line.at(line.nearest(X));
          return true;
        }
        case Kind::surface:
          break;
      }
      const SurfacePlace place = places_.nearest(X, from.triangle);
      if (place.normal.dot(from.normal) < 0.5 || (place.X - from.X).norm() > most_slide * edge) return false;
      X = place.X;
      return true;
    };
    guide.may_be_side = [&, edge](Index a, Index b, Index c) {
      const auto X = [&](Index v) -> const Vector3& { return set.positions[static_cast<std::size_t>(v)]; };
      const double allowed = most_gap * edge;
      return places_.is_near(0.5 * (X(a) + X(b)), allowed) &&
             places_.is_near((X(a) + X(b) + X(c)) / 3, allowed);
    };
    guide.is_kept = [&](Index a, Index b) {
      const Index i = draft_vertex[static_cast<std::size_t>(a)],
                  j = draft_vertex[static_cast<std::size_t>(b)];
      return std::ranges::binary_search(line_edges, std::array<Index, 2>{std::min(i, j), std::max(i, j)});
    };
    return guide;
  }

  FittedMesh finish(const FittedDraft& draft) const {
    TetrahedronSet set;
    std::vector<Index> number(draft.vertices().size(), -1), draft_vertex;
    for (const Nodes& cell : draft.cells()) {
      Nodes nodes{};
      for (std::size_t i = 0; i < 4; ++i) {
        Index& v = number[static_cast<std::size_t>(cell[i])];
        if (v < 0) {
          v = static_cast<Index>(draft_vertex.size());
          draft_vertex.push_back(cell[i]);
          set.positions.push_back(draft.vertices()[static_cast<std::size_t>(cell[i])].X);
        }
        nodes[i] = v;
      }
      set.cells.push_back(nodes);
    }
    const auto line_edges = draft.line_edges();
    const VertexGuide guide = guide_for(draft, set, draft_vertex, line_edges);
    improve_tetrahedra(set, guide, wanted_sine, improvement_passes);
    if (!is_quadratic_) fit_sides(set, draft, draft_vertex);
    part_pinches(set);
    drop_crumbs(set, draft.spacing());
    double flattest = 1;
    for (const Nodes& cell : set.cells) flattest = std::min(flattest, quality_of(set, cell));
    if (set.cells.empty() || !(flattest > least_sine_allowed))
      throw InputError(name_, "a surface that tetrahedra can follow",
                       set.cells.empty() ? "one around no cell" : "one that leaves flat cells",
                       "try another number of cells or mesher = \"lattice\"");

    FittedMesh fitted;
    fitted.cell_size = draft.spacing();
    fitted.volume = places_.volume();
    fitted.mesh.vertices = set.positions;
    std::vector<Index>& nodes = fitted.mesh.block(CellKind::tetrahedron).nodes;
    double volume = 0;
    for (const Nodes& cell : set.cells) {
      nodes.insert(nodes.end(), cell.begin(), cell.end());
      const auto X = [&](std::size_t i) -> const Vector3& {
        return set.positions[static_cast<std::size_t>(cell[i])];
      };
      volume += (X(1) - X(0)).dot((X(2) - X(0)).cross(X(3) - X(0))) / 6;
    }
    const std::vector<Index> new_number = remove_unused_nodes(fitted.mesh);
    if (is_quadratic_) {
      std::vector<Index> from(fitted.mesh.vertices.size());
      for (std::size_t v = 0; v < new_number.size(); ++v)
        if (new_number[v] >= 0) from[static_cast<std::size_t>(new_number[v])] = draft_vertex[v];
      curve(fitted.mesh, draft, from);
      volume = exact_volume(fitted.mesh, fitted.mesh.blocks[0]);
    }
    if (fitted.volume > 0) fitted.volume_ratio = volume / fitted.volume;
    fitted.remarks = remarks_on(surface_, name_);
    const Index num_parts =
        connected_components(fitted.mesh.blocks[0], static_cast<Index>(fitted.mesh.vertices.size())).count;
    if (num_parts > num_shells())
      fitted.remarks.push_back(name_ + ": its cells form " + std::to_string(num_parts) +
                               " disconnected parts, the surface has " + std::to_string(num_shells()) +
                               "; more cells resolve its thinnest walls");
    return fitted;
  }

  /// Gives the cells nodes in the middles of their edges; those on the boundary go onto the surface or its
  /// sharp edges, those of edges through walls between.
  /// @param draft_vertex  of each vertex of the mesh
  void curve(Mesh& mesh, const FittedDraft& draft, const std::vector<Index>& draft_vertex) const {
    using Edge = std::array<Index, 2>;
    const auto edge_of = [](Index a, Index b) { return Edge{std::min(a, b), std::max(a, b)}; };
    std::map<Edge, Index> line_of;  // by vertices of the draft
    for (std::size_t l = 0; l < draft.sequences().size(); ++l) {
      const std::vector<Index>& sequence = draft.sequences()[l];
      for (std::size_t i = 0; i + 1 < sequence.size(); ++i)
        line_of[edge_of(sequence[i], sequence[i + 1])] = static_cast<Index>(l);
    }
    std::map<Edge, std::array<Vector3, 2>> normals_at;  // normals of the two sides at an edge
    std::vector<Vector3> normals_of(mesh.vertices.size(), Vector3::Zero());  // normals of vertices, by area
    const CellBlock rim = boundary(mesh.blocks[0]).facets;
    for (Index f = 0; f < rim.num_cells(); ++f) {
      const auto nodes = rim.cell(f);
      const auto X = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(nodes[i])]; };
      const Vector3 area = (X(1) - X(0)).cross(X(2) - X(0)), normal = area.normalized();
      for (std::size_t i = 0; i < 3; ++i) {
        normals_of[static_cast<std::size_t>(nodes[i])] += area;
        const auto [at, is_first] =
            normals_at.try_emplace(edge_of(nodes[i], nodes[(i + 1) % 3]), std::array{normal, normal});
        if (!is_first) at->second[1] = normal;
      }
    }
    const auto from = [&](Index v) { return draft_vertex[static_cast<std::size_t>(v)]; };
    const auto place_of = [&](const Edge& edge, const Vector3& middle,
                              const std::array<Vector3, 2>& normals) -> Vector3 {
      if (const auto line = line_of.find(edge_of(from(edge[0]), from(edge[1]))); line != line_of.end()) {
        const CreaseLine& crease = draft.features().lines[static_cast<std::size_t>(line->second)];
        return crease.at(crease.nearest(middle));
      }
      if (normals[0].dot(normals[1]) < smooth_cosine) return middle;
      const Index hint = draft.vertices()[static_cast<std::size_t>(from(edge[0]))].triangle;
      const SurfacePlace place = places_.nearest(middle, hint);
      const bool is_same_side = place.normal.dot((normals[0] + normals[1]).normalized()) > smooth_cosine;
      return is_same_side && (!places_.has_overlaps() || places_.is_rim(place)) ? place.X : middle;
    };
    // Edges through a wall bend with it: the sagitta of an arc whose normals turn from one end to the other.
    const auto place_inside = [&](const Edge& edge, const Vector3& middle) -> Vector3 {
      for (const Index v : edge)
        if (draft.vertices()[static_cast<std::size_t>(from(v))].kind != Kind::surface) return middle;
      const auto a = static_cast<std::size_t>(edge[0]), b = static_cast<std::size_t>(edge[1]);
      Vector3 normal = normals_of[a].normalized();
      const Vector3 other = normals_of[b].normalized();
      if (normal.dot(other) > -smooth_cosine) return middle;  // both on one side, or around a corner
      normal = -normal;
      const double sagitta = (mesh.vertices[b] - mesh.vertices[a]).dot(other - normal) / 8;
      return middle + sagitta * (normal + other).normalized();
    };
    SecondOrderMesh finer = second_order(mesh);
    std::vector<BentEdge> bent;
    for (std::size_t i = 0; i < finer.ends.size(); ++i) {
      const Edge& edge = finer.ends[i];
      const auto middle = static_cast<Index>(mesh.vertices.size() + i);
      const Vector3& X = finer.mesh.vertices[static_cast<std::size_t>(middle)];
      const auto normals = normals_at.find(edge);
      const Vector3 wanted =
          normals == normals_at.end() ? place_inside(edge, X) : place_of(edge, X, normals->second);
      const double length = (mesh.vertices[static_cast<std::size_t>(edge[0])] -
                             mesh.vertices[static_cast<std::size_t>(edge[1])])
                                .norm();
      const double bend = (wanted - X).norm();
      if (bend > least_bend * length && bend < most_bend * length) bent.push_back({middle, wanted});
    }
    bend_edges(finer.mesh, bent);
    mesh = std::move(finer.mesh);
  }

  /// Moves vertices of curved surfaces so that the sides of the cells, rather than their corners, lie on it
  /// on average: chords of a ball would enclose less than the ball.
  void fit_sides(TetrahedronSet& set, const FittedDraft& draft,
                 const std::vector<Index>& draft_vertex) const {
    const Boundary rim = boundary(block_of(set));
    std::vector<std::vector<std::size_t>> star(set.positions.size());
    for (std::size_t c = 0; c < set.cells.size(); ++c)
      for (const Index v : set.cells[c]) star[static_cast<std::size_t>(v)].push_back(c);
    const auto quality = [&](std::size_t c) { return quality_of(set, set.cells[c]); };
    const auto hint = [&](Index v) {
      return draft.vertices()[static_cast<std::size_t>(draft_vertex[static_cast<std::size_t>(v)])].triangle;
    };
    for (int round = 0; round < fitting_rounds; ++round) {
      std::vector<Vector3> gaps(set.positions.size(), Vector3::Zero());
      std::vector<double> weights(set.positions.size(), 0);
      for (Index f = 0; f < rim.facets.num_cells(); ++f) {
        const auto nodes = rim.facets.cell(f);
        const auto X = [&](std::size_t i) -> const Vector3& {
          return set.positions[static_cast<std::size_t>(nodes[i])];
        };
        const Vector3 normal = (X(1) - X(0)).cross(X(2) - X(0));  // twice the area
        // Mean of the gap over the side, by the rule of its edges' middles.
        double gap = 0;
        for (std::size_t i = 0; i < 3; ++i) {
          const Vector3 middle = 0.5 * (X(i) + X((i + 1) % 3));
          const SurfacePlace place = places_.nearest(middle, hint(nodes[i]));
          if (place.normal.dot(normal) > 0.5 * normal.norm()) gap += (place.X - middle).dot(place.normal) / 3;
        }
        for (const Index v : nodes) {
          gaps[static_cast<std::size_t>(v)] += gap * normal;
          weights[static_cast<std::size_t>(v)] += normal.norm();
        }
      }
      for (std::size_t v = 0; v < set.positions.size(); ++v) {
        const FittedVertex& vertex = draft.vertices()[static_cast<std::size_t>(draft_vertex[v])];
        if (vertex.kind != Kind::surface || !(weights[v] > 0)) continue;
        const Vector3 old = set.positions[v];
        double before = 1, after = 1;
        for (const std::size_t c : star[v]) before = std::min(before, quality(c));
        Vector3 step = gaps[v] / weights[v];
        const double most = most_fit * draft.spacing();
        if (step.norm() > most) step *= most / step.norm();
        set.positions[v] += step;
        for (const std::size_t c : star[v]) after = std::min(after, quality(c));
        if (after < std::min(before, good_sine)) set.positions[v] = old;
      }
    }
  }

  static double quality_of(const TetrahedronSet& set, const Nodes& cell) {
    const auto X = [&](std::size_t i) -> const Vector3& {
      return set.positions[static_cast<std::size_t>(cell[i])];
    };
    return least_sine({X(0), X(1), X(2), X(3)});
  }

  static CellBlock block_of(const TetrahedronSet& set) {
    CellBlock block{CellKind::tetrahedron, {}};
    for (const Nodes& cell : set.cells) block.nodes.insert(block.nodes.end(), cell.begin(), cell.end());
    return block;
  }

  /// Drops disconnected parts of a few cells that fill no shell of their own: bits of walls that are too thin
  /// for the cells, which nothing holds.
  void drop_crumbs(TetrahedronSet& set, double spacing) const {
    const Components parts = connected_components(block_of(set), static_cast<Index>(set.positions.size()));
    if (parts.count < 2) return;
    const Components shells =
        connected_components(surface_.triangles(), static_cast<Index>(surface_.mesh.vertices.size()));
    std::vector<Box> shell_boxes(static_cast<std::size_t>(shells.count)),
        part_boxes(static_cast<std::size_t>(parts.count));
    std::vector<int> sizes(part_boxes.size(), 0);
    for (std::size_t v = 0; v < shells.of_vertex.size(); ++v)
      if (shells.of_vertex[v] >= 0)
        shell_boxes[static_cast<std::size_t>(shells.of_vertex[v])].add(surface_.mesh.vertices[v]);
    for (std::size_t v = 0; v < parts.of_vertex.size(); ++v)
      if (parts.of_vertex[v] >= 0)
        part_boxes[static_cast<std::size_t>(parts.of_vertex[v])].add(set.positions[v]);
    for (const Index part : parts.of_cell) ++sizes[static_cast<std::size_t>(part)];
    const auto is_crumb = [&](std::size_t part) {
      if (sizes[part] > most_in_crumb) return false;
      const Vector3 room = Vector3::Constant(0.5 * spacing);
      const Box around{part_boxes[part].min - room, part_boxes[part].max + room};
      return std::ranges::none_of(shell_boxes, [&](const Box& shell) {
        return around.contains(shell.min) && around.contains(shell.max);
      });
    };
    std::vector<Nodes> kept;
    for (std::size_t c = 0; c < set.cells.size(); ++c)
      if (!is_crumb(static_cast<std::size_t>(parts.of_cell[c]))) kept.push_back(set.cells[c]);
    if (!kept.empty()) set.cells = std::move(kept);
  }

  Index num_shells() const {
    return connected_components(surface_.triangles(), static_cast<Index>(surface_.mesh.vertices.size()))
        .count;
  }

  /// Where cells hang together by a vertex or an edge alone, drops all but the largest fan of them.
  static void part_pinches(TetrahedronSet& set) {
    const auto volume = [&](const Nodes& cell) {
      const auto X = [&](std::size_t i) -> const Vector3& {
        return set.positions[static_cast<std::size_t>(cell[i])];
      };
      return (X(1) - X(0)).dot((X(2) - X(0)).cross(X(3) - X(0))) / 6;
    };
    while (true) {
      const Pinches pinches = find_pinches(block_of(set), static_cast<Index>(set.positions.size()));
      std::vector<std::vector<Index>> places;
      for (const Index v : pinches.vertices) places.push_back({v});
      for (const auto& [a, b] : pinches.edges) places.push_back({a, b});
      if (places.empty()) return;
      std::set<std::size_t> dropped;
      for (const auto& place : places) {
        std::vector<std::size_t> around;
        for (std::size_t c = 0; c < set.cells.size(); ++c)
          if (std::ranges::all_of(place, [&](Index v) { return std::ranges::count(set.cells[c], v) > 0; }))
            around.push_back(c);
        // Fans: cells around the place that share sides.
        std::vector<std::size_t> fan(around.size());
        for (std::size_t i = 0; i < fan.size(); ++i) fan[i] = i;
        for (bool has_changed = true; has_changed;) {
          has_changed = false;
          for (std::size_t i = 0; i < fan.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) {
              if (fan[i] == fan[j]) continue;
              int shared = 0;
              for (const Index v : set.cells[around[i]])
                shared += static_cast<int>(std::ranges::count(set.cells[around[j]], v));
              if (shared < 3) continue;
              fan[i] = fan[j] = std::min(fan[i], fan[j]);
              has_changed = true;
            }
        }
        std::map<std::size_t, double> volumes;
        for (std::size_t i = 0; i < fan.size(); ++i) volumes[fan[i]] += volume(set.cells[around[i]]);
        const auto largest = std::ranges::max_element(
            volumes, [](const auto& a, const auto& b) { return a.second < b.second; });
        for (std::size_t i = 0; i < fan.size(); ++i)
          if (fan[i] != largest->first) dropped.insert(around[i]);
      }
      if (dropped.empty()) return;
      std::vector<Nodes> kept;
      for (std::size_t c = 0; c < set.cells.size(); ++c)
        if (!dropped.contains(c)) kept.push_back(set.cells[c]);
      set.cells = std::move(kept);
    }
  }

  const std::string& name_;
  double min_size_;
  bool is_quadratic_;
  SolidSurface surface_;
  SurfacePlaces places_;
};

}  // namespace

FittedMesh make_fitted_mesh(const Mesh& surface, const std::string& name, const FittedMeshOptions& options) {
  if (options.cells < 1 || options.cells > FittedMeshOptions::most_cells)
    throw InputError(name, "a number of cells from 1 to " + std::to_string(FittedMeshOptions::most_cells),
                     std::to_string(options.cells));
  FittedMaker maker(surface, name, options);
  return options.size > 0 ? maker.make_by_size(options.size)
                          : maker.make(std::max(options.cells, fewest_cells));
}

}  // namespace resilin
