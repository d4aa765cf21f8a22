// Compiled once for each instruction set: see core/simd.hpp.
#include "resilin/collision/kernels/pair_kernels.hpp"

#include "resilin/collision/closest_points.hpp"
#include "resilin/collision/kernels/pair_group.hpp"
#include "resilin/core/simd_intrinsics.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {
namespace {

// Both parts are convex, and what counts for them is their difference: the convex hull of all D = x_i - y_j
// (Minkowski), a point, a segment, a triangle or a parallelogram. The parts are as far apart as it is from
// the origin, and along a unit normal n by no less than the least n . D.

template <PairKind kind>
constexpr int num_differences = num_first(kind) * num_second(kind);

/// A slab that separates the parts: its normal, from the second to the first, and its width, which is
/// negative when they overlap along the normal.
struct Slab {
  Triple<Lanes> normal;
  Lanes width;
};

template <int count>
RESILIN_INLINE Slab slab_along(const Triple<Lanes>& direction, const Triple<Lanes> D[count]) {
  // Nothing but zero has no direction: its slab has no width.
  const Triple<Lanes> normal = reciprocal_sqrt(dot(direction, direction) + 1e-290) * direction;
  Lanes width = dot(normal, D[0]);
  for (int k = 1; k < count; ++k) width = min(width, dot(normal, D[k]));
  return {normal, width};
}

/// The point of a segment that is nearest to the origin; between its ends made normal to it once more, as the
/// round-off of its ends would tilt a short one.
RESILIN_INLINE Triple<Lanes> nearest_on_segment(const Triple<Lanes>& a, const Triple<Lanes>& b) {
  const Triple<Lanes> e = a - b;
  const Lanes inverse = 1.0 / dot(e, e);
  const Lanes s = min(max(dot(a, e) * inverse, 0.0), 1.0);  // 0 for a segment of no length
  const Triple<Lanes> gap = (1.0 - s) * a + s * b;
  const Mask is_between = (s > Lanes(0.0)) & (s < Lanes(1.0));
  return gap - select(is_between, dot(gap, e) * inverse, 0.0) * e;
}
RESILIN_INLINE Triple<Lanes> nearer(const Triple<Lanes>& a, const Triple<Lanes>& b) {
  return select(dot(b, b) < dot(a, a), b, a);
}

/// The widest slab with the normal of the plane of the differences or with that to the nearest of their
/// sides: the true distance is the width of one of these.
template <PairKind kind>
RESILIN_INLINE Slab separate(const Triple<Lanes> D[num_differences<kind>]) {
  constexpr int count = num_differences<kind>;
  if constexpr (kind == PairKind::point_point) return slab_along<count>(D[0], D);
  if constexpr (kind == PairKind::point_edge) return slab_along<count>(nearest_on_segment(D[0], D[1]), D);
  if constexpr (count >= 3) {
    constexpr bool is_triangle = kind == PairKind::point_triangle;
    Triple<Lanes> side = nearer(nearest_on_segment(D[0], D[1]), nearest_on_segment(D[0], D[2]));
    if constexpr (is_triangle)
      side = nearer(side, nearest_on_segment(D[1], D[2]));
    else
      side = nearer(side, nearer(nearest_on_segment(D[1], D[3]), nearest_on_segment(D[2], D[3])));
    // The longer edge is long where the angle is small and round-off tilts N: normal to it once more.
    const Triple<Lanes> e1 = D[1] - D[0], e2 = D[2] - D[0], cross_product = cross(e1, e2);
    const Triple<Lanes> e = select(dot(e1, e1) < dot(e2, e2), e2, e1);
    const Triple<Lanes> N = cross_product - (dot(cross_product, e) / dot(e, e)) * e;
    const Slab at_side = slab_along<count>(side, D);
    const Slab at_plane = slab_along<count>(select(dot(N, D[0]) < Lanes(0.0), Lanes(-1.0) * N, N), D);
    const Mask is_wider = at_plane.width > at_side.width;
    return {select(is_wider, at_plane.normal, at_side.normal),
            select(is_wider, at_plane.width, at_side.width)};
  }
}

/// Bound of the round-off of a width: of the sums for D, n and n . D, and of x + t p as a caller forms it.
/// Each is a few units of 1.1e-16 of some coordinate, all together 42.
template <PairKind kind>
RESILIN_INLINE Lanes round_off(const PairGroup<kind>& pair) {
  Lanes sum = 0.0;
  for (int i = 0; i < pair.m + pair.n; ++i) sum += dot(pair.x[i], pair.x[i]) + dot(pair.p[i], pair.p[i]);
  return 7e-15 * sqrt(sum);
}

/// The least t in (0, 1) with a + b t + c t^2 = 0, for a > 0; 1 without one.
RESILIN_INLINE Lanes first_root(const Lanes& a, const Lanes& b, const Lanes& c) {
  const Lanes discriminant = b * b - 4.0 * (a * c), root = sqrt(max(discriminant, 0.0));
  const Mask falls = b < Lanes(0.0), turns = c < Lanes(0.0);
  const Lanes t = select(falls, 2.0 * a / (root - b), (b + root) / (-2.0 * c));
  const Mask is_one = (falls | turns) & (discriminant > Lanes(0.0)) & (t < Lanes(1.0));
  return select(is_one, t, 1.0);
}

/// Fraction of the way by V[k] for which the differences stay above a plane that turns on it at even speed
/// from one normal to the other: (n + t (m - n)) . (D + t V) >= kept, where the normal is no longer than 1.
template <int count>
RESILIN_INLINE Lanes free_share_of_turning(const Triple<Lanes>& n, const Triple<Lanes>& m,
                                           const Triple<Lanes> D[count], const Triple<Lanes> V[count],
                                           const Lanes& kept) {
  const Triple<Lanes> turn = m - n;
  Lanes share = 1.0;
  for (int k = 0; k < count; ++k)
    share = min(share, first_root(dot(n, D[k]) - kept, dot(n, V[k]) + dot(turn, D[k]), dot(turn, V[k])));
  return share;
}

/// Until when, at most `end`, the pairs are free: see collision/collision_time.hpp.
template <PairKind kind>
RESILIN_INLINE Lanes free_time(const PairGroup<kind>& pair, const AdvancementLimits& limits, Lanes end) {
  constexpr int count = num_differences<kind>;
  Triple<Lanes> D0[count], V[count], D[count];
  for (int i = 0; i < pair.m; ++i)
    for (int j = 0; j < pair.n; ++j) {
      const int k = i * pair.n + j;
      D[k] = D0[k] = pair.x[i] - pair.x[pair.m + j];
      V[k] = pair.p[i] - pair.p[pair.m + j];
    }
  const Lanes error = round_off<kind>(pair);
  Slab slab = separate<kind>(D);
  const Lanes start = slab.width - error;
  const Mask is_apart = start > Lanes(0.0);  // false also for what is no number
  const Lanes kept = limits.share_left * start + error, enough = kept + limits.tolerance * start;
  Mask is_open = is_apart;
  Lanes t = 0.0, ahead = 1.0;
  for (int iteration = 0; iteration < limits.max_iterations; ++iteration) {
    Lanes room[count], rate[count], at_end = 0.0;
    for (int k = 0; k < count; ++k) {
      room[k] = dot(slab.normal, D[k]) - kept;
      rate[k] = dot(slab.normal, V[k]);
      at_end = min(at_end, room[k] + (end - t) * rate[k]);
    }
    const Mask meets = (at_end < Lanes(0.0)) & (t < end);
    t = select(is_open & ~meets, end, t);
    is_open &= meets;
    if (!any(is_open)) break;
    Lanes step = 1.0 - t;
    for (int k = 0; k < count; ++k) step = select(rate[k] < Lanes(0.0), min(step, room[k] / -rate[k]), step);
    // Parts that turn leave a slab that does not long before they meet: so one that turns with them.
    // The steps do not depend on `end`, so that the earliest of all is the same whatever is known before.
    ahead = min(ahead, 1.0 - t);
    Triple<Lanes> way[count], there[count];
    for (int k = 0; k < count; ++k) {
      way[k] = ahead * V[k];
      there[k] = D[k] + way[k];
    }
    const Slab later = separate<kind>(there);
    const Triple<Lanes> normal =
        select(dot(later.normal, slab.normal) < Lanes(0.0), Lanes(-1.0) * later.normal, later.normal);
    const Lanes share = free_share_of_turning<count>(slab.normal, normal, D, way, kept);
    step = max(max(step, share * ahead), 0.0);
    t += select(is_open, step, 0.0);
    ahead = select(share < Lanes(1.0), max(2.0 * step, 0.25 * ahead), 2.0 * ahead);
    for (int k = 0; k < count; ++k) D[k] = D0[k] + t * V[k];
    slab = separate<kind>(D);
    is_open &= slab.width > enough;
    if (!any(is_open)) break;
  }
  return select(is_apart, min(t, end), 0.0);
}

template <PairKind kind>
double collision_times(const PairBatch& batch, const MovingPoint* points, const AdvancementLimits& limits,
                       double* times) {
  double earliest = 1;
  for (std::size_t begin = 0; begin < batch.count; begin += Lanes::width) {
    const PairGroup<kind> pair(batch, points, begin);
    const Lanes t = free_time<kind>(pair, limits, times == nullptr ? earliest : 1.0);
    if (times != nullptr) store_results(t, begin, batch.count, times + begin);
    for (int lane = 0; lane < Lanes::width; ++lane) earliest = t.v[lane] < earliest ? t.v[lane] : earliest;
  }
  return earliest;
}

template <PairKind kind>
void squared_distances(const PairBatch& batch, const MovingPoint* points, double* squares) {
  for (std::size_t begin = 0; begin < batch.count; begin += Lanes::width) {
    const PairGroup<kind> pair(batch, points, begin);
    store_results(closest_points<kind>(pair.x).squared_distance, begin, batch.count, squares + begin);
  }
}

template <PairKind kind>
constexpr PairKernels kernels = {collision_times<kind>, squared_distances<kind>};

const PairKernels& kernels_of_pairs(PairKind kind) {
  switch (kind) {
    case PairKind::point_point:
      return kernels<PairKind::point_point>;
    case PairKind::point_edge:
      return kernels<PairKind::point_edge>;
    case PairKind::point_triangle:
      return kernels<PairKind::point_triangle>;
    case PairKind::edge_edge:
      break;
  }
  return kernels<PairKind::edge_edge>;
}

}  // namespace
}  // namespace resilin::RESILIN_SIMD_NAMESPACE

namespace resilin {

template <InstructionSet>
const PairKernels& compiled_pair_kernels(PairKind kind) {
  return RESILIN_SIMD_NAMESPACE::kernels_of_pairs(kind);
}
template const PairKernels& compiled_pair_kernels<InstructionSet::RESILIN_SIMD_NAMESPACE>(PairKind);

}  // namespace resilin
