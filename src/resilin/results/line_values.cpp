#include "resilin/results/line_values.hpp"

#include <array>
#include <limits>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fields/evaluator.hpp"
#include "resilin/fields/scalar_field.hpp"
#include "resilin/mesh/closest_point.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/results/saved_run.hpp"
#include "resilin/world/axisymmetry.hpp"
#include "resilin/world/meeting_surface.hpp"

namespace resilin {
namespace {

/// A point of the line as a weighted mean of nodes.
using PointOfLine = std::vector<WeightedNode>;

/// The nearest point of the surface in the reference configuration.
class NearestPoints {
 public:
  /// @param body  its number; -1: any
  NearestPoints(const World& world, Index body)
      : surface_(make_contact_surface(world.dimension, contact_bodies(world, {}), world.rest_positions, {},
                                      depth_of(world))),
        places_(surface_.places(world.rest_positions)),
        body_(body) {}

  PointOfLine at(const Vector3& p) const {
    double least = std::numeric_limits<double>::infinity();
    std::array<Index, 3> vertices{};
    std::array<double, 3> shares{};
    const CollisionSurface& parts = surface_.parts;
    const auto take = [&](const std::array<Index, 3>& candidate, const std::array<double, 3>& weights) {
      Vector3 point = Vector3::Zero();
      for (std::size_t i = 0; i < 3; ++i) point += weights[i] * place(candidate[i]);
      const double distance = (point - p).squaredNorm();
      if (!(distance < least)) return;
      least = distance;
      vertices = candidate;
      shares = weights;
    };
    if (parts.dim == 2) {
      for (std::size_t i = 0; i < parts.edges.size(); i += 2) {
        const Index a = parts.edges[i], b = parts.edges[i + 1];
        if (!is_wanted(a)) continue;
        const auto [u, v] = closest_on_segment(p, place(a), place(b));
        take({a, b, b}, {u, v, 0});
      }
    } else {
      for (std::size_t i = 0; i < parts.triangles.size(); i += 3) {
        const std::array<Index, 3> t{parts.triangles[i], parts.triangles[i + 1], parts.triangles[i + 2]};
        if (is_wanted(t[0])) take(t, closest_on_triangle(p, place(t[0]), place(t[1]), place(t[2])));
      }
    }
    PointOfLine nodes;
    for (std::size_t i = 0; i < 3 && std::isfinite(least); ++i)
      if (shares[i] != 0)
        surface_.vertices.for_each_node(
            vertices[i], [&](Index node, double share) { nodes.push_back({node, share * shares[i]}); });
    return nodes;
  }

 private:
  Vector3 place(Index vertex) const { return node_position(surface_.parts.dim, vertex, places_); }
  bool is_wanted(Index vertex) const {
    return body_ < 0 || surface_.parts.bodies[static_cast<std::size_t>(vertex)] == body_;
  }

  ContactSurface surface_;
  VectorX places_;
  Index body_;
};

std::vector<std::filesystem::path> asked_frames(const std::filesystem::path& folder,
                                                std::optional<int> frame) {
  std::vector<std::filesystem::path> files = frame_files(folder);
  if (files.empty())
    throw InputError(folder.string(), "frames of a run (frames/0000.vtu ...)", "none",
                     "`output.formats` must have \"vtu\"");
  if (!frame) return files;
  const int count = static_cast<int>(files.size());
  const int number = *frame < 0 ? count + *frame : *frame;
  if (number < 0 || number >= count)
    throw InputError("--frame", "0 to " + std::to_string(count - 1) + ", or -1 for the last",
                     std::to_string(*frame));
  return {files[static_cast<std::size_t>(number)]};
}

}  // namespace

LineValues values_along(const std::filesystem::path& folder, const SurfaceLine& line,
                        const std::string& field, std::optional<int> frame) {
  const std::vector<std::filesystem::path> files = asked_frames(folder, frame);
  const std::shared_ptr<const World> world = saved_world(folder);
  if (!world)
    throw InputError(folder.string(), "scene.bin, the scene of the run", "none",
                     "`output.formats` must have \"vtu\"");
  if (line.dimension != world->dimension)
    throw InputError("--along",
                     "two points of a scene in " + std::to_string(world->dimension) +
                         "D: " + std::to_string(2 * world->dimension) + " numbers",
                     std::to_string(2 * line.dimension));
  const ScalarField scalar = require_vertex_field(field, world->dimension, "--y");
  const double length = (line.to - line.from).norm();
  if (!(length > 0)) throw InputError("--along", "two different points", "one point twice");
  const NearestPoints nearest(
      *world, line.body.empty() ? -1 : static_cast<Index>(find_body(*world, line.body, "--body")));
  LineValues values;
  std::vector<PointOfLine> points;
  for (int i = 0; i < line.num_points; ++i) {
    const double share = static_cast<double>(i) / (line.num_points - 1);
    values.distances.push_back(share * length);
    points.push_back(nearest.at(line.from + share * (line.to - line.from) - world->origin));
  }
  FieldEvaluator evaluator(*world);
  const std::vector<std::string> names = {scalar.field->name};
  for (const std::filesystem::path& file : files) {
    const State state = state_of_frame(*world, read_vtu(file), file);
    const std::vector<FieldValues> fields = evaluator.evaluate(state, names);
    std::vector<double>& of_frame = values.frames.emplace_back();
    for (const PointOfLine& point : points) {
      double value = 0;
      for (const auto& [node, weight] : point)
        value += weight * scalar.at(fields[0].values, static_cast<std::size_t>(node));
      of_frame.push_back(value);
    }
  }
  return values;
}

}  // namespace resilin
