#include "collision.hpp"

#include <algorithm>
#include <cmath>

#include "clock.hpp"
#include "resilin/collision/broad_phase.hpp"
#include "resilin/collision/collision_time.hpp"
#include "resilin/contact/pair_barrier.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/generators.hpp"

namespace resilin::bench {
namespace {

constexpr int num_timings = 15;
constexpr PairKind measured_kinds[] = {PairKind::point_triangle, PairKind::edge_edge};

Mesh make_cube_surface(int n) { return extract_surface(make_box({1, 1, 1}, {n, n, n})).mesh; }

/// The cube's surface pushed out to a ball of diameter 1, its triangles of nearly one size.
Mesh make_ball_surface(int n) {
  Mesh ball = make_cube_surface(n);
  for (Vector3& X : ball.vertices) {
    const Vector3 angle = std::atan(1.0) * (2 * X - Vector3::Ones());
    X = Vector3::Constant(0.5) + 0.5 * Vector3(angle.array().tan().matrix().normalized());
  }
  return ball;
}

/// One body above another one, and how it moves.
struct TwoBodies {
  CollisionSurface surface;
  std::vector<double> positions, ways;
  double activation_distance;

  TwoBodies(const Mesh& body, Vector3 way_in_distances) {
    const Vector3 extent(1, 1, 2);
    activation_distance = 1e-3 * extent.norm();
    for (const double lift : {0.0, 1 + 0.3 * activation_distance}) {
      add_body(surface, static_cast<Index>(body.vertices.size()), body.find_block(CellKind::triangle)->nodes);
      const Vector3 way = (lift > 0 ? activation_distance : 0) * way_in_distances;
      for (const Vector3& X : body.vertices)
        for (int i = 0; i < 3; ++i) {
          positions.push_back(X[i] + (i == 2 ? lift : 0));
          ways.push_back(way[i]);
        }
    }
  }
};

/// Pairs of a list that are within the activation distance, as their vertices' places.
std::vector<std::array<Vector3, 4>> active_pairs(const CandidateList& list,
                                                 const std::vector<MovingPoint>& points,
                                                 double activation_distance) {
  std::vector<double> squares(list.pairs.size());
  squared_distances(list, points, squares);
  std::vector<std::array<Vector3, 4>> active;
  for (std::size_t k = 0; k < squares.size(); ++k) {
    if (!(squares[k] < activation_distance * activation_distance)) continue;
    const auto vertices = list.vertices(list.pairs[k]);
    std::array<Vector3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = Vector3(points[static_cast<std::size_t>(vertices[i])].x);
    active.push_back(x);
  }
  return active;
}

void measure_barrier(const std::string& name, const SurfaceCandidates& found, const TwoBodies& bodies,
                     const std::vector<MovingPoint>& points, std::vector<Measurement>& out) {
  const ClampedLogBarrier barrier{bodies.activation_distance};
  double gradient = 0, hessian = 0, sum = 0;
  std::size_t count = 0;
  for (const PairKind kind : measured_kinds) {
    const auto active = active_pairs(found.list(kind, bodies.surface), points, bodies.activation_distance);
    count += active.size();
    gradient += median_wall_seconds(num_timings, [&] {
      for (const auto& x : active) sum += PairBarrier<3>(barrier, kind, x, 1).gradient()[0];
    });
    hessian += median_wall_seconds(num_timings, [&] {
      for (const auto& x : active)
        sum += PairBarrier<3>(barrier, kind, x, 1).hessian(Projection::clamp)(0, 0);
    });
  }
  const double pairs = std::max<double>(1, static_cast<double>(count));
  out.emplace_back(name + ", active pairs", std::isfinite(sum) ? static_cast<double>(count) : -1);
  out.emplace_back(name + ", gradient ns", 1e9 * gradient / pairs);
  out.emplace_back(name + ", projected Hessian ns", 1e9 * hessian / pairs);
}

void measure_bodies(const std::string& name, const TwoBodies& bodies, std::vector<Measurement>& out) {
  const std::vector<MovingPoint> rest = moving_points(3, bodies.positions);
  const std::vector<MovingPoint> points = moving_points(3, bodies.positions, bodies.ways);
  BroadPhase broad_phase(bodies.surface, BodyMeetings(2, true), rest);
  const double dhat = bodies.activation_distance;
  out.emplace_back(name + ", triangles", static_cast<double>(bodies.surface.triangles.size()) / 3);
  out.emplace_back(name + ", find at rest ms",
                   1e3 * median_wall_seconds(num_timings, [&] { broad_phase.find(rest, dhat); }));
  measure_barrier(name, broad_phase.candidates(), bodies, rest, out);
  out.emplace_back(name + ", find on the way ms",
                   1e3 * median_wall_seconds(num_timings, [&] { broad_phase.find(points, dhat); }));
  double seconds = 0, earliest = 1, squares_seconds = 0;
  std::size_t count = 0;
  std::vector<double> numbers;
  for (const PairKind kind : measured_kinds) {
    const CandidateList list = broad_phase.candidates().list(kind, bodies.surface);
    count += list.pairs.size();
    numbers.resize(list.pairs.size());
    seconds += median_wall_seconds(
        num_timings, [&] { earliest = std::min(earliest, earliest_collision_time(list, points)); });
    squares_seconds += median_wall_seconds(num_timings, [&] { squared_distances(list, points, numbers); });
  }
  const double candidates = std::max<double>(1, static_cast<double>(count));
  out.emplace_back(name + ", candidates", static_cast<double>(count));
  out.emplace_back(name + ", earliest time", earliest);
  out.emplace_back(name + ", detection ms", 1e3 * seconds);
  out.emplace_back(name + ", detection ns", 1e9 * seconds / candidates);
  out.emplace_back(name + ", squared distance ns", 1e9 * squares_seconds / candidates);
}

}  // namespace

std::vector<Measurement> measure_collision(int n) {
  std::vector<Measurement> out;
  const Mesh ball = make_ball_surface(n);
  measure_bodies("cubes face to face", TwoBodies(make_cube_surface(n), {0, 0, -0.6}), out);
  measure_bodies("balls", TwoBodies(ball, {0, 0, -0.6}), out);
  measure_bodies("balls on the way", TwoBodies(ball, {20, 0, -20}), out);
  return out;
}

}  // namespace resilin::bench
