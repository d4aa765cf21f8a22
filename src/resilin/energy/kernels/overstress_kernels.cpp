// Compiled once for each instruction set: see core/simd.hpp.
#include "resilin/energy/kernels/overstress_kernels.hpp"

#include "resilin/core/simd_math.hpp"
#include "resilin/core/simd_svd.hpp"
#include "resilin/energy/kernels/node_counts.hpp"
#include "resilin/energy/kernels/point_gradients.hpp"
#include "resilin/energy/kernels/ring_point.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {
namespace {

/// H at a point: its part in the plane or in space, and zz where that is out of the plane; and q.
template <int dim>
struct History {
  Lanes H[dim * dim], zz, q;

  template <class AnyGroup>
  RESILIN_INLINE History(const OverstressRows& all, const AnyGroup& at, std::size_t point) {
    constexpr int places[symmetric_size][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
    const double* rows =
        all.H + (at.block * at.tile.num_points + point) * (all.size() * block_size) + at.lane;
    for (int k = 0; k < symmetric_size; ++k) {
      const int i = places[k][0], j = places[k][1];
      if (i < dim && j < dim) H[dim * i + j] = H[dim * j + i] = Lanes::load(rows + k * block_size);
    }
    zz = dim == 2 ? Lanes::load(rows + 2 * block_size) : Lanes(0.0);
    q = all.has_pressure ? Lanes::load(rows + symmetric_size * block_size) : Lanes(0.0);
  }
};

/// C = A B
template <int dim>
RESILIN_INLINE void multiply(const Lanes A[], const Lanes B[], Lanes C[]) {
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < dim; ++k) {
      C[dim * i + k] = A[dim * i] * B[k];
      for (int m = 1; m < dim; ++m) C[dim * i + k] += A[dim * i + m] * B[dim * m + k];
    }
}

template <int dim>
RESILIN_INLINE void cofactors(const Lanes F[], Lanes C[]) {
  if constexpr (dim == 2) {
    C[0] = F[3];
    C[1] = -F[2];
    C[2] = -F[1];
    C[3] = F[0];
  } else {
    cofactor(F, C);
  }
}

/// J^(-2/3)
RESILIN_INLINE Lanes isochoric_scale(Lanes J) { return exp((-2.0 / 3.0) * log1p(J - 1.0)); }

/// Whether the density depends on J.
RESILIN_INLINE bool depends_on_volume(const OverstressRows& all) {
  return all.is_isochoric || all.has_pressure;
}

/// Factors of the density s t / 2 + q ln J and of its slopes.
template <int dim>
struct Overstress {
  Lanes n[dim * dim];  ///< F^-T; zero where the density does not depend on J
  Lanes Q[dim * dim];  ///< F H
  Lanes J, s, t;       ///< det F; J^(-2/3) or 1; C:H
  Lanes third;         ///< t/3; 0 for s = 1

  RESILIN_INLINE Overstress(const Lanes F[], const History<dim>& history, const OverstressRows& all) {
    multiply<dim>(F, history.H, Q);
    t = dot<dim * dim>(F, Q) + history.zz;
    J = s = 1.0;
    third = 0.0;
    if (!depends_on_volume(all)) {
      for (Lanes& entry : n) entry = 0.0;
      return;
    }
    cofactors<dim>(F, n);
    J = dot<dim>(F, n);
    const Lanes inverse = 1.0 / J;
    for (Lanes& entry : n) entry *= inverse;
    if (!all.is_isochoric) return;
    s = isochoric_scale(J);
    third = (1.0 / 3.0) * t;
  }

  /// Factor of F^-T in P = s F H - slope F^-T.
  RESILIN_INLINE Lanes slope(const History<dim>& history) const { return s * third - history.q; }
};

/// F at a point from differences of displacements.
template <int dim, int num_nodes>
RESILIN_INLINE void shape_at(const Group<dim, num_nodes>& at, std::size_t point,
                             const Lanes u[num_nodes][dim], const Lanes dxi_dX[], Lanes F[]) {
  gradient_at<dim, num_nodes>(at, point, u, dxi_dX, F);
  add_identity<dim>(F);
}

template <int num_nodes, int dim>
RESILIN_INLINE std::size_t num_points(const QuadratureTile& tile) {
  return num_nodes == dim + 1 ? 1 : tile.num_points;
}

/// Density at F + D less that at F.
template <int dim>
RESILIN_INLINE Lanes change_of_density(const Lanes F[], const Lanes D[], const History<dim>& history,
                                       const OverstressRows& all) {
  constexpr int n = dim * dim;
  Lanes mean[n], cof[n], twice_mean_H[n];
  for (int i = 0; i < n; ++i) mean[i] = F[i] + 0.5 * D[i];
  // det(M + D/2) - det(M - D/2) = cof(M):D + det(D)/4 in 3D, M being the mean
  cofactors<dim>(mean, cof);
  Lanes change_of_J = dot<n>(cof, D);
  if constexpr (dim == 3) {
    Lanes cof_D[n];
    cofactors<dim>(D, cof_D);
    change_of_J += 0.25 * dot<dim>(D, cof_D);
  }
  const Overstress<dim> before(F, history, all);
  Lanes change_of_s = 0.0, change_of_log = 0.0;
  if (depends_on_volume(all)) change_of_log = log1p(change_of_J / before.J);
  if (all.is_isochoric) change_of_s = before.s * expm1((-2.0 / 3.0) * change_of_log);
  // C:H at the end less that at the start is D:((F + F + D) H)
  multiply<dim>(mean, history.H, twice_mean_H);
  const Lanes change_of_t = 2.0 * dot<n>(D, twice_mean_H);
  return 0.5 * ((before.s + change_of_s) * change_of_t + change_of_s * before.t) + history.q * change_of_log;
}

/// Absolute values of the parts of the density.
template <int dim>
RESILIN_INLINE Lanes magnitude_of_density(const Lanes F[], const History<dim>& history,
                                          const OverstressRows& all) {
  Lanes sum = abs(history.zz);
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < dim; ++k) {
      Lanes C = F[i] * F[k];
      for (int m = 1; m < dim; ++m) C += F[dim * m + i] * F[dim * m + k];
      sum += abs(C * history.H[dim * i + k]);
    }
  return 0.5 * Overstress<dim>(F, history, all).s * sum + abs(history.q);
}

template <int dim, int num_nodes>
void add_differences(const QuadratureTile& tile, const OverstressRows& all, const double* from,
                     const double* to, EnergySum& total) {
  constexpr int n = dim * dim;
  for_groups<dim, num_nodes>(tile, [&](const Group<dim, num_nodes>& at) {
    Lanes u[num_nodes][dim], change[num_nodes][dim], part = 0.0;
    gather_differences<dim, num_nodes>(at, from, u);
    gather_differences<dim, num_nodes>(at, to, change);
    for (int a = 1; a < num_nodes; ++a)
      for (int i = 0; i < dim; ++i) change[a][i] -= u[a][i];
    for (std::size_t q = 0; q < num_points<num_nodes, dim>(tile); ++q) {
      const History<dim> history(all, at, q);
      Lanes dxi_dX[n], F[n], D[n];
      at.inverse_jacobian(q, dxi_dX);
      shape_at<dim, num_nodes>(at, q, u, dxi_dX, F);
      gradient_at<dim, num_nodes>(at, q, change, dxi_dX, D);
      part += at.weight(q) * change_of_density<dim>(F, D, history, all);
    }
    add_to_sum(part, at.lane, total);
  });
}

template <int dim, int num_nodes>
void add_magnitudes(const QuadratureTile& tile, const OverstressRows& all, const double* displacements,
                    EnergySum& total) {
  constexpr int n = dim * dim;
  for_groups<dim, num_nodes>(tile, [&](const Group<dim, num_nodes>& at) {
    Lanes u[num_nodes][dim], part = 0.0;
    gather_differences<dim, num_nodes>(at, displacements, u);
    for (std::size_t q = 0; q < num_points<num_nodes, dim>(tile); ++q) {
      const History<dim> history(all, at, q);
      Lanes dxi_dX[n], F[n];
      at.inverse_jacobian(q, dxi_dX);
      shape_at<dim, num_nodes>(at, q, u, dxi_dX, F);
      part += at.weight(q) * magnitude_of_density<dim>(F, history, all);
    }
    add_to_sum(part, at.lane, total);
  });
}

/// P = s (F H - t/3 F^-T) + q F^-T
template <int dim, int num_nodes>
void add_forces(const QuadratureTile& tile, const OverstressRows& all, const double* displacements,
                bool is_magnitude, const OwnedNodes& owned, double* forces) {
  constexpr int n = dim * dim;
  for_groups<dim, num_nodes>(tile, [&](const Group<dim, num_nodes>& at) {
    Lanes u[num_nodes][dim], f[num_nodes][dim];
    gather_differences<dim, num_nodes>(at, displacements, u);
    for (auto& node_force : f)
      for (Lanes& component : node_force) component = 0.0;
    for (std::size_t q = 0; q < num_points<num_nodes, dim>(tile); ++q) {
      const History<dim> history(all, at, q);
      Lanes dxi_dX[n], F[n], P[n], T[dim][dim];  // T = w P (dxi/dX)^T
      at.inverse_jacobian(q, dxi_dX);
      shape_at<dim, num_nodes>(at, q, u, dxi_dX, F);
      const Overstress<dim> here(F, history, all);
      const Lanes slope = here.slope(history), w = at.weight(q);
      for (int i = 0; i < n; ++i) P[i] = here.s * here.Q[i] - slope * here.n[i];
      for (int i = 0; i < dim; ++i)
        for (int m = 0; m < dim; ++m) T[i][m] = w * dot<dim>(P + dim * i, dxi_dX + dim * m);
      add_shares<dim, num_nodes>(at, q, T, f);
    }
    scatter_shares<dim, num_nodes>(at, f, is_magnitude, owned, forces);
  });
}

/// Takes off `removed` times the negative part of the eigenvalues of H.
template <int dim>
RESILIN_INLINE void project(double removed, Lanes H[]) {
  Lanes A[dim][dim], V[dim][dim];
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < dim; ++k) A[i][k] = H[dim * i + k];
  diagonalize<dim>(A, V);
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < dim; ++k) {
      Lanes off = 0.0;
      for (int m = 0; m < dim; ++m) off += min(A[m][m], Lanes(0.0)) * (V[i][m] * V[k][m]);
      H[dim * i + k] -= removed * off;
    }
}

template <int dim, int num_nodes>
RESILIN_INLINE void add_element_matrix(const Group<dim, num_nodes>& at, const OverstressRows& all,
                                       const double* displacements, double removed,
                                       ElementHessian<dim, num_nodes>& K) {
  constexpr int n = dim * dim;
  Lanes u[num_nodes][dim];
  gather_differences<dim, num_nodes>(at, displacements, u);
  for (std::size_t q = 0; q < num_points<num_nodes, dim>(at.tile); ++q) {
    History<dim> history(all, at, q);
    Lanes dxi_dX[n], F[n], g[num_nodes][dim], Hg[num_nodes][dim];
    at.inverse_jacobian(q, dxi_dX);
    shape_at<dim, num_nodes>(at, q, u, dxi_dX, F);
    const Overstress<dim> here(F, history, all);
    const Lanes scale = at.weight(q) * here.s;
    if (removed > 0) project<dim>(removed, history.H);
    for (int a = 1; a < num_nodes; ++a) {
      at.gradient(q, a, dxi_dX, g[a]);
      for (int i = 0; i < dim; ++i) Hg[a][i] = scale * dot<dim>(history.H + dim * i, g[a]);
    }
    for (int b = 1; b < num_nodes; ++b)
      for (int a = 1; a <= b; ++a) {
        const Lanes common = dot<dim>(g[a], Hg[b]);
        for (int i = 0; i < dim; ++i) K[pair_index(num_nodes, a, b)][(dim + 1) * i] += common;
      }
    if (removed > 0 || !depends_on_volume(all)) continue;
    Lanes normal[num_nodes][dim], pull[num_nodes][dim];
    for (int a = 1; a < num_nodes; ++a)
      for (int i = 0; i < dim; ++i) {
        normal[a][i] = dot<dim>(here.n + dim * i, g[a]);
        pull[a][i] = dot<dim>(here.Q + dim * i, g[a]);
      }
    const Lanes cross = at.weight(q) * here.slope(history);
    const Lanes mixed = all.is_isochoric ? (2.0 / 3.0) * scale : Lanes(0.0);
    for (int b = 1; b < num_nodes; ++b)
      for (int a = 1; a <= b; ++a) {
        Lanes* block = K[pair_index(num_nodes, a, b)];
        for (int i = 0; i < dim; ++i)
          for (int k = 0; k < dim; ++k)
            block[dim * i + k] +=
                cross * normal[b][i] * normal[a][k] -
                mixed * (normal[a][i] * (pull[b][k] - here.third * normal[b][k]) + pull[a][i] * normal[b][k]);
      }
  }
  for (int a = 1; a < num_nodes; ++a) make_symmetric<dim>(K[pair_index(num_nodes, a, a)]);
  complete_node_zero<dim, num_nodes>(K);
}

template <int dim, int num_nodes>
void add_matrices(const QuadratureTile& tile, const OverstressRows& all, const double* displacements,
                  double removed, double* out_rows) {
  add_to_matrices<dim, num_nodes>(tile, out_rows,
                                  [&](const Group<dim, num_nodes>& at, ElementHessian<dim, num_nodes>& K) {
                                    add_element_matrix<dim, num_nodes>(at, all, displacements, removed, K);
                                  });
}

// ---- axisymmetric solids: states in three dimensions, nodes with two numbers

/// Vectors of the nodes.
template <int num_nodes>
RESILIN_INLINE void gather_all(const Group<2, num_nodes>& at, const double* numbers, Lanes u[num_nodes][2]) {
  for (int a = 0; a < num_nodes; ++a) gather<2>(numbers, at.nodes(a), u[a]);
}

template <int num_nodes>
void add_ring_differences(const QuadratureTile& tile, const OverstressRows& all, const double* from,
                          const double* to, EnergySum& total) {
  for_groups<2, num_nodes>(tile, [&](const Group<2, num_nodes>& at) {
    Lanes u[num_nodes][2], change[num_nodes][2], part = 0.0;
    gather_all<num_nodes>(at, from, u);
    gather_all<num_nodes>(at, to, change);
    for (int a = 0; a < num_nodes; ++a)
      for (int i = 0; i < 2; ++i) change[a][i] -= u[a][i];
    for (std::size_t q = 0; q < tile.num_points; ++q) {
      const RingPoint<num_nodes> point(at, q);
      Lanes F[9], D[9];
      point.gradient(u, F);
      add_identity<3>(F);
      point.gradient(change, D);
      part += at.weight(q) * change_of_density<3>(F, D, History<3>(all, at, q), all);
    }
    add_to_sum(part, at.lane, total);
  });
}

template <int num_nodes>
void add_ring_magnitudes(const QuadratureTile& tile, const OverstressRows& all, const double* displacements,
                         EnergySum& total) {
  for_groups<2, num_nodes>(tile, [&](const Group<2, num_nodes>& at) {
    Lanes u[num_nodes][2], part = 0.0;
    gather_all<num_nodes>(at, displacements, u);
    for (std::size_t q = 0; q < tile.num_points; ++q) {
      Lanes F[9];
      RingPoint<num_nodes>(at, q).gradient(u, F);
      add_identity<3>(F);
      part += at.weight(q) * magnitude_of_density<3>(F, History<3>(all, at, q), all);
    }
    add_to_sum(part, at.lane, total);
  });
}

template <int num_nodes>
void add_ring_forces(const QuadratureTile& tile, const OverstressRows& all, const double* displacements,
                     bool is_magnitude, const OwnedNodes& owned, double* forces) {
  for_groups<2, num_nodes>(tile, [&](const Group<2, num_nodes>& at) {
    Lanes u[num_nodes][2], f[num_nodes][2];
    gather_all<num_nodes>(at, displacements, u);
    for (auto& node_force : f)
      for (Lanes& component : node_force) component = 0.0;
    for (std::size_t q = 0; q < tile.num_points; ++q) {
      const RingPoint<num_nodes> point(at, q);
      Lanes F[9], P[9];
      point.gradient(u, F);
      add_identity<3>(F);
      const History<3> history(all, at, q);
      const Overstress<3> here(F, history, all);
      const Lanes slope = here.slope(history);
      for (int i = 0; i < 9; ++i) P[i] = here.s * here.Q[i] - slope * here.n[i];
      point.add_forces(at.weight(q), P, f);
    }
    if (is_magnitude)
      for (auto& node_force : f)
        for (Lanes& component : node_force) component = abs(component);
    for (int a = 0; a < num_nodes; ++a)
      scatter_add<2>(f[a], at.nodes(a), [&](std::int32_t node) { return owns(owned, node); }, forces);
  });
}

/// As `add_element_matrix`, with the hoop entry h of each node beside g.
template <int num_nodes>
RESILIN_INLINE void add_ring_matrix(const Group<2, num_nodes>& at, const OverstressRows& all,
                                    const double* displacements, double removed,
                                    ElementHessian<2, num_nodes>& K) {
  Lanes u[num_nodes][2];
  gather_all<num_nodes>(at, displacements, u);
  for (std::size_t q = 0; q < at.tile.num_points; ++q) {
    const RingPoint<num_nodes> point(at, q);
    History<3> history(all, at, q);
    Lanes F[9];
    point.gradient(u, F);
    add_identity<3>(F);
    const Overstress<3> here(F, history, all);
    const Lanes scale = at.weight(q) * here.s;
    if (removed > 0) project<3>(removed, history.H);
    const Lanes* H = history.H;
    for (int b = 0; b < num_nodes; ++b) {
      const Lanes Hg[2] = {scale * (H[0] * point.g[b][0] + H[1] * point.g[b][1]),
                           scale * (H[3] * point.g[b][0] + H[4] * point.g[b][1])};
      for (int a = 0; a <= b; ++a) {
        const Lanes common = dot<2>(point.g[a], Hg);
        Lanes* block = K[pair_index(num_nodes, a, b)];
        block[0] += common + scale * (H[8] * point.h[a] * point.h[b]);
        block[3] += common;
      }
    }
    if (removed > 0 || !depends_on_volume(all)) continue;
    Lanes normal[num_nodes][2], whole[num_nodes][2], pull[num_nodes][2];
    for (int a = 0; a < num_nodes; ++a) {
      point.contract(here.n, a, whole[a]);
      point.contract(here.Q, a, pull[a]);
      normal[a][0] = whole[a][0] - here.n[8] * point.h[a];
      normal[a][1] = whole[a][1];
    }
    const Lanes cross = at.weight(q) * here.slope(history), hoop = here.n[8] * here.n[8];
    const Lanes mixed = all.is_isochoric ? (2.0 / 3.0) * scale : Lanes(0.0);
    for (int b = 0; b < num_nodes; ++b)
      for (int a = 0; a <= b; ++a) {
        Lanes* block = K[pair_index(num_nodes, a, b)];
        for (int i = 0; i < 2; ++i)
          for (int k = 0; k < 2; ++k)
            block[2 * i + k] +=
                cross * normal[b][i] * normal[a][k] -
                mixed * (whole[a][i] * (pull[b][k] - here.third * whole[b][k]) + pull[a][i] * whole[b][k]);
        block[0] += cross * hoop * point.h[a] * point.h[b];
      }
  }
  for (int a = 0; a < num_nodes; ++a) make_symmetric<2>(K[pair_index(num_nodes, a, a)]);
}

template <int num_nodes>
void add_ring_matrices(const QuadratureTile& tile, const OverstressRows& all, const double* displacements,
                       double removed, double* out_rows) {
  add_to_matrices<2, num_nodes>(tile, out_rows,
                                [&](const Group<2, num_nodes>& at, ElementHessian<2, num_nodes>& K) {
                                  add_ring_matrix<num_nodes>(at, all, displacements, removed, K);
                                });
}

template <int num_nodes>
constexpr OverstressKernels ring_kernels = {add_ring_differences<num_nodes>, add_ring_magnitudes<num_nodes>,
                                            add_ring_forces<num_nodes>, add_ring_matrices<num_nodes>};

const OverstressKernels& kernels_of_rings(int num_nodes) {
  return num_nodes == 3 ? ring_kernels<3> : num_nodes == 4 ? ring_kernels<4> : ring_kernels<6>;
}

template <int dim, int num_nodes>
constexpr OverstressKernels kernels = {add_differences<dim, num_nodes>, add_magnitudes<dim, num_nodes>,
                                       add_forces<dim, num_nodes>, add_matrices<dim, num_nodes>};

template <int dim, int... counts>
const OverstressKernels& find(int num_nodes, std::integer_sequence<int, counts...>) {
  const OverstressKernels* found = &kernels<dim, dim + 1>;
  ((found = num_nodes == counts ? &kernels<dim, counts> : found), ...);
  return *found;
}

const OverstressKernels& kernels_of_cells(int dim, int num_nodes) {
  return dim == 2 ? find<2>(num_nodes, NodeCounts<2>::type{}) : find<3>(num_nodes, NodeCounts<3>::type{});
}

}  // namespace

}  // namespace resilin::RESILIN_SIMD_NAMESPACE

namespace resilin {

template <InstructionSet>
const OverstressKernels& compiled_overstress_kernels(int dim, int num_nodes) {
  return RESILIN_SIMD_NAMESPACE::kernels_of_cells(dim, num_nodes);
}
template const OverstressKernels& compiled_overstress_kernels<InstructionSet::RESILIN_SIMD_NAMESPACE>(int,
                                                                                                      int);

template <InstructionSet>
const OverstressKernels& compiled_axisymmetric_overstress_kernels(int num_nodes) {
  return RESILIN_SIMD_NAMESPACE::kernels_of_rings(num_nodes);
}
template const OverstressKernels&
compiled_axisymmetric_overstress_kernels<InstructionSet::RESILIN_SIMD_NAMESPACE>(int);

}  // namespace resilin
