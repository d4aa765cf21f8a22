// Compiled once for each instruction set: see core/simd.hpp.
#include "resilin/energy/kernels/viscous_kernels.hpp"

#include "resilin/energy/kernels/node_counts.hpp"
#include "resilin/energy/kernels/point_gradients.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {
namespace {

/// The viscosities of a group of lanes.
struct Viscosities {
  Lanes eta, zeta;

  template <class AnyGroup>
  RESILIN_INLINE Viscosities(const ViscosityRows& all, const AnyGroup& at) {
    const double* rows = all.rows + at.block * all.stride + at.lane;
    eta = Lanes::load(rows);
    zeta = Lanes::load(rows + block_size);
  }
};

/// P = F S with S = 2 eta sym(F^T G) + zeta tr(F^T G) 1.
template <int dim>
RESILIN_INLINE void viscous_stress(const Viscosities& viscosity, const Lanes F[], const Lanes G[],
                                   Lanes P[]) {
  Lanes C[dim * dim], S[dim * dim], trace = 0.0;  // C = F^T G
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < dim; ++k) {
      C[dim * i + k] = F[i] * G[k];
      for (int m = 1; m < dim; ++m) C[dim * i + k] += F[dim * m + i] * G[dim * m + k];
    }
  for (int i = 0; i < dim; ++i) trace += C[(dim + 1) * i];
  for (int i = 0; i < dim; ++i)
    for (int k = i; k < dim; ++k)
      S[dim * i + k] = S[dim * k + i] = viscosity.eta * (C[dim * i + k] + C[dim * k + i]);
  for (int i = 0; i < dim; ++i) S[(dim + 1) * i] += viscosity.zeta * trace;
  for (int i = 0; i < dim; ++i)
    for (int k = 0; k < dim; ++k) P[dim * i + k] = dot<dim>(F + dim * i, S + dim * k);
}

template <int dim, int num_nodes>
void add_forces(const QuadratureTile& tile, const ViscosityRows& viscosities, const double* shape,
                const double* velocities, bool is_magnitude, const OwnedNodes& owned, double* forces) {
  for_groups<dim, num_nodes>(tile, [&](const Group<dim, num_nodes>& at) {
    const Viscosities viscosity(viscosities, at);
    Lanes u[num_nodes][dim], v[num_nodes][dim], f[num_nodes][dim];
    gather_differences<dim, num_nodes>(at, shape, u);
    gather_differences<dim, num_nodes>(at, velocities, v);
    for (auto& node_force : f)
      for (Lanes& component : node_force) component = 0.0;
    const std::size_t num_points = num_nodes == dim + 1 ? 1 : tile.num_points;
    for (std::size_t q = 0; q < num_points; ++q) {
      Lanes dxi_dX[dim * dim], F[dim * dim], G[dim * dim], P[dim * dim], T[dim][dim];  // T = w P (dxi/dX)^T
      at.inverse_jacobian(q, dxi_dX);
      gradient_at<dim, num_nodes>(at, q, u, dxi_dX, F);
      add_identity<dim>(F);
      gradient_at<dim, num_nodes>(at, q, v, dxi_dX, G);
      viscous_stress<dim>(viscosity, F, G, P);
      const Lanes w = at.weight(q);
      for (int i = 0; i < dim; ++i)
        for (int m = 0; m < dim; ++m) T[i][m] = w * dot<dim>(P + dim * i, dxi_dX + dim * m);
      add_shares<dim, num_nodes>(at, q, T, f);
    }
    scatter_shares<dim, num_nodes>(at, f, is_magnitude, owned, forces);
  });
}

/// K_ab += sum_q w (eta ((g_a.g_b) B + f_b f_a^T) + zeta f_a f_b^T), f_a = F g_a and B = F F^T, for the pairs
/// without node 0, which follows from translation invariance.
template <int dim, int num_nodes>
RESILIN_INLINE void add_points(const Group<dim, num_nodes>& at, const Viscosities& viscosity, Lanes factor,
                               const Lanes u[num_nodes][dim], std::size_t first, std::size_t count,
                               ElementHessian<dim, num_nodes>& K) {
  constexpr std::size_t most = num_nodes == dim + 1 ? 1 : points_per_pass;
  Lanes g[most][num_nodes][dim], f[most][num_nodes][dim], B[most][dim * dim], w_eta[most], w_zeta[most];
  for (std::size_t q = 0; q < count; ++q) {
    Lanes dxi_dX[dim * dim], F[dim * dim];
    at.inverse_jacobian(first + q, dxi_dX);
    gradient_at<dim, num_nodes>(at, first + q, u, dxi_dX, F);
    add_identity<dim>(F);
    const Lanes w = factor * at.weight(first + q);
    w_eta[q] = w * viscosity.eta;
    w_zeta[q] = w * viscosity.zeta;
    for (int a = 1; a < num_nodes; ++a) {
      at.gradient(first + q, a, dxi_dX, g[q][a]);
      for (int i = 0; i < dim; ++i) f[q][a][i] = dot<dim>(F + dim * i, g[q][a]);
    }
    for (int i = 0; i < dim; ++i)
      for (int k = i; k < dim; ++k)
        B[q][dim * i + k] = B[q][dim * k + i] = w_eta[q] * dot<dim>(F + dim * i, F + dim * k);
  }
  for (int b = 1; b < num_nodes; ++b) {
    Lanes shear[most][dim], bulk[most][dim];
    for (std::size_t q = 0; q < count; ++q)
      for (int i = 0; i < dim; ++i) {
        shear[q][i] = w_eta[q] * f[q][b][i];
        bulk[q][i] = w_zeta[q] * f[q][b][i];
      }
    for (int a = 1; a <= b; ++a) {
      Lanes* block = K[pair_index(num_nodes, a, b)];
      Lanes sum[dim * dim];
      for (int i = 0; i < dim * dim; ++i) sum[i] = block[i];
      for (std::size_t q = 0; q < count; ++q) {
        const Lanes gg = dot<dim>(g[q][a], g[q][b]);
        for (int i = 0; i < dim; ++i)
          for (int k = 0; k < dim; ++k)
            sum[dim * i + k] += gg * B[q][dim * i + k] + shear[q][i] * f[q][a][k] + f[q][a][i] * bulk[q][k];
      }
      for (int i = 0; i < dim * dim; ++i) block[i] = sum[i];
    }
  }
}

template <int dim, int num_nodes>
RESILIN_INLINE void add_element_matrix(const Group<dim, num_nodes>& at, const ViscosityRows& viscosities,
                                       const double* shape, double factor,
                                       ElementHessian<dim, num_nodes>& K) {
  const Viscosities viscosity(viscosities, at);
  Lanes u[num_nodes][dim];
  gather_differences<dim, num_nodes>(at, shape, u);
  if constexpr (num_nodes == dim + 1) {
    add_points<dim, num_nodes>(at, viscosity, factor, u, 0, 1, K);
  } else {
    for (std::size_t first = 0; first < at.tile.num_points; first += points_per_pass) {
      const std::size_t left = at.tile.num_points - first;
      add_points<dim, num_nodes>(at, viscosity, factor, u, first,
                                 left < points_per_pass ? left : points_per_pass, K);
    }
  }
  for (int a = 1; a < num_nodes; ++a) make_symmetric<dim>(K[pair_index(num_nodes, a, a)]);
  complete_node_zero<dim, num_nodes>(K);
}

template <int dim, int num_nodes>
void add_matrices(const QuadratureTile& tile, const ViscosityRows& viscosities, const double* shape,
                  double factor, double* out_rows) {
  add_to_matrices<dim, num_nodes>(tile, out_rows,
                                  [&](const Group<dim, num_nodes>& at, ElementHessian<dim, num_nodes>& K) {
                                    add_element_matrix<dim, num_nodes>(at, viscosities, shape, factor, K);
                                  });
}

template <int dim, int num_nodes>
constexpr ViscousKernels kernels = {add_forces<dim, num_nodes>, add_matrices<dim, num_nodes>};

template <int dim, int... counts>
const ViscousKernels& find(int num_nodes, std::integer_sequence<int, counts...>) {
  const ViscousKernels* found = &kernels<dim, dim + 1>;
  ((found = num_nodes == counts ? &kernels<dim, counts> : found), ...);
  return *found;
}

const ViscousKernels& kernels_of_cells(int dim, int num_nodes) {
  return dim == 2 ? find<2>(num_nodes, NodeCounts<2>::type{}) : find<3>(num_nodes, NodeCounts<3>::type{});
}

}  // namespace

}  // namespace resilin::RESILIN_SIMD_NAMESPACE

namespace resilin {

template <InstructionSet>
const ViscousKernels& compiled_viscous_kernels(int dim, int num_nodes) {
  return RESILIN_SIMD_NAMESPACE::kernels_of_cells(dim, num_nodes);
}
template const ViscousKernels& compiled_viscous_kernels<InstructionSet::RESILIN_SIMD_NAMESPACE>(int, int);

}  // namespace resilin
