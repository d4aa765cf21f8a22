#include "resilin/view/shown_connectors.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "resilin/core/dense.hpp"
#include "resilin/world/rigid_shape.hpp"

namespace resilin {
namespace {

constexpr double half_axis = 0.2;  ///< drawn half of an axis, in lengths of its joint
constexpr double flatness = 1e-6;  ///< relative to the extent

/// Vertices of the surface of a rigid body that span it: as far from each other as there are any.
class Frames {
 public:
  Frames(const World& world, const ShownSurface& surface) : world_(world), surface_(surface) {
    frames_.resize(world.bodies.size());
  }

  /// The point of a rigid body that is at X in its reference configuration; none for a flat surface.
  std::optional<ShownConnector::Point> carry(std::size_t body, const Vector3& X) {
    const std::vector<Index>& frame = frame_of(body);
    const auto n = static_cast<Eigen::Index>(frame.size());
    if (n != world_.dimension + 1) return std::nullopt;
    dense::Matrix P(n, n);
    VectorX right(n);
    for (Eigen::Index a = 0; a < n; ++a) {
      P(0, a) = 1;
      P.col(a).tail(n - 1) =
          (place_of(frame[static_cast<std::size_t>(a)]) - place_of(frame.front())).head(n - 1);
    }
    right[0] = 1;
    right.tail(n - 1) = (X - place_of(frame.front())).head(n - 1);
    const VectorX weights = dense::solve(P, right);
    return ShownConnector::Point{.vertices = frame, .weights = {weights.begin(), weights.end()}};
  }

 private:
  Vector3 place_of(Index vertex) const {
    const float* at = &surface_.rest_positions()[3 * static_cast<std::size_t>(vertex)];
    return {at[0], at[1], at[2]};
  }

  const std::vector<Index>& frame_of(std::size_t body) {
    std::vector<Index>& frame = frames_[body];
    if (!frame.empty()) return frame;
    const auto part = std::ranges::find_if(surface_.parts(), [&](const ShownSurface::Part& each) {
      return each.body == body && each.kind == ShownSurface::Kind::cells;
    });
    if (part == surface_.parts().end() || part->num_vertices == 0) return frame;
    std::vector<Vector3> directions;
    const auto beside = [&](Index vertex) {
      Vector3 rest = place_of(vertex) - place_of(frame.front());
      for (const Vector3& direction : directions) rest -= direction * direction.dot(rest);
      return rest;
    };
    frame.push_back(part->first_vertex);
    const double extent = world_.largest_extent(world_.bodies[body]);
    while (static_cast<int>(frame.size()) < world_.dimension + 1) {
      Index farthest = frame.front();
      for (Index v = part->first_vertex; v < part->first_vertex + part->num_vertices; ++v)
        if (beside(v).squaredNorm() > beside(farthest).squaredNorm()) farthest = v;
      const Vector3 rest = beside(farthest);
      if (!(rest.norm() > flatness * extent)) break;
      directions.push_back(rest.normalized());
      frame.push_back(farthest);
    }
    return frame;
  }

  const World& world_;
  const ShownSurface& surface_;
  std::vector<std::vector<Index>> frames_;  ///< by body
};

class Maker {
 public:
  Maker(const World& world, const ShownSurface& surface)
      : world_(world), surface_(surface), frames_(world, surface) {}

  std::optional<ShownConnector::Point> point(const CarriedPoint& carried) {
    if (carried.nodes.empty()) return ShownConnector::Point{.place = carried.place};
    const Body& body = world_.body_of(carried.nodes.front().node);
    if (body.rigid)
      return frames_.carry(static_cast<std::size_t>(&body - world_.bodies.data()),
                           carried.at(world_.dimension, world_.rest_positions));
    ShownConnector::Point made;
    for (const auto& [node, weight] : carried.nodes) {
      const std::optional<Index> vertex = surface_.vertex_of(node);
      if (!vertex) return std::nullopt;
      made.vertices.push_back(*vertex);
      made.weights.push_back(weight);
    }
    return made;
  }

  /// The point `share` of the way from one point of a body to another one.
  std::optional<ShownConnector::Point> between(const CarriedPoint& from, const CarriedPoint& to,
                                               double share) {
    CarriedPoint sum;
    for (const auto& [end, weight] : {std::pair(&from, 1 - share), std::pair(&to, share)}) {
      for (const WeightedNode& each : end->nodes) sum.nodes.push_back({each.node, weight * each.weight});
      sum.place += weight * end->place;
    }
    return point(sum);
  }

  ShownConnector of_joint(const Joint& joint) {
    ShownConnector made{.kind = std::string(spelling(joint.kind)), .name = joint.name};
    if (joint.distance) {
      add_line(joint.distance->path().points(), made);
      for (std::size_t i = 0; i < made.points.size(); ++i) made.dots.push_back(i);
      return made;
    }
    const auto at = point(joint.at);
    if (!at) return made;
    made.points.push_back(*at);
    made.dots.push_back(0);
    if (!joint.has_frames) return made;
    using enum JointKind;
    const bool turns = joint.kind == hinge || joint.kind == cylindrical || joint.kind == universal;
    const bool is_flat = world_.dimension == 2 && joint.kind != slider;
    const bool has_axis = (turns || joint.kind == slider || joint.kind == planar) && !is_flat;
    if (has_axis) add_axis(joint.fixed.at, joint.fixed.axis, made);
    if (joint.kind == universal) add_axis(joint.moved.at, joint.moved.along, made);
    if (joint.kind != slider && joint.kind != cylindrical && joint.kind != planar) return made;
    // The way that the second body has gone.
    const auto from = point(joint.fixed.at), to = point(joint.moved.at);
    if (!from || !to) return made;
    made.lines.push_back({made.points.size(), made.points.size() + 1});
    made.dots = {made.points.size() + 1};
    made.points.push_back(*from);
    made.points.push_back(*to);
    return made;
  }

  ShownConnector of_cable(const Cable& cable, const char* kind) {
    ShownConnector made{.kind = kind, .name = std::string(cable.name())};
    add_line(cable.path().points(), made);
    if (!made.points.empty()) made.dots = {0, made.points.size() - 1};
    return made;
  }

 private:
  void add_axis(const CarriedPoint& at, const CarriedPoint& end, ShownConnector& made) {
    const auto low = between(at, end, -half_axis), high = between(at, end, half_axis);
    if (!low || !high) return;
    made.lines.push_back({made.points.size(), made.points.size() + 1});
    made.points.push_back(*low);
    made.points.push_back(*high);
  }

  void add_line(const std::vector<CarriedPoint>& carried, ShownConnector& made) {
    for (const CarriedPoint& each : carried) {
      const auto next = point(each);
      if (!next) continue;
      if (!made.points.empty()) made.lines.push_back({made.points.size() - 1, made.points.size()});
      made.points.push_back(*next);
    }
  }

  const World& world_;
  const ShownSurface& surface_;
  Frames frames_;
};

}  // namespace

std::vector<ShownConnector> shown_connectors(const World& world, const ShownSurface& surface) {
  Maker maker(world, surface);
  std::vector<ShownConnector> all;
  const auto add = [&all](ShownConnector made) {
    if (!made.points.empty()) all.push_back(std::move(made));
  };
  for (const Joint& joint : world.joints) add(maker.of_joint(joint));
  const std::ptrdiff_t num_springs =
      std::ranges::count(world.origins, TermOrigin::Kind::spring, &TermOrigin::kind);
  for (std::size_t i = 0; i < world.cables.size(); ++i)
    add(maker.of_cable(*world.cables[i], std::cmp_less(i, num_springs) ? "spring" : "cable"));
  return all;
}

}  // namespace resilin
