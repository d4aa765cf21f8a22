#pragma once

#include <array>
#include <span>

#include "resilin/collision/pair_kind.hpp"
#include "resilin/collision/rank_one_sum.hpp"

namespace resilin {

/// The distance of a pair, and all that its derivatives are made of.
///
/// The closest points are r = sum_i w_i x_i apart, w depending on as many parameters as they are free in:
/// none for two vertices, one on an edge, two inside a triangle or two edges. Where the parameters minimise
/// |r|,
///
///   d = |r|,  grad d = w (x) n,  n = r / d,
///   Hess d = sum_a (w (x) e_a) (w (x) e_a)^T / d - sum_(a free) (w (x) e_a + d v_a (x) n) (...)^T / d
///
/// with unit tangents e_a normal to n and each other; v_a = dw/ds_a for the free parameters s_a that move r
/// along e_a at unit speed. One formula serves all features of all kinds.
/// Source: derivatives of a minimum by its parameters, e.g. Nocedal & Wright 2006, 12.8 (Schur complement).
template <int dim>
struct PairDistance {
  double distance;                                 ///< d [m]
  Vector<dim> normal;                              ///< n, of length 1; any that fits where d = 0
  std::array<double, most_pair_vertices> weights;  ///< w; exactly 0 for vertices without a share
  int num_free;                                    ///< parameters
  std::array<Vector<dim>, dim - 1> tangents;       ///< e_a, the free ones first
  std::array<std::array<double, most_pair_vertices>, dim - 1> weight_slopes;  ///< v_a [1/m], of the free ones

  /// grad d.
  PairVector<dim> gradient() const {
    PairVector<dim> g;
    for (std::size_t i = 0; i < weights.size(); ++i)
      g.template segment<dim>(static_cast<Eigen::Index>(i) * dim) = weights[i] * normal;
    return g;
  }
};

/// The distance of two parts of surfaces, `vertices` in their order; in 2D points and edges.
///
/// The closest feature is told exactly: a vertex has weight zero when the closest points do without it.
/// Parallel edges, whose closest points are many, are taken as an end and an edge.
template <int dim>
PairDistance<dim> pair_distance(PairKind kind, std::span<const Vector<dim>> vertices);

/// Only d^2 [m^2].
template <int dim>
double squared_distance(PairKind kind, std::span<const Vector<dim>> vertices);

/// d(to) - d(from) of one pair in two places, with its digits when the two are close and the closest feature
/// is the same; else with those of the difference of two numbers.
///
/// With the old weights at the new place the gap m = r + q differs by q = sum_i w_i (to_i - from_i); the new
/// gap is m without its part s along the feature, so that the squares differ by q . (2 r + q) - |s|^2.
template <int dim>
double distance_change(PairKind kind, std::span<const Vector<dim>> from, std::span<const Vector<dim>> to);

/// Derivatives of some psi(d) by the distance.
struct DistanceSlopes {
  double first;         ///< psi'
  double first_over_d;  ///< psi' / d, which may be finite at d = 0
  double second;        ///< psi''

  static DistanceSlopes of(double d, double first, double second) { return {first, first / d, second}; }
  /// Derivatives of psi = d^2.
  static DistanceSlopes of_square(double d) { return {2 * d, 2, 2}; }
};

/// Adds psi'' grad d grad d^T + psi' Hess d, times `factor`. Rotated together, tangents and slopes fall apart
/// into blocks of two by two, (w (x) e_a, v_a (x) n), whose eigenvectors are added.
template <int dim>
void add_distance_hessian(const PairDistance<dim>& pair, const DistanceSlopes& psi, double factor,
                          RankOneSum<dim>& sum);

}  // namespace resilin
