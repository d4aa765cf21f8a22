#include "resilin/collision/pair_distance.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "resilin/collision/closest_points.hpp"

namespace resilin {
namespace {

using Weights = std::array<double, most_pair_vertices>;

template <int dim>
ClosestPoints<double> closest_points_of(PairKind kind, std::span<const Vector<dim>> vertices) {
  Triple<double> x[most_pair_vertices];
  for (std::size_t i = 0; i < vertices.size(); ++i)
    x[i] = {{vertices[i][0], vertices[i][1], dim == 3 ? vertices[i][dim - 1] : 0.0}};
  switch (kind) {
    case PairKind::point_point:
      return closest_points<PairKind::point_point>(x);
    case PairKind::point_edge:
      return closest_points<PairKind::point_edge>(x);
    case PairKind::point_triangle:
      return closest_points<PairKind::point_triangle>(x);
    case PairKind::edge_edge:
      break;
  }
  return closest_points<PairKind::edge_edge>(x);
}

/// A unit vector normal to the unit vector u.
Vector<3> any_normal(const Vector<3>& u) {
  Eigen::Index axis = 0;
  u.cwiseAbs().minCoeff(&axis);
  return u.cross(Vector<3>::Unit(axis)).normalized();
}
Vector<2> any_normal(const Vector<2>& u) { return {-u.y(), u.x()}; }

/// Edges along which the closest points may move: from the first vertex with a share to each other one of its
/// part.
template <int dim>
struct FreeEdges {
  int count = 0;
  std::array<Vector<dim>, 2> along;
  std::array<Weights, 2> slopes{};  ///< slopes of the weights, for a motion by `along`

  FreeEdges(PairKind kind, std::span<const Vector<dim>> x, const Weights& weights) {
    const auto first = static_cast<std::size_t>(num_first(kind));
    add(x, weights, 0, first);
    add(x, weights, first, x.size());
  }

 private:
  void add(std::span<const Vector<dim>> x, const Weights& weights, std::size_t begin, std::size_t end) {
    std::size_t base = begin;
    while (base + 1 < end && weights[base] == 0) ++base;
    for (std::size_t i = base + 1; i < end; ++i) {
      if (weights[i] == 0 || count == dim - 1) continue;
      const auto k = static_cast<std::size_t>(count++);
      along[k] = x[i] - x[base];
      slopes[k][i] = 1;
      slopes[k][base] = -1;
    }
  }
};

Weights combined(double a, const Weights& x, double b, const Weights& y) {
  Weights sum;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = a * x[i] + b * y[i];
  return sum;
}

/// Tangents, slopes and the normal, which is better known from the tangents than from a short gap.
template <int dim>
void set_frame(const FreeEdges<dim>& edges, const Vector<dim>& gap, PairDistance<dim>& pair) {
  pair.num_free = edges.count;
  const auto away = [&gap](const Vector<dim>& n) -> Vector<dim> {
    return n.dot(gap) < 0 ? Vector<dim>(-n) : n;
  };
  if (edges.count == 0) {
    pair.normal = pair.distance > 0 ? Vector<dim>(gap / pair.distance) : Vector<dim>::UnitX();
    pair.tangents[0] = any_normal(pair.normal);
  } else {
    const double length = edges.along[0].norm();
    pair.tangents[0] = edges.along[0] / length;
    pair.weight_slopes[0] = combined(1 / length, edges.slopes[0], 0, edges.slopes[0]);
  }
  if constexpr (dim == 2) {
    if (edges.count == 1) pair.normal = away(any_normal(pair.tangents[0]));
  } else {
    const Vector<3>& e = pair.tangents[0];
    if (edges.count == 1) {
      const Vector<3> n = gap - gap.dot(e) * e;
      pair.normal = n.squaredNorm() > 0 ? Vector<3>(n.normalized()) : any_normal(e);
    } else if (edges.count == 2) {
      pair.normal = away(e.cross(edges.along[1]).normalized());
    }
    pair.tangents[1] = pair.normal.cross(e);
    if (edges.count == 2) {
      const double across = 1 / edges.along[1].dot(pair.tangents[1]);
      pair.weight_slopes[1] =
          combined(across, edges.slopes[1], -across * edges.along[1].dot(e), pair.weight_slopes[0]);
    }
  }
}

/// a (w (x) e) + b (v (x) n).
template <int dim>
PairVector<dim> combined_product(double a, const Weights& w, const Vector<dim>& e, double b, const Weights& v,
                                 const Vector<dim>& n) {
  PairVector<dim> u;
  const Vector<dim> ae = a * e, bn = b * n;
  for (std::size_t i = 0; i < w.size(); ++i)
    u.template segment<dim>(static_cast<Eigen::Index>(i) * dim) = w[i] * ae + v[i] * bn;
  return u;
}

double inner(const Weights& a, const Weights& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Rotates both tangents and their slopes together so that the slopes are orthogonal: one Jacobi rotation.
void separate(std::array<Vector<3>, 2>& tangents, std::array<Weights, 2>& slopes) {
  const double d = inner(slopes[1], slopes[1]) - inner(slopes[0], slopes[0]);
  const double g = 2 * inner(slopes[0], slopes[1]);
  const double r = std::hypot(d, g);
  if (!(r > 0)) return;
  const double c = std::sqrt(0.5 + 0.5 * std::abs(d) / r), s = std::copysign(0.5, d) * g / (r * c);
  const Vector<3> e = c * tangents[0] - s * tangents[1];
  tangents[1] = s * tangents[0] + c * tangents[1];
  tangents[0] = e;
  const Weights v = combined(c, slopes[0], -s, slopes[1]);
  slopes[1] = combined(s, slopes[0], c, slopes[1]);
  slopes[0] = v;
}

}  // namespace

template <int dim>
PairDistance<dim> pair_distance(PairKind kind, std::span<const Vector<dim>> vertices) {
  const ClosestPoints<double> closest = closest_points_of<dim>(kind, vertices);
  PairDistance<dim> pair{};
  pair.distance = std::sqrt(closest.squared_distance);
  for (std::size_t i = 0; i < pair.weights.size(); ++i) pair.weights[i] = closest.weights[i];
  Vector<dim> gap;
  for (int i = 0; i < dim; ++i) gap[i] = closest.gap.x[i];
  set_frame(FreeEdges<dim>(kind, vertices, pair.weights), gap, pair);
  return pair;
}

template <int dim>
double squared_distance(PairKind kind, std::span<const Vector<dim>> vertices) {
  return closest_points_of<dim>(kind, vertices).squared_distance;
}

// -psi' [[0, |w| s], [|w| s, d s^2]] on the unit vectors along w (x) e_a and v_a (x) n, s = |v_a|, has the
// eigenvalues -psi' (d s^2 +- h) / 2, h^2 = d^2 s^4 + 4 |w|^2 s^2.
template <int dim>
void add_distance_hessian(const PairDistance<dim>& pair, const DistanceSlopes& psi, double factor,
                          RankOneSum<dim>& sum) {
  sum.add(factor * psi.second, pair.gradient());
  std::array<Vector<dim>, dim - 1> tangents = pair.tangents;
  std::array<Weights, dim - 1> slopes = pair.weight_slopes;
  if constexpr (dim == 3) {
    if (pair.num_free == 2) separate(tangents, slopes);
  }
  const double ww = inner(pair.weights, pair.weights);
  for (int a = 0; a < dim - 1; ++a) {
    const Vector<dim>& e = tangents[static_cast<std::size_t>(a)];
    const Weights& v = slopes[static_cast<std::size_t>(a)];
    if (a >= pair.num_free) {
      sum.add(factor * psi.first_over_d, combined_product<dim>(1, pair.weights, e, 0, v, pair.normal));
      continue;
    }
    const double vv = inner(v, v), coupling = std::sqrt(ww * vv), bend = pair.distance * vv;
    const double larger = 0.5 * (bend + std::sqrt(bend * bend + 4 * ww * vv)), smaller = -ww * vv / larger;
    const double scale = 1 / std::sqrt(ww * vv + larger * larger);
    const double along = scale / std::sqrt(ww), across = scale / std::sqrt(vv);
    sum.add(-factor * psi.first * larger,
            combined_product<dim>(along * coupling, pair.weights, e, across * larger, v, pair.normal));
    sum.add(-factor * psi.first * smaller,
            combined_product<dim>(along * larger, pair.weights, e, -across * coupling, v, pair.normal));
  }
}

template <int dim>
double distance_change(PairKind kind, std::span<const Vector<dim>> from, std::span<const Vector<dim>> to) {
  const ClosestPoints<double> before = closest_points_of<dim>(kind, from),
                              after = closest_points_of<dim>(kind, to);
  const auto split = static_cast<std::size_t>(num_first(kind));
  Vector<dim> r, q = Vector<dim>::Zero(), s = Vector<dim>::Zero();
  for (int i = 0; i < dim; ++i) r[i] = before.gap.x[i];
  bool is_same_feature = true;
  for (std::size_t i = 0; i < from.size(); ++i) {
    q += before.weights[i] * (to[i] - from[i]);
    s += (after.weights[i] - before.weights[i]) * (to[i] - to[i < split ? 0 : split]);
    is_same_feature = is_same_feature && (before.weights[i] == 0) == (after.weights[i] == 0);
  }
  const double sum = std::sqrt(before.squared_distance) + std::sqrt(after.squared_distance);
  if (sum == 0) return 0;
  const double of_weights = is_same_feature ? -s.squaredNorm() : s.dot(2 * (r + q) + s);
  return (q.dot(2 * r + q) + of_weights) / sum;
}

template double distance_change<2>(PairKind, std::span<const Vector<2>>, std::span<const Vector<2>>);
template double distance_change<3>(PairKind, std::span<const Vector<3>>, std::span<const Vector<3>>);
template PairDistance<2> pair_distance<2>(PairKind, std::span<const Vector<2>>);
template PairDistance<3> pair_distance<3>(PairKind, std::span<const Vector<3>>);
template double squared_distance<2>(PairKind, std::span<const Vector<2>>);
template double squared_distance<3>(PairKind, std::span<const Vector<3>>);
template void add_distance_hessian<2>(const PairDistance<2>&, const DistanceSlopes&, double, RankOneSum<2>&);
template void add_distance_hessian<3>(const PairDistance<3>&, const DistanceSlopes&, double, RankOneSum<3>&);

}  // namespace resilin
