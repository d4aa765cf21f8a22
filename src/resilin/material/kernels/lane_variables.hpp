#pragma once

#include "resilin/core/simd_intrinsics.hpp"
#include "resilin/core/simd_math.hpp"
#include "resilin/core/simd_svd.hpp"
#include "resilin/material/kernels/lane_tensors.hpp"
#include "resilin/material/kernels/law_kernels.hpp"

/// From H = F - I to the variables of a law's kind, one state in each lane.
namespace resilin::RESILIN_SIMD_NAMESPACE {

/// The reduced invariants d1, d2, j (material/invariants.hpp); d2 = 0 where the law does not use it.
template <int dim>
RESILIN_INLINE void invariants(const Lanes H[], bool has_second_invariant, Lanes out[3]) {
  if constexpr (dim == 2) {
    const Lanes off = H[1] * H[2], det = H[0] * H[3] - off;
    const Lanes J = (1.0 + H[0]) * (1.0 + H[3]) - off;
    const Lanes j = select(J < Lanes(0.5), J - 1.0, H[0] + H[3] + det);
    out[0] = norm2<2>(H) - 2.0 * det;
    out[1] = out[0] + j * j;
    out[2] = j;
  } else {
    Lanes cof_H[9];
    cofactor(H, cof_H);
    const Lanes m2 = cof_H[0] + cof_H[4] + cof_H[8];
    const Lanes det = H[0] * cof_H[0] + H[1] * cof_H[1] + H[2] * cof_H[2];
    const Lanes F0 = 1.0 + H[0], F4 = 1.0 + H[4], F8 = 1.0 + H[8];
    const Lanes J =
        F0 * (F4 * F8 - H[5] * H[7]) + H[1] * (H[5] * H[6] - H[3] * F8) + H[2] * (H[3] * H[7] - F4 * H[6]);
    out[0] = norm2<3>(H) - 2.0 * (m2 + det);
    out[1] = 0.0;
    if (has_second_invariant) {
      Lanes Y[9];
      cofactor_minus_identity(H, cof_H, Y);
      out[1] = norm2<3>(Y) - (2.0 * m2 + 4.0 * det);
    }
    // Near J = 0 the determinant of F itself: a cell that is exactly flat must be seen as such.
    out[2] = select(J < Lanes(0.5), J - 1.0, H[0] + H[4] + H[8] + m2 + det);
  }
}

/// eps:eps, nothing and tr eps of the small strain eps = sym H.
template <int dim>
RESILIN_INLINE void small_strain(const Lanes H[], Lanes out[3]) {
  Lanes square = 0.0, trace = 0.0;
  for (int i = 0; i < dim; ++i) {
    trace += H[(dim + 1) * i];
    square += H[(dim + 1) * i] * H[(dim + 1) * i];
    for (int k = i + 1; k < dim; ++k) {
      const Lanes sum = H[dim * i + k] + H[dim * k + i];
      square += 0.5 * (sum * sum);
    }
  }
  out[0] = square;
  out[1] = 0.0;
  out[2] = trace;
}

/// Columns of U and V of F = U diag(s) V^T, as rows of lanes: U_0, U_1, ..., V_0, V_1, ...
constexpr int frame_rows(int dim) { return 2 * dim * dim; }

/// For a plane state diag(F_2, 1) that is inverted: e_3 = 0 is its third shifted stretch unless both others
/// are longer than 1. Then the smallest of the three, which alone is negative, is that across the plane: s_2
/// and U_2 change their sign, and e_3 = -2.
RESILIN_INLINE void turn_across_plane(Svd2& m, Lanes& e3) {
  const Mask is_across = m.s[1] < Lanes(-1.0);
  for (int i = 0; i < 2; ++i) m.U[1][i] = select(is_across, -m.U[1][i], m.U[1][i]);
  m.s[1] = select(is_across, -m.s[1], m.s[1]);
  m.e[1] = select(is_across, m.s[1] - 1.0, m.e[1]);
  e3 = select(is_across, -2.0, 0.0);
}

/// The shifted principal stretches. Where the two smallest signed stretches cancel the rotation of F is not
/// unique: one of them is no number there, and so is all that a law makes of it.
template <int dim>
RESILIN_INLINE void stretches(const Lanes H[], Lanes e[3], Lanes frame[]) {
  const auto copy = [](const auto& columns, Lanes* rows) {
    for (int i = 0; i < dim; ++i)
      for (int k = 0; k < dim; ++k) rows[dim * i + k] = columns[i][k];
  };
  const auto fill = [&](const auto& m, Lanes least_sum, Lanes largest) {
    for (int i = 0; i < dim; ++i) e[i] = m.e[i];
    e[dim - 1] = select(least_sum > 1e-15 * largest, e[dim - 1], __builtin_nan(""));
    if (frame == nullptr) return;
    copy(m.U, frame);
    copy(m.V, frame + dim * dim);
  };
  if constexpr (dim == 2) {
    Svd2 m = svd2(H);
    turn_across_plane(m, e[2]);
    fill(m, m.s[1] + min(m.s[0], 1.0 + e[2]), max(m.s[0], 1.0));
  } else {
    const Svd3 m = svd<true>(H);
    fill(m, m.s[1] + m.s[2], m.s[0]);
  }
}

/// The variables of FibreInvariants.
template <int dim>
RESILIN_INLINE void fibre_variables(const Lanes H[], bool has_second_invariant, const double* directions,
                                    Lanes out[7]) {
  Lanes H3[9];
  embed<dim>(H, H3);
  invariants<3>(H3, has_second_invariant, out);
  for (int family = 0; family < 2; ++family) {
    Lanes a[3], Ha[3];
    load_rows(directions + family * 3 * block_size, 3, a);
    for (int i = 0; i < 3; ++i) Ha[i] = dot<3>(H3 + 3 * i, a);
    out[3 + family] = 2.0 * dot<3>(a, Ha) + dot<3>(Ha, Ha);  // |F a|^2 - 1 for |a| = 1
    out[5 + family] = step(dot<3>(a, a));
  }
}

/// Orthonormal material axes from the directions of the first and the second: the second is made
/// perpendicular to the first. Where it is missing it is z x a_1, so that axes of the plane stay in it, or
/// x x a_1 along z; where both are, the axes are x, y, z.
RESILIN_INLINE void material_axes(const double* directions, Lanes a[9]) {
  load_rows(directions, 6, a);
  const Mask has_first = dot<3>(a, a) > Lanes(0.5), has_second = dot<3>(a + 3, a + 3) > Lanes(0.5);
  for (int i = 0; i < 3; ++i) a[i] = select(has_first, a[i], i == 0 ? 1.0 : 0.0);
  const Mask is_along_z = a[2] * a[2] > Lanes(0.81);
  const Lanes across[3] = {select(is_along_z, 0.0, -a[1]), select(is_along_z, -a[2], a[0]),
                           select(is_along_z, a[1], 0.0)};
  for (int i = 0; i < 3; ++i) a[3 + i] = select(has_second, a[3 + i], across[i]);
  const Lanes overlap = dot<3>(a, a + 3);
  for (int i = 0; i < 3; ++i) a[3 + i] -= overlap * a[i];
  const Lanes factor = 1.0 / sqrt(dot<3>(a + 3, a + 3));
  for (int i = 0; i < 3; ++i) a[3 + i] = factor * a[3 + i];
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    a[6 + i] = a[i1] * a[3 + i2] - a[i2] * a[3 + i1];
  }
}

/// The variables of AxesStrain.
template <int dim>
RESILIN_INLINE void axes_strain(const Lanes H[], const double* directions, Lanes out[7]) {
  Lanes H3[9], a[9], Ha[9];
  embed<dim>(H, H3);
  invariants<3>(H3, false, out);
  material_axes(directions, a);
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 3; ++i) Ha[3 * axis + i] = dot<3>(H3 + 3 * i, a + 3 * axis);
  const auto strain = [&](int p, int q) {
    return 0.5 *
           (dot<3>(a + 3 * p, Ha + 3 * q) + dot<3>(a + 3 * q, Ha + 3 * p) + dot<3>(Ha + 3 * p, Ha + 3 * q));
  };
  out[0] = strain(0, 0);
  out[1] = strain(1, 1);
  out[3] = strain(2, 2);
  out[4] = strain(0, 1);
  out[5] = strain(1, 2);
  out[6] = strain(2, 0);
}

/// The variables of the law's kind. `directions` is used for fibres and axes alone; `frame`, which may be
/// null, is filled for stretches alone.
template <int dim>
RESILIN_INLINE void variables_of(const LawForm& law, const Lanes H[], const double* directions,
                                 Lanes out[max_variables], Lanes frame[]) {
  if (law.kind == LawKind::invariants)
    invariants<dim>(H, law.uses_second_invariant, out);
  else if (law.kind == LawKind::small_strain)
    small_strain<dim>(H, out);
  else if (law.kind == LawKind::stretches)
    stretches<dim>(H, out, frame);
  else if (law.kind == LawKind::axes)
    axes_strain<dim>(H, directions, out);
  else
    fibre_variables<dim>(H, law.uses_second_invariant, directions, out);
}

/// Stores as many of them as the law's kind has.
RESILIN_INLINE void store_variables(const LawForm& law, const Lanes variables[max_variables], double* rows) {
  store_rows(variables, 3, rows);
  if (num_variables(law.kind) > 3) store_rows(variables + 3, 4, rows + 3 * block_size);
}

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
