// Results of the library for pairs of parts of surfaces, as raw doubles for
// tests/oracle/collision_by_ipctk.py.
//
//   collision_numbers pairs KIND < in > out
//     in: for each pair its vertices' x and p (three numbers each), dhat
//     out: for each pair time of collision, squared distance (in lanes), distance, its gradient, and of the
//     barrier
//          value, gradient, Hessian times v, v_i = (-1)^i (i + 1) / 10
//   collision_numbers friction < in > out
//     in: for each contact slip x, y, eps; out: energy, force along x and y of a limit of 1 N
//   collision_numbers candidates < in > out
//     in: numbers of vertices, edges, triangles, distance; bodies, edges, triangles, x, p
//     out: number of edge-edge and point-triangle candidates, then the pairs

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "resilin/collision/broad_phase.hpp"
#include "resilin/collision/collision_time.hpp"
#include "resilin/contact/friction.hpp"
#include "resilin/contact/pair_barrier.hpp"

namespace resilin {
namespace {

std::vector<double> read_numbers() {
  const std::string bytes(std::istreambuf_iterator<char>(std::cin), {});
  const auto* begin = reinterpret_cast<const double*>(bytes.data());
  return {begin, begin + bytes.size() / sizeof(double)};
}

void write(std::span<const double> numbers) {
  std::cout.write(reinterpret_cast<const char*>(numbers.data()),
                  static_cast<std::streamsize>(numbers.size_bytes()));
}

void write_pairs(PairKind kind, const std::vector<double>& numbers) {
  const auto n = static_cast<std::size_t>(num_vertices(kind)), stride = 6 * n + 1;
  const std::size_t count = numbers.size() / stride;
  std::vector<double> x, p;
  std::vector<Candidate> pairs;
  std::vector<Index> first, second;
  for (std::size_t i = 0; i < count; ++i) {
    const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(i * stride);
    x.insert(x.end(), begin, begin + static_cast<std::ptrdiff_t>(3 * n));
    p.insert(p.end(), begin + static_cast<std::ptrdiff_t>(3 * n), begin + static_cast<std::ptrdiff_t>(6 * n));
    pairs.push_back({static_cast<Index>(i), static_cast<Index>(i)});
    for (std::size_t j = 0; j < n; ++j)
      (static_cast<int>(j) < num_first(kind) ? first : second).push_back(static_cast<Index>(i * n + j));
  }
  const CandidateList list{kind, pairs, first, second};
  const std::vector<MovingPoint> points = moving_points(3, x, p);
  std::vector<double> times(count), squares(count);
  collision_times(list, points, times);
  squared_distances(list, points, squares);
  PairVector<3> v = PairVector<3>::Zero();
  for (std::size_t i = 0; i < 3 * n; ++i)
    v[static_cast<Eigen::Index>(i)] = (i % 2 == 0 ? 0.1 : -0.1) * static_cast<double>(i + 1);
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<Vector3> vertices;
    for (std::size_t j = 0; j < n; ++j) vertices.emplace_back(Vector3::Map(&x[3 * (i * n + j)]));
    const PairBarrier<3> barrier({numbers[(i + 1) * stride - 1]}, kind, vertices, 1);
    const PairVector<3> slope = barrier.distance().gradient(), gradient = barrier.gradient(),
                        Hv = barrier.hessian(Projection::none) * v;
    std::vector<double> row{times[i], squares[i], barrier.distance().distance};
    const auto size = static_cast<std::ptrdiff_t>(3 * n);
    row.insert(row.end(), slope.data(), slope.data() + size);
    row.push_back(barrier.value());
    row.insert(row.end(), gradient.data(), gradient.data() + size);
    row.insert(row.end(), Hv.data(), Hv.data() + size);
    write(row);
  }
}

/// Presses one node on the plane z = 0 with 1 N, coefficient 1.
struct OnePress final : FrictionSource {
  void add_friction_contacts(const VectorX&, const VectorX&, const Conditions&,
                             FrictionContacts& contacts) const override {
    contacts.add({.normal = Vector3::UnitZ(), .limit = 1}, std::vector<WeightedNode>{{0, 1}});
  }
};

void write_friction(const std::vector<double>& numbers) {
  const auto press = std::make_shared<OnePress>();
  for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
    const Friction friction(3, {press}, numbers[i + 2]);  // in a second
    const VectorX start = VectorX::Zero(3);
    LaggedFriction lagged(friction,
                          {.base_positions = start, .base_velocities = start, .duration = 1, .shape = start});
    lagged.form_lag(start, {});
    const VectorX x = Vector3(numbers[i], numbers[i + 1], 0);
    VectorX gradient = VectorX::Zero(3);
    lagged.add_gradient(x, {}, gradient);
    write(std::vector<double>{lagged.difference(start, x, {}), gradient[0], gradient[1]});
  }
}

void write_candidates(const std::vector<double>& numbers) {
  auto next = numbers.begin();
  const auto count = [&next] { return static_cast<std::size_t>(*next++); };
  const std::size_t num_vertices = count(), num_edges = count(), num_triangles = count();
  const double distance = *next++;
  const auto take = [&next](std::size_t size) {
    const auto begin = next;
    next += static_cast<std::ptrdiff_t>(size);
    return std::vector<double>(begin, next);
  };
  const auto indices = [&take](std::size_t size) {
    const std::vector<double> read = take(size);
    return std::vector<Index>(read.begin(), read.end());
  };
  CollisionSurface surface;
  surface.bodies = indices(num_vertices);
  for (std::size_t i = 0; i < num_vertices; ++i) surface.points.push_back(static_cast<Index>(i));
  surface.edges = indices(2 * num_edges);
  surface.triangles = indices(3 * num_triangles);
  const std::vector<double> x = take(3 * num_vertices), p = take(3 * num_vertices);
  const std::vector<MovingPoint> points = moving_points(3, x, p);
  const Index num_bodies = surface.bodies.back() + 1;
  BroadPhase search(surface, BodyMeetings(num_bodies, true), points);
  const SurfaceCandidates& found = search.find(points, distance);
  write(std::vector<double>{static_cast<double>(found.edge_edge.size()),
                            static_cast<double>(found.point_triangle.size())});
  for (const auto* pairs : {&found.edge_edge, &found.point_triangle})
    for (const auto& [a, b] : *pairs)
      write(std::vector<double>{static_cast<double>(a), static_cast<double>(b)});
}

}  // namespace
}  // namespace resilin

int main(int count, char** arguments) {
  const std::string what = count > 1 ? arguments[1] : "", kind = count > 2 ? arguments[2] : "";
  const std::vector<std::string> kinds{"point_point", "point_edge", "point_triangle", "edge_edge"};
  const auto found = std::ranges::find(kinds, kind);
  if (what == "pairs" && found != kinds.end())
    resilin::write_pairs(static_cast<resilin::PairKind>(found - kinds.begin()), resilin::read_numbers());
  else if (what == "friction")
    resilin::write_friction(resilin::read_numbers());
  else if (what == "candidates")
    resilin::write_candidates(resilin::read_numbers());
  else {
    std::fprintf(stderr, "collision_numbers: expected pairs KIND, friction or candidates, got %s %s\n",
                 what.c_str(), kind.c_str());
    return 1;
  }
  return std::cout.flush() ? 0 : 1;
}
