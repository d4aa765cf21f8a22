// Compiled once for each instruction set: see core/simd.hpp.
#include "resilin/material/kernels/plane_stress_kernels.hpp"

#include "resilin/core/simd_math.hpp"
#include "resilin/material/kernels/lane_tensors.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {
namespace {

constexpr std::size_t blocks_at_once = 8;
constexpr int max_newton_steps = 100;

/// Place of the pair m, n among the upper entries of a symmetric matrix of `count` rows.
constexpr int pair_place(int count, int m, int n) {
  return m <= n ? m * count - m * (m - 1) / 2 + n - m : pair_place(count, n, m);
}

/// Derivatives of the variables of the law in three dimensions. Those of plane strain are d1, nothing and j
/// (small strain: eps:eps, nothing and tr eps) and those of the fibres, and e = F33 - 1 is one more. With
/// t = 1 + e,
///
///   d1' = d1 - 2 j e + e^2,   d2' = t^2 d1 + j^2 + 2 e^2 (1 + j),   j' = j + e + j e.
template <LawKind kind>
struct Chain {
  static constexpr int n = num_slopes(kind);
  static constexpr bool is_small = kind == LawKind::small_strain;
  Lanes first[3], second[3], by_e[3];            ///< slopes of the three by d1, by j and by e
  Lanes xe[3], yy[3], ye[3], ee[3], x, y, t, e;  ///< and their second derivatives

  RESILIN_INLINE Chain(const double* plane, Lanes strain) : e(strain) {
    x = Lanes::load(plane);
    y = Lanes::load(plane + 2 * block_size);
    t = 1.0 + e;
    for (int m = 0; m < 3; ++m) first[m] = second[m] = by_e[m] = xe[m] = yy[m] = ye[m] = ee[m] = 0.0;
    first[0] = 1.0;
    ee[0] = 2.0;
    if constexpr (is_small) {
      second[2] = by_e[2] = 1.0;
      by_e[0] = 2.0 * e;
    } else {
      const Lanes J = 1.0 + y;
      first[1] = t * t;
      second[0] = -2.0 * e;
      second[1] = 2.0 * (y + e * e);
      second[2] = t;
      by_e[0] = 2.0 * (e - y);
      by_e[1] = 2.0 * x * t + 4.0 * e * J;
      by_e[2] = J;
      xe[1] = 2.0 * t;
      yy[1] = 2.0;
      ye[0] = -2.0;
      ye[1] = 4.0 * e;
      ye[2] = 1.0;
      ee[1] = 2.0 * x + 4.0 * J;
    }
  }

  RESILIN_INLINE void store_variables(const double* plane, double* out) const {
    if constexpr (is_small) {
      (x + e * e).store(out);
      Lanes(0.0).store(out + block_size);
      (y + e).store(out + 2 * block_size);
    } else {
      (x + e * (e - 2.0 * y)).store(out);
      (t * t * x + y * y + 2.0 * e * e * (1.0 + y)).store(out + block_size);
      (y + e + y * e).store(out + 2 * block_size);
      for (int row = 3; row < num_variables(kind); ++row)
        Lanes::load(plane + row * block_size).store(out + row * block_size);
    }
  }

  RESILIN_INLINE static Lanes sum(const double* slopes, const Lanes by[3]) {
    Lanes total = Lanes::load(slopes) * by[0];
    for (int m = 1; m < 3; ++m) total += Lanes::load(slopes + m * block_size) * by[m];
    return total;
  }
  RESILIN_INLINE static Lanes entry(const double* curvatures, int m, int k) {
    return Lanes::load(curvatures + pair_place(n, m, k) * block_size);
  }
  RESILIN_INLINE static Lanes sum(const double* curvatures, const Lanes a[3], const Lanes b[3]) {
    Lanes total = 0.0;
    for (int m = 0; m < 3; ++m)
      for (int k = 0; k < 3; ++k) total += entry(curvatures, m, k) * a[m] * b[k];
    return total;
  }
  RESILIN_INLINE static Lanes sum_of_row(const double* curvatures, int row, const Lanes a[3]) {
    Lanes total = entry(curvatures, row, 0) * a[0];
    for (int m = 1; m < 3; ++m) total += entry(curvatures, row, m) * a[m];
    return total;
  }

  /// dPsi/de from the rows of the law's gradient.
  RESILIN_INLINE Lanes slope_by_thickness(const double* rows) const { return sum(rows, by_e); }
  /// The same and d2Psi/de2 from the rows of its curvature.
  RESILIN_INLINE void by_thickness(const double* rows, Lanes& slope, Lanes& curvature) const {
    slope = sum(rows, by_e);
    curvature = sum(rows + n * block_size, by_e, by_e) + sum(rows, ee);
  }
  /// d2Psi/(de da) for the places of a result's gradient.
  RESILIN_INLINE void mixed(const double* rows, Lanes out[n]) const {
    const double* curvatures = rows + n * block_size;
    out[0] = sum(curvatures, first, by_e) + sum(rows, xe);
    out[1] = 0.0;
    out[2] = sum(curvatures, second, by_e) + sum(rows, ye);
    for (int a = 3; a < n; ++a) out[a] = sum_of_row(curvatures, a, by_e);
  }
  /// d Psi/da for the places of a result's gradient.
  RESILIN_INLINE void slopes(const double* rows, Lanes out[n]) const {
    out[0] = sum(rows, first);
    out[1] = 0.0;
    out[2] = sum(rows, second);
    for (int a = 3; a < n; ++a) out[a] = Lanes::load(rows + a * block_size);
  }
  RESILIN_INLINE void curvatures(const double* rows, Lanes out[]) const {
    const double* all = rows + n * block_size;
    out[pair_place(n, 0, 0)] = sum(all, first, first);
    out[pair_place(n, 0, 2)] = sum(all, first, second);
    out[pair_place(n, 2, 2)] = sum(all, second, second) + sum(rows, yy);
    for (int a = 0; a < n; ++a) out[pair_place(n, 1, a)] = 0.0;
    for (int a = 3; a < n; ++a) {
      out[pair_place(n, 0, a)] = sum_of_row(all, a, first);
      out[pair_place(n, 2, a)] = sum_of_row(all, a, second);
      for (int b = a; b < n; ++b) out[pair_place(n, a, b)] = entry(all, a, b);
    }
  }
  /// Area ratio in the plane less 1.
  RESILIN_INLINE static Lanes area_change(const double* plane) { return Lanes::load(plane + 2 * block_size); }
  /// The sum of the squared stretches in the plane.
  RESILIN_INLINE static Lanes square_sum(const double* plane) {
    return Lanes::load(plane) + 2.0 * Lanes::load(plane + 2 * block_size) + 2.0;
  }
};

/// The third principal stretch is the thickness: nothing is to be chained.
template <>
struct Chain<LawKind::stretches> {
  static constexpr int n = 3;
  static constexpr bool is_small = false;
  Lanes e;

  RESILIN_INLINE Chain(const double*, Lanes strain) : e(strain) {}
  RESILIN_INLINE void store_variables(const double* plane, double* out) const {
    for (int row = 0; row < 2; ++row) Lanes::load(plane + row * block_size).store(out + row * block_size);
    e.store(out + 2 * block_size);
  }
  RESILIN_INLINE static Lanes at(const double* rows, int row) { return Lanes::load(rows + row * block_size); }
  RESILIN_INLINE static Lanes slope_by_thickness(const double* rows) { return at(rows, 2); }
  RESILIN_INLINE void by_thickness(const double* rows, Lanes& slope, Lanes& curvature) const {
    slope = at(rows, 2);
    curvature = at(rows, n + pair_place(n, 2, 2));
  }
  RESILIN_INLINE void mixed(const double* rows, Lanes out[n]) const {
    out[0] = at(rows, n + pair_place(n, 0, 2));
    out[1] = at(rows, n + pair_place(n, 1, 2));
    out[2] = 0.0;
  }
  RESILIN_INLINE void slopes(const double* rows, Lanes out[n]) const {
    out[0] = at(rows, 0);
    out[1] = at(rows, 1);
    out[2] = 0.0;
  }
  RESILIN_INLINE void curvatures(const double* rows, Lanes out[]) const {
    for (int k = 0; k < 6; ++k) out[k] = at(rows, n + k);
    for (int a = 0; a < n; ++a) out[pair_place(n, a, 2)] = 0.0;
  }
  RESILIN_INLINE static Lanes area_change(const double* plane) {
    const Lanes a = at(plane, 0), b = at(plane, 1);
    return a + b + a * b;
  }
  RESILIN_INLINE static Lanes square_sum(const double* plane) {
    const Lanes a = 1.0 + at(plane, 0), b = 1.0 + at(plane, 1);
    return a * a + b * b;
  }
};

/// Where the first two axes lie in the plane the thickness is along the third: E_33 = e + e^2/2 and
/// j' = j + e + j e.
template <>
struct Chain<LawKind::axes> {
  static constexpr int n = num_slopes(LawKind::axes), third = 3;
  static constexpr bool is_small = false;
  Lanes e, t, J;

  RESILIN_INLINE Chain(const double* plane, Lanes strain)
      : e(strain), t(1.0 + strain), J(1.0 + at(plane, volume_slope_row)) {}
  RESILIN_INLINE static Lanes at(const double* rows, int row) { return Lanes::load(rows + row * block_size); }
  RESILIN_INLINE static Lanes entry(const double* curvatures, int m, int k) {
    return at(curvatures, pair_place(n, m, k));
  }
  RESILIN_INLINE void store_variables(const double* plane, double* out) const {
    for (int row = 0; row < n; ++row) at(plane, row).store(out + row * block_size);
    (at(plane, volume_slope_row) + e * J).store(out + volume_slope_row * block_size);
    (e + 0.5 * e * e).store(out + third * block_size);
  }
  RESILIN_INLINE Lanes slope_by_thickness(const double* rows) const {
    return at(rows, third) * t + at(rows, volume_slope_row) * J;
  }
  RESILIN_INLINE void by_thickness(const double* rows, Lanes& slope, Lanes& curvature) const {
    const double* all = rows + n * block_size;
    slope = slope_by_thickness(rows);
    curvature = entry(all, third, third) * t * t + 2.0 * entry(all, volume_slope_row, third) * t * J +
                entry(all, volume_slope_row, volume_slope_row) * J * J + at(rows, third);
  }
  /// d j'/dj, and nothing of E_33, which no state of the plane has.
  RESILIN_INLINE Lanes factor(int a) const {
    if (a == volume_slope_row) return t;
    return a == third ? 0.0 : 1.0;
  }
  RESILIN_INLINE void mixed(const double* rows, Lanes out[n]) const {
    const double* all = rows + n * block_size;
    for (int a = 0; a < n; ++a)
      out[a] = factor(a) * (entry(all, a, third) * t + entry(all, a, volume_slope_row) * J);
    out[volume_slope_row] += at(rows, volume_slope_row);
  }
  RESILIN_INLINE void slopes(const double* rows, Lanes out[n]) const {
    for (int a = 0; a < n; ++a) out[a] = factor(a) * at(rows, a);
  }
  RESILIN_INLINE void curvatures(const double* rows, Lanes out[]) const {
    const double* all = rows + n * block_size;
    for (int a = 0; a < n; ++a)
      for (int b = a; b < n; ++b) out[pair_place(n, a, b)] = factor(a) * factor(b) * entry(all, a, b);
  }
  RESILIN_INLINE static Lanes area_change(const double* plane) { return at(plane, volume_slope_row); }
  RESILIN_INLINE static Lanes square_sum(const double* plane) {
    return 2.0 * (at(plane, 0) + at(plane, 1)) + 2.0;
  }
};

/// One tile of points with what the law in three dimensions says of them.
template <LawKind kind>
class Points {
 public:
  static constexpr int rows = num_variables(kind), n = num_slopes(kind),
                       curvature_rows = num_curvature_rows(kind);

  RESILIN_INLINE Points(const LawKernels& solid, const LawBatch& batch, std::size_t first, std::size_t count)
      : solid_(solid),
        plane_(batch.variables + first * (rows * block_size)),
        constants_(batch.constants + first * batch.constant_stride),
        constant_stride_(batch.constant_stride),
        count_(count) {}

  /// Calls `body(block, lane)` for all groups of lanes.
  template <class Body>
  RESILIN_INLINE void for_lanes(const Body& body) const {
    for (std::size_t block = 0; block < count_; ++block)
      for (int lane = 0; lane < block_size; lane += Lanes::width) body(block, lane);
  }
  RESILIN_INLINE const double* plane(std::size_t block, int lane) const {
    return plane_ + block * (rows * block_size) + lane;
  }
  RESILIN_INLINE Lanes strain(std::size_t block, int lane) const {
    return Lanes::load(strain_ + block * block_size + lane);
  }
  RESILIN_INLINE Chain<kind> chain(std::size_t block, int lane) const {
    return Chain<kind>(plane(block, lane), strain(block, lane));
  }
  RESILIN_INLINE const double* law(std::size_t block, int lane, int num_rows) const {
    return law_ + block * static_cast<std::size_t>(num_rows * block_size) + lane;
  }
  const double* results() const { return law_; }

  RESILIN_INLINE LawBatch batch() { return {count_, variables_, constants_, constant_stride_, law_}; }
  RESILIN_INLINE LawBatch set_variables() {
    for_lanes([&](std::size_t block, int lane) {
      chain(block, lane).store_variables(plane(block, lane), variables_ + block * (rows * block_size) + lane);
    });
    return batch();
  }
  RESILIN_INLINE void call_energy() { solid_.energy(set_variables()); }
  RESILIN_INLINE void call_gradient() { solid_.gradient(set_variables()); }
  RESILIN_INLINE void call_curvature() { solid_.curvature(set_variables()); }
  RESILIN_INLINE void call_constant_gradient(int p) { solid_.constant_gradient(set_variables(), p); }
  RESILIN_INLINE void call_constant_curvature(int p, int q) {
    solid_.constant_curvature(set_variables(), p, q);
  }

  /// The thickness at which P33 = 0: Newton's method between bounds, from the incompressible solid's. It
  /// starts afresh for every state, so that a state has one energy whatever came before.
  void solve() {
    double low[size], high[size], best[size];
    bool is_done[size], has_value[size], was_moved[size];
    for_lanes([&](std::size_t block, int lane) {
      const Lanes j = Chain<kind>::area_change(plane(block, lane));
      Lanes start = -j;
      if constexpr (!Chain<kind>::is_small)
        start = select(j > Lanes(-1.0), -j / (1.0 + j), Lanes(__builtin_nan("")));
      start.store(strain_ + block * block_size + lane);
    });
    const std::size_t total = count_ * block_size;
    constexpr double lowest = Chain<kind>::is_small ? -__builtin_inf() : -1.0;
    for (std::size_t i = 0; i < total; ++i) {
      low[i] = lowest;
      high[i] = __builtin_inf();
      best[i] = 0;
      is_done[i] = !(strain_[i] == strain_[i]);
      has_value[i] = was_moved[i] = false;
    }
    double slope[size], curvature[size], other[size];
    for_lanes([&](std::size_t block, int lane) {
      Lanes stretch = 0.5 * Chain<kind>::square_sum(plane(block, lane));
      stretch.store(other + block * block_size + lane);
    });
    bool are_done = false;
    for (int step = 0; step < max_newton_steps && !are_done; ++step) {
      call_curvature();
      for_lanes([&](std::size_t block, int lane) {
        Lanes first, second;
        chain(block, lane).by_thickness(law(block, lane, curvature_rows), first, second);
        first.store(slope + block * block_size + lane);
        second.store(curvature + block * block_size + lane);
      });
      are_done = true;
      for (std::size_t i = 0; i < total; ++i) {
        if (is_done[i]) continue;
        double& e = strain_[i];
        if (!(__builtin_fabs(slope[i]) < __builtin_inf() && __builtin_fabs(curvature[i]) < __builtin_inf())) {
          if (has_value[i]) {  // outside the law's domain: back towards the last state inside it
            e = 0.5 * (e + best[i]);
          } else if (!was_moved[i]) {  // the thickness of the least isochoric distortion
            e = __builtin_sqrt(other[i]) - 1;
            was_moved[i] = true;
          } else {
            e = __builtin_nan("");
            is_done[i] = true;
            continue;
          }
          are_done = false;
          continue;
        }
        has_value[i] = true;
        best[i] = e;
        const double change = -slope[i] / curvature[i];
        if (curvature[i] > 0 &&
            __builtin_fabs(change) <= 1e-8 * __builtin_fabs(e) + 4 * __DBL_EPSILON__ * (1 + e)) {
          e += change;
          is_done[i] = true;
          continue;
        }
        are_done = false;
        (slope[i] > 0 ? high[i] : low[i]) = e;
        const double next = e + change;
        if (curvature[i] > 0 && next > low[i] && next < high[i])
          e = next;
        else if (high[i] == __builtin_inf())
          e = 2 * (1 + e) - 1;
        else
          e = 0.5 * (low[i] + high[i]);
      }
    }
    for (std::size_t i = 0; i < total; ++i)
      if (!is_done[i]) strain_[i] = __builtin_nan("");
  }

  RESILIN_INLINE void solve_and_condense() {
    solve();
    call_curvature();
    for_lanes([&](std::size_t block, int lane) {
      const Chain<kind> c = chain(block, lane);
      const double* r = law(block, lane, curvature_rows);
      Lanes slope, stiffness, mixed[n];
      c.by_thickness(r, slope, stiffness);
      c.mixed(r, mixed);
      double* out = mixed_ + block * ((n + 1) * block_size) + lane;
      store_rows(mixed, n, out);
      stiffness.store(out + n * block_size);
    });
  }
  /// d2Psi/(de da) for all a, and d2Psi/de2; after `solve_and_condense`.
  RESILIN_INLINE void load_mixed(std::size_t block, int lane, Lanes mixed[n], Lanes& stiffness) const {
    const double* from = mixed_ + block * ((n + 1) * block_size) + lane;
    load_rows(from, n, mixed);
    stiffness = Lanes::load(from + n * block_size);
  }

 private:
  static constexpr std::size_t size = blocks_at_once * block_size;
  const LawKernels& solid_;
  const double *plane_, *constants_;
  std::size_t constant_stride_, count_;
  alignas(64) double strain_[size];
  alignas(64) double variables_[max_variables * size];
  alignas(64) double law_[max_curvature_rows * size];
  alignas(64) double mixed_[(max_slopes + 1) * size];
};

/// Calls `body(points, results)` for some blocks after the other, `results` being where theirs begin.
template <LawKind kind, class Body>
RESILIN_INLINE void for_points(const LawKernels& solid, const LawBatch& batch, int rows, const Body& body) {
  for (std::size_t first = 0; first < batch.num_blocks; first += blocks_at_once) {
    const std::size_t left = batch.num_blocks - first;
    Points<kind> points(solid, batch, first, left < blocks_at_once ? left : blocks_at_once);
    body(points, batch.results + first * static_cast<std::size_t>(rows * block_size));
  }
}

template <LawKind kind>
void energy_of(const LawKernels& solid, const LawBatch& batch) {
  for_points<kind>(solid, batch, 1, [](Points<kind>& points, double* results) {
    points.solve();
    points.call_energy();
    points.for_lanes([&](std::size_t block, int lane) {
      const Lanes psi = Lanes::load(points.law(block, lane, 1));
      const Lanes known = psi - psi + points.strain(block, lane);
      select((known < Lanes(__builtin_inf())) & (known > Lanes(-__builtin_inf())), psi, __builtin_inf())
          .store(results + block * block_size + lane);
    });
  });
}

template <LawKind kind>
void gradient_of(const LawKernels& solid, const LawBatch& batch) {
  constexpr int n = num_slopes(kind);
  for_points<kind>(solid, batch, n, [](Points<kind>& points, double* results) {
    points.solve();
    points.call_gradient();
    points.for_lanes([&](std::size_t block, int lane) {
      Lanes out[n];
      points.chain(block, lane).slopes(points.law(block, lane, n), out);
      store_rows(out, n, results + block * (n * block_size) + lane);
    });
  });
}

template <LawKind kind>
void curvature_of(const LawKernels& solid, const LawBatch& batch) {
  constexpr int n = num_slopes(kind), rows = num_curvature_rows(kind), pairs = n * (n + 1) / 2;
  for_points<kind>(solid, batch, rows, [](Points<kind>& points, double* results) {
    points.solve_and_condense();
    points.for_lanes([&](std::size_t block, int lane) {
      const auto chain = points.chain(block, lane);
      const double* law = points.law(block, lane, rows);
      Lanes out[rows], mixed[n], stiffness;
      points.load_mixed(block, lane, mixed, stiffness);
      chain.slopes(law, out);
      chain.curvatures(law, out + n);
      for (int a = 0; a < n; ++a)
        for (int b = a; b < n; ++b) out[n + pair_place(n, a, b)] -= mixed[a] * mixed[b] / stiffness;
      for (int k = n + pairs; k < rows; ++k) out[k] = Lanes::load(law + k * block_size);
      store_rows(out, rows, results + block * (rows * block_size) + lane);
    });
  });
}

/// By a constant p: of Psi at the thickness as it is, and of its slopes with the thickness that follows.
template <LawKind kind>
void constant_gradient_of(const LawKernels& solid, const LawBatch& batch, int p) {
  constexpr int n = num_slopes(kind);
  for_points<kind>(solid, batch, n + 1, [p](Points<kind>& points, double* results) {
    points.solve_and_condense();
    points.call_constant_gradient(p);
    points.for_lanes([&](std::size_t block, int lane) {
      const auto chain = points.chain(block, lane);
      const double* law = points.law(block, lane, n + 1);
      Lanes out[n + 1], mixed[n], stiffness, slope;
      points.load_mixed(block, lane, mixed, stiffness);
      out[0] = Lanes::load(law);
      chain.slopes(law + block_size, out + 1);
      slope = chain.slope_by_thickness(law + block_size);
      for (int a = 0; a < n; ++a) out[1 + a] -= mixed[a] * slope / stiffness;
      store_rows(out, n + 1, results + block * ((n + 1) * block_size) + lane);
    });
  });
}

template <LawKind kind>
void constant_curvature_of(const LawKernels& solid, const LawBatch& batch, int p, int q) {
  constexpr int n = num_slopes(kind);
  for_points<kind>(solid, batch, 1, [p, q](Points<kind>& points, double* results) {
    alignas(64) double slopes[2][blocks_at_once * block_size];
    points.solve_and_condense();
    for (int which = 0; which < 2; ++which) {
      points.call_constant_gradient(which == 0 ? p : q);
      points.for_lanes([&](std::size_t block, int lane) {
        const auto chain = points.chain(block, lane);
        const double* law = points.law(block, lane, n + 1) + block_size;
        chain.slope_by_thickness(law).store(slopes[which] + block * block_size + lane);
      });
    }
    points.call_constant_curvature(p, q);
    points.for_lanes([&](std::size_t block, int lane) {
      Lanes mixed[n], stiffness;
      points.load_mixed(block, lane, mixed, stiffness);
      const std::size_t at = block * block_size + static_cast<std::size_t>(lane);
      (Lanes::load(points.law(block, lane, 1)) -
       Lanes::load(slopes[0] + at) * Lanes::load(slopes[1] + at) / stiffness)
          .store(results + at);
    });
  });
}

template <LawKind kind>
void thickness_strain_of(const LawKernels& solid, const LawBatch& batch) {
  for_points<kind>(solid, batch, 1, [](Points<kind>& points, double* results) {
    points.solve();
    points.for_lanes([&](std::size_t block, int lane) {
      points.strain(block, lane).store(results + block * block_size + lane);
    });
  });
}

/// Calls `body` with the kind as a constant.
template <class Body>
void with_kind(LawKind kind, const Body& body) {
  switch (kind) {
    case LawKind::invariants:
      return body.template operator()<LawKind::invariants>();
    case LawKind::stretches:
      return body.template operator()<LawKind::stretches>();
    case LawKind::fibres:
      return body.template operator()<LawKind::fibres>();
    case LawKind::axes:
      return body.template operator()<LawKind::axes>();
    case LawKind::small_strain:
      return body.template operator()<LawKind::small_strain>();
    case LawKind::sum:  // has no twin in plane stress
      return;
  }
}

void energy(LawKind kind, const LawKernels& solid, const LawBatch& batch) {
  with_kind(kind, [&]<LawKind k>() { energy_of<k>(solid, batch); });
}
void gradient(LawKind kind, const LawKernels& solid, const LawBatch& batch) {
  with_kind(kind, [&]<LawKind k>() { gradient_of<k>(solid, batch); });
}
void curvature(LawKind kind, const LawKernels& solid, const LawBatch& batch) {
  with_kind(kind, [&]<LawKind k>() { curvature_of<k>(solid, batch); });
}
void constant_gradient(LawKind kind, const LawKernels& solid, const LawBatch& batch, int p) {
  with_kind(kind, [&]<LawKind k>() { constant_gradient_of<k>(solid, batch, p); });
}
void constant_curvature(LawKind kind, const LawKernels& solid, const LawBatch& batch, int p, int q) {
  with_kind(kind, [&]<LawKind k>() { constant_curvature_of<k>(solid, batch, p, q); });
}
void thickness_strain(LawKind kind, const LawKernels& solid, const LawBatch& batch) {
  with_kind(kind, [&]<LawKind k>() { thickness_strain_of<k>(solid, batch); });
}

constexpr PlaneStressKernels kernels = {
    energy, gradient, curvature, constant_gradient, constant_curvature, thickness_strain};

}  // namespace
}  // namespace resilin::RESILIN_SIMD_NAMESPACE

namespace resilin {

template <InstructionSet>
const PlaneStressKernels& compiled_plane_stress_kernels() {
  return RESILIN_SIMD_NAMESPACE::kernels;
}
template const PlaneStressKernels& compiled_plane_stress_kernels<InstructionSet::RESILIN_SIMD_NAMESPACE>();

}  // namespace resilin
