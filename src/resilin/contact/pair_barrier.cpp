#include "resilin/contact/pair_barrier.hpp"

#include <cmath>
#include <limits>

namespace resilin {
namespace {

/// Adds factor (u v^T + v u^T): half of it along the sum of both directions, the other half, with the other
/// sign, along their difference.
template <int dim>
void add_symmetric_product(double factor, const PairVector<dim>& u, const PairVector<dim>& v,
                           RankOneSum<dim>& sum) {
  const double u_length = u.norm(), v_length = v.norm();
  if (!(u_length > 0 && v_length > 0)) return;
  const PairVector<dim> a = u / u_length, b = v / v_length;
  const double half = 0.5 * factor * u_length * v_length;
  sum.add(half, a + b);
  sum.add(-half, a - b);
}

}  // namespace

template <int dim>
PairBarrier<dim>::PairBarrier(const ClampedLogBarrier& barrier, PairKind kind,
                              std::span<const Vector<dim>> vertices, double stiffness,
                              const std::optional<EdgeMollifier>& mollifier)
    : barrier_(barrier), pair_(pair_distance<dim>(kind, vertices)), stiffness_(stiffness) {
  if constexpr (dim == 3) {
    if (!mollifier || kind != PairKind::edge_edge) return;
    const EdgeCross cross(vertices.template first<4>());
    if (!mollifier->fades(cross.squared())) return;
    mollifier_ = *mollifier;
    cross_ = cross;
  }
}

template <int dim>
double PairBarrier<dim>::value() const {
  if (!is_active()) return 0;
  const double m = cross_ ? mollifier_.value(cross_->squared()) : 1, b = barrier_.value(pair_.distance);
  return std::isfinite(b) ? stiffness_ * m * b : b;
}

template <int dim>
double PairBarrier<dim>::normal_force() const {
  const double m = cross_ ? mollifier_.value(cross_->squared()) : 1;
  return is_active() ? -stiffness_ * m * barrier_.slope(pair_.distance) : 0;
}

template <int dim>
PairVector<dim> PairBarrier<dim>::normal_force_gradient() const {
  if (!is_active()) return PairVector<dim>::Zero();
  PairVector<dim> g = -stiffness_ * barrier_.curvature(pair_.distance) * pair_.gradient();
  if constexpr (dim == 3) {
    if (cross_) {
      const double c = cross_->squared();
      g = mollifier_.value(c) * g -
          stiffness_ * barrier_.slope(pair_.distance) * mollifier_.slope(c) * cross_->gradient();
    }
  }
  return g;
}

template <int dim>
PairVector<dim> PairBarrier<dim>::gradient() const {
  if (!is_active()) return PairVector<dim>::Zero();
  PairVector<dim> g = stiffness_ * barrier_.slope(pair_.distance) * pair_.gradient();
  if constexpr (dim == 3) {
    if (cross_) {
      const double c = cross_->squared();
      g = mollifier_.value(c) * g +
          stiffness_ * barrier_.value(pair_.distance) * mollifier_.slope(c) * cross_->gradient();
    }
  }
  return g;
}

// (m b)'' = m b'' + b' (grad m grad d^T + grad d grad m^T) + b (m'' grad c grad c^T + m' Hess c), b'' whole.
template <int dim>
PairMatrix<dim> PairBarrier<dim>::hessian(Projection projection) const {
  if (!is_active()) return PairMatrix<dim>::Zero();
  const double d = pair_.distance;
  const DistanceSlopes slopes = DistanceSlopes::of(d, barrier_.slope(d), barrier_.curvature(d));
  RankOneSum<dim> sum;
  double m = 1;
  if constexpr (dim == 3) {
    if (cross_) {
      const double c = cross_->squared(), b = stiffness_ * barrier_.value(d);
      const PairVector<3> grad_c = cross_->gradient();
      m = mollifier_.value(c);
      add_symmetric_product<3>(stiffness_ * slopes.first * mollifier_.slope(c), grad_c, pair_.gradient(),
                               sum);
      sum.add(b * mollifier_.curvature(c), grad_c);
      cross_->add_hessian(b * mollifier_.slope(c), sum);
    }
  }
  add_distance_hessian<dim>(pair_, slopes, stiffness_ * m, sum);
  return sum.matrix(projection);
}

// m1 b1 - m0 b0 = m1 (b1 - b0) + (m1 - m0) b0.
template <int dim>
double pair_barrier_difference(const ClampedLogBarrier& barrier, PairKind kind,
                               std::span<const Vector<dim>> from, std::span<const Vector<dim>> to,
                               double stiffness, const std::optional<EdgeMollifier>& mollifier) {
  const double d = std::sqrt(squared_distance<dim>(kind, from)),
               change = distance_change<dim>(kind, from, to);
  if (!(d + change > barrier.radius)) return std::numeric_limits<double>::infinity();
  if (d >= barrier.reach() && d + change >= barrier.reach()) return 0;
  double difference = barrier.difference(d, change);
  if constexpr (dim == 3) {
    if (mollifier && kind == PairKind::edge_edge) {
      const std::span<const Vector3, 4> x0 = from.template first<4>(), x1 = to.template first<4>();
      const double c0 = EdgeCross(x0).squared(), dc = edge_cross_change(x0, x1);
      difference = mollifier->value(c0 + dc) * difference + mollifier->difference(c0, dc) * barrier.value(d);
    }
  }
  return stiffness * difference;
}

template double pair_barrier_difference<2>(const ClampedLogBarrier&, PairKind, std::span<const Vector<2>>,
                                           std::span<const Vector<2>>, double,
                                           const std::optional<EdgeMollifier>&);
template double pair_barrier_difference<3>(const ClampedLogBarrier&, PairKind, std::span<const Vector<3>>,
                                           std::span<const Vector<3>>, double,
                                           const std::optional<EdgeMollifier>&);
template class PairBarrier<2>;
template class PairBarrier<3>;

}  // namespace resilin
