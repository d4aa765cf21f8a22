// Compiled once for each instruction set: see core/simd.hpp.
#include "resilin/energy/kernels/quadrature_kernels.hpp"

#include "resilin/energy/kernels/axisymmetric_kernels.hpp"
#include "resilin/energy/kernels/node_counts.hpp"
#include "resilin/energy/kernels/quadrature_group.hpp"
#include "resilin/energy/kernels/ring_point.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {
namespace {

template <int dim, int num_nodes>
void gradients(const QuadratureTile& tile, const double* displacements, double* H_rows) {
  for_groups<dim, num_nodes>(tile, [&](const Group<dim, num_nodes>& at) {
    Lanes u0[dim], u[num_nodes][dim];
    gather<dim>(displacements, at.nodes(0), u0);
    for (int a = 1; a < num_nodes; ++a) {
      gather<dim>(displacements, at.nodes(a), u[a]);
      for (int i = 0; i < dim; ++i) u[a][i] -= u0[i];
    }
    for (std::size_t q = 0; q < tile.num_points; ++q) {
      Lanes du_dxi[dim * dim], dxi_dX[dim * dim], H[dim * dim];
      for (Lanes& entry : du_dxi) entry = 0.0;
      for (int a = 1; a < num_nodes; ++a) {
        const double* dN_dxi = at.reference_gradient(q, a);
        for (int i = 0; i < dim; ++i)
          for (int m = 0; m < dim; ++m) du_dxi[dim * i + m] += dN_dxi[m] * u[a][i];
      }
      at.inverse_jacobian(q, dxi_dX);
      for (int i = 0; i < dim; ++i)
        for (int k = 0; k < dim; ++k) {
          H[dim * i + k] = du_dxi[dim * i] * dxi_dX[k];
          for (int m = 1; m < dim; ++m) H[dim * i + k] += du_dxi[dim * i + m] * dxi_dX[dim * m + k];
        }
      store_rows(H, dim * dim, H_rows + at.row(q, dim * dim));
    }
  });
}

template <int dim, int num_nodes>
void add_energies(const QuadratureTile& tile, const double* psi, const double* psi_from, EnergySum& total) {
  Mask is_outside = Lanes(0.0) > Lanes(1.0);
  for_groups<dim, num_nodes>(tile, [&](const Group<dim, num_nodes>& at) {
    Lanes part = 0.0;
    for (std::size_t q = 0; q < tile.num_points; ++q) {
      Lanes value = Lanes::load(psi + at.row(q, 1));
      is_outside |= ~(value < Lanes(__builtin_inf()));
      if (psi_from != nullptr) value -= Lanes::load(psi_from + at.row(q, 1));
      part += at.weight(q) * value;
    }
    add_to_sum(part, at.lane, total);
  });
  total.is_outside = total.is_outside || any(is_outside);
}

template <int dim, int num_nodes>
void add_forces(const QuadratureTile& tile, const double* P_rows, bool is_magnitude, const OwnedNodes& owned,
                double* forces) {
  for_groups<dim, num_nodes>(tile, [&](const Group<dim, num_nodes>& at) {
    Lanes f[num_nodes][dim];
    for (auto& node_force : f)
      for (Lanes& component : node_force) component = 0.0;
    for (std::size_t q = 0; q < tile.num_points; ++q) {
      Lanes P[dim * dim], dxi_dX[dim * dim], T[dim][dim];  // T = w P (dxi/dX)^T
      load_rows(P_rows + at.row(q, dim * dim), dim * dim, P);
      at.inverse_jacobian(q, dxi_dX);
      const Lanes w = at.weight(q);
      for (int i = 0; i < dim; ++i)
        for (int m = 0; m < dim; ++m) T[i][m] = w * dot<dim>(P + dim * i, dxi_dX + dim * m);
      for (int a = 1; a < num_nodes; ++a) {
        const double* dN_dxi = at.reference_gradient(q, a);
        for (int i = 0; i < dim; ++i)
          for (int m = 0; m < dim; ++m) f[a][i] += dN_dxi[m] * T[i][m];
      }
    }
    for (int i = 0; i < dim; ++i)
      for (int a = 1; a < num_nodes; ++a) f[0][i] -= f[a][i];
    if (is_magnitude)
      for (auto& node_force : f)
        for (Lanes& component : node_force) component = abs(component);
    for (int a = 0; a < num_nodes; ++a)
      scatter_add<dim>(f[a], at.nodes(a), [&](std::int32_t node) { return owns(owned, node); }, forces);
  });
}

/// Products of the tangents of some points of one group for one node b: y_ik,j = w sum_l A_ik,jl g_b,l.
template <int dim>
using TangentTimesGradient = Lanes[dim * dim][dim];

/// K_ab = sum_q w g_a^T A g_b for the pairs without node 0, which follows from translation invariance.
template <int dim, int num_nodes>
RESILIN_INLINE void add_points(const Group<dim, num_nodes>& at, const double* A_rows, std::size_t first,
                               std::size_t count, bool is_first, ElementHessian<dim, num_nodes>& K) {
  constexpr int n = dim * dim;
  Lanes g[points_per_pass][num_nodes][dim];
  for (std::size_t q = 0; q < count; ++q) {
    Lanes dxi_dX[n];
    at.inverse_jacobian(first + q, dxi_dX);
    for (int a = 1; a < num_nodes; ++a) at.gradient(first + q, a, dxi_dX, g[q][a]);
  }
  for (int b = 1; b < num_nodes; ++b) {
    TangentTimesGradient<dim> y[points_per_pass];
    for (std::size_t q = 0; q < count; ++q) {
      const double* A = A_rows + at.row(first + q, n * n);
      const Lanes w = at.weight(first + q);
      Lanes wg[dim];
      for (int l = 0; l < dim; ++l) wg[l] = w * g[q][b][l];
      for (int row = 0; row < n; ++row)
        for (int j = 0; j < dim; ++j) {
          Lanes sum = Lanes::load(A + (n * row + dim * j) * block_size) * wg[0];
          for (int l = 1; l < dim; ++l) sum += Lanes::load(A + (n * row + dim * j + l) * block_size) * wg[l];
          y[q][row][j] = sum;
        }
    }
    for (int a = 1; a <= b; ++a) {
      Lanes* block = K[pair_index(num_nodes, a, b)];
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) {
          Lanes sum = is_first ? Lanes(0.0) : block[dim * i + j];
          for (std::size_t q = 0; q < count; ++q)
            for (int k = 0; k < dim; ++k) sum += g[q][a][k] * y[q][dim * i + k][j];
          block[dim * i + j] = sum;
        }
    }
  }
}

template <int dim, int num_nodes>
RESILIN_INLINE void element_hessian(const Group<dim, num_nodes>& at, const double* A_rows,
                                    ElementHessian<dim, num_nodes>& K) {
  for (std::size_t first = 0; first < at.tile.num_points; first += points_per_pass) {
    const std::size_t left = at.tile.num_points - first;
    add_points<dim, num_nodes>(at, A_rows, first, left < points_per_pass ? left : points_per_pass, first == 0,
                               K);
  }
  for (int a = 1; a < num_nodes; ++a) make_symmetric<dim>(K[pair_index(num_nodes, a, a)]);
  complete_node_zero<dim, num_nodes>(K);
}

template <int dim, int num_nodes>
void hessians(const QuadratureTile& tile, const double* A_rows, double* out_rows) {
  constexpr int rows = num_pairs(num_nodes) * dim * dim;
  for_groups<dim, num_nodes>(tile, [&](const Group<dim, num_nodes>& at) {
    double* out = out_rows + at.in_tile * static_cast<std::size_t>(rows * block_size) + at.lane;
    if constexpr (Lanes::width == block_size) {  // a row of lanes is a row of the block: no copy
      element_hessian<dim, num_nodes>(at, A_rows, *reinterpret_cast<ElementHessian<dim, num_nodes>*>(out));
    } else {
      ElementHessian<dim, num_nodes> K;
      element_hessian<dim, num_nodes>(at, A_rows, K);
      store_rows(K[0], rows, out);
    }
  });
}

template <int dim, int num_nodes>
void mean(const QuadratureTile& tile, const double* rows, double* means) {
  for_groups<dim, num_nodes>(tile, [&](const Group<dim, num_nodes>& at) {
    Lanes sum = 0.0, volume = 0.0;
    for (std::size_t q = 0; q < tile.num_points; ++q) {
      const Lanes w = at.weight(q);
      sum += w * Lanes::load(rows + at.row(q, 1));
      volume += w;
    }
    // Lanes that are filled up have no volume, and all their numbers are zero.
    const Lanes safe = select(volume > Lanes(0.0), volume, Lanes(1.0));
    (sum / safe).store(means + at.in_tile * block_size + at.lane);
  });
}

template <int dim>
RESILIN_INLINE void cofactor_of_F(const Lanes H[], Lanes C[]) {
  if constexpr (dim == 2) {
    C[0] = 1.0 + H[3];
    C[1] = -H[2];
    C[2] = -H[1];
    C[3] = 1.0 + H[0];
  } else {
    Lanes F[9];
    for (int i = 0; i < 9; ++i) F[i] = H[i];
    add_identity<3>(F);
    cofactor(F, C);
  }
}

template <int dim, int num_nodes>
void add_mean_volume(const QuadratureTile& tile, const double* H_rows, const double* c_rows, double* K) {
  constexpr int rows = num_pairs(num_nodes) * dim * dim;
  for_groups<dim, num_nodes>(tile, [&](const Group<dim, num_nodes>& at) {
    Lanes b[num_nodes][dim], volume = 0.0;
    for (auto& node : b)
      for (Lanes& component : node) component = 0.0;
    for (std::size_t q = 0; q < tile.num_points; ++q) {
      Lanes H[dim * dim], C[dim * dim], dxi_dX[dim * dim], T[dim][dim];
      load_rows(H_rows + at.row(q, dim * dim), dim * dim, H);
      cofactor_of_F<dim>(H, C);
      at.inverse_jacobian(q, dxi_dX);
      const Lanes w = at.weight(q);
      volume += w;
      for (int i = 0; i < dim; ++i)
        for (int m = 0; m < dim; ++m) T[i][m] = w * dot<dim>(C + dim * i, dxi_dX + dim * m);
      for (int a = 1; a < num_nodes; ++a) {
        const double* dN_dxi = at.reference_gradient(q, a);
        for (int i = 0; i < dim; ++i)
          for (int m = 0; m < dim; ++m) b[a][i] += dN_dxi[m] * T[i][m];
      }
    }
    for (int i = 0; i < dim; ++i)
      for (int a = 1; a < num_nodes; ++a) b[0][i] -= b[a][i];
    const Lanes safe = select(volume > Lanes(0.0), volume, Lanes(1.0));
    const Lanes factor = Lanes::load(c_rows + at.in_tile * block_size + at.lane) / safe;
    double* out = K + at.in_tile * static_cast<std::size_t>(rows * block_size) + at.lane;
    for (int a = 0, pair = 0; a < num_nodes; ++a) {
      Lanes scaled[dim];
      for (int i = 0; i < dim; ++i) scaled[i] = factor * b[a][i];
      for (int c = a; c < num_nodes; ++c, ++pair)
        for (int i = 0; i < dim; ++i)
          for (int j = 0; j < dim; ++j) {
            double* entry = out + (pair * dim * dim + dim * i + j) * block_size;
            (Lanes::load(entry) + scaled[i] * b[c][j]).store(entry);
          }
    }
  });
}

/// The node whose row holds the block of nodes a and b of a cell.
RESILIN_INLINE std::int32_t row_node(const std::int32_t* nodes, int a, int b, unsigned lanes_transposed,
                                     int lane) {
  return nodes[((lanes_transposed >> lane & 1U) != 0 ? b : a) * block_size + lane];
}

/// In line: a call whose only effect is on the cache is none to the compiler.
template <int dim, int num_nodes, class Place>
RESILIN_INLINE void prefetch_slots(const QuadratureTile& tile, const std::uint32_t* row_begin,
                                   const Place* places, const double* values) {
  constexpr std::size_t pairs = num_pairs(num_nodes), entries = dim * dim;
  for (std::size_t i = 0; i < tile.num_blocks; ++i) {
    const auto block = static_cast<std::size_t>(tile.blocks[i]);
    const std::int32_t* nodes = tile.nodes + block * (num_nodes * block_size);
    const std::uint8_t* transposed = tile.transposed_lanes + block * pairs;
    const Place* place = places + block * pairs * block_size;
    for (int a = 0; a < num_nodes; ++a)
      for (int b = a; b < num_nodes; ++b, ++transposed)
        for (int lane = 0; lane < block_size; ++lane, ++place) {
          const double* at =
              values + entries * (row_begin[row_node(nodes, a, b, *transposed, lane)] + std::size_t{*place});
          __builtin_prefetch(at, 1, 2);
          if constexpr (dim == 3) __builtin_prefetch(at + 8, 1, 2);
        }
  }
}

template <int dim, int num_nodes>
void prefetch(const QuadratureTile& tile, const MatrixPlaces& at, const double* values) {
  at.narrow != nullptr ? prefetch_slots<dim, num_nodes>(tile, at.row_begin, at.narrow, values)
                       : prefetch_slots<dim, num_nodes>(tile, at.row_begin, at.wide, values);
}

template <int dim, int num_nodes, class Place>
void scatter_to(const QuadratureTile& tile, const double* K, const std::uint32_t* row_begin,
                const Place* places, const OwnedNodes& owned, double* values) {
  constexpr int pairs = num_pairs(num_nodes), entries = dim * dim;
  for (std::size_t i = 0; i < tile.num_blocks; ++i) {
    const auto block = static_cast<std::size_t>(tile.blocks[i]);
    const std::int32_t* nodes = tile.nodes + block * (num_nodes * block_size);
    const std::uint8_t* transposed = tile.transposed_lanes + block * pairs;
    for (int a = 0, pair = 0; a < num_nodes; ++a)
      for (int b = a; b < num_nodes; ++b, ++pair) {
        const double* rows = K + (i * pairs + static_cast<std::size_t>(pair)) * (entries * block_size);
        const Place* place = places + (block * pairs + static_cast<std::size_t>(pair)) * block_size;
        const unsigned lanes_transposed = transposed[pair];
        bool is_owned[block_size];
        std::uint32_t slot[block_size];
        for (int lane = 0; lane < block_size; ++lane) {
          const std::int32_t node = row_node(nodes, a, b, lanes_transposed, lane);
          is_owned[lane] = owns(owned, node);
          slot[lane] = row_begin[node] + place[lane];
        }
        double turned[entries * block_size];
        if (lanes_transposed != 0) {
          for (int r = 0; r < dim; ++r)
            for (int c = 0; c < dim; ++c)
              for (int lane = 0; lane < block_size; ++lane)
                turned[(dim * r + c) * block_size + lane] = (lanes_transposed >> lane & 1U) != 0
                                                                ? rows[(dim * c + r) * block_size + lane]
                                                                : rows[(dim * r + c) * block_size + lane];
          rows = turned;
        }
        if constexpr (dim == 3) {
          add_blocks3(rows, slot, is_owned, values);
        } else {
          for (int lane = 0; lane < block_size; ++lane)
            if (is_owned[lane])
              for (int k = 0; k < entries; ++k)
                values[std::size_t{entries} * slot[lane] + static_cast<std::size_t>(k)] +=
                    rows[k * block_size + lane];
        }
      }
  }
}

template <int dim, int num_nodes>
void scatter(const QuadratureTile& tile, const double* K, const MatrixPlaces& at, const OwnedNodes& owned,
             double* values) {
  at.narrow != nullptr ? scatter_to<dim, num_nodes>(tile, K, at.row_begin, at.narrow, owned, values)
                       : scatter_to<dim, num_nodes>(tile, K, at.row_begin, at.wide, owned, values);
}

template <int dim, int num_nodes>
constexpr QuadratureKernels kernels = {gradients<dim, num_nodes>,  add_energies<dim, num_nodes>,
                                       add_forces<dim, num_nodes>, hessians<dim, num_nodes>,
                                       mean<dim, num_nodes>,       add_mean_volume<dim, num_nodes>,
                                       prefetch<dim, num_nodes>,   scatter<dim, num_nodes>};

template <int dim, int... counts>
const QuadratureKernels* find(int num_nodes, std::integer_sequence<int, counts...>) {
  const QuadratureKernels* found = nullptr;
  ((found = num_nodes == counts ? &kernels<dim, counts> : found), ...);
  return found;
}

/// Entries of the displacement gradient that nodes of axisymmetric solids make: rr, rz, zr, zz, hoop.
constexpr int ring_entries[] = {0, 1, 3, 4, 8};

template <int num_nodes>
void ring_gradients(const QuadratureTile& tile, const double* displacements, double* H_rows) {
  for_groups<2, num_nodes>(tile, [&](const Group<2, num_nodes>& at) {
    Lanes u[num_nodes][2];
    for (int a = 0; a < num_nodes; ++a) gather<2>(displacements, at.nodes(a), u[a]);
    for (std::size_t q = 0; q < tile.num_points; ++q) {
      const RingPoint<num_nodes> point(at, q);
      Lanes H[9];
      point.gradient(u, H);
      store_rows(H, 9, H_rows + at.row(q, 9));
    }
  });
}

template <int num_nodes>
void ring_forces(const QuadratureTile& tile, const double* P_rows, bool is_magnitude, const OwnedNodes& owned,
                 double* forces) {
  for_groups<2, num_nodes>(tile, [&](const Group<2, num_nodes>& at) {
    Lanes f[num_nodes][2];
    for (auto& node_force : f)
      for (Lanes& component : node_force) component = 0.0;
    for (std::size_t q = 0; q < tile.num_points; ++q) {
      Lanes P[9];
      load_rows(P_rows + at.row(q, 9), 9, P);
      RingPoint<num_nodes>(at, q).add_forces(at.weight(q), P, f);
    }
    if (is_magnitude)
      for (auto& node_force : f)
        for (Lanes& component : node_force) component = abs(component);
    for (int a = 0; a < num_nodes; ++a)
      scatter_add<2>(f[a], at.nodes(a), [&](std::int32_t node) { return owns(owned, node); }, forces);
  });
}

/// K_ab = sum_q w B_a^T A B_b over the entries that nodes make.
template <int num_nodes>
void ring_hessians(const QuadratureTile& tile, const double* A_rows, double* out_rows) {
  constexpr int rows = num_pairs(num_nodes) * 4;
  for_groups<2, num_nodes>(tile, [&](const Group<2, num_nodes>& at) {
    ElementHessian<2, num_nodes> K;
    for (auto& block : K)
      for (Lanes& entry : block) entry = 0.0;
    for (std::size_t q = 0; q < tile.num_points; ++q) {
      const RingPoint<num_nodes> point(at, q);
      const double* A = A_rows + at.row(q, 81);
      const Lanes w = at.weight(q);
      for (int b = 0; b < num_nodes; ++b) {
        Lanes y[5][2];  // w A B_b
        for (int row = 0; row < 5; ++row) {
          const double* of_row = A + 9 * ring_entries[row] * block_size;
          const auto entry = [&](int column) { return Lanes::load(of_row + column * block_size); };
          y[row][0] = w * (entry(0) * point.g[b][0] + entry(1) * point.g[b][1] + entry(8) * point.h[b]);
          y[row][1] = w * (entry(3) * point.g[b][0] + entry(4) * point.g[b][1]);
        }
        for (int a = 0; a <= b; ++a) {
          Lanes* block = K[pair_index(num_nodes, a, b)];
          for (int j = 0; j < 2; ++j) {
            block[j] += point.g[a][0] * y[0][j] + point.g[a][1] * y[1][j] + point.h[a] * y[4][j];
            block[2 + j] += point.g[a][0] * y[2][j] + point.g[a][1] * y[3][j];
          }
        }
      }
    }
    for (int a = 0; a < num_nodes; ++a) make_symmetric<2>(K[pair_index(num_nodes, a, a)]);
    store_rows(K[0], rows, out_rows + at.in_tile * static_cast<std::size_t>(rows * block_size) + at.lane);
  });
}

template <int num_nodes>
void add_ring_volume(const QuadratureTile& tile, const double* H_rows, const double* c_rows, double* K) {
  constexpr int rows = num_pairs(num_nodes) * 4;
  for_groups<2, num_nodes>(tile, [&](const Group<2, num_nodes>& at) {
    Lanes b[num_nodes][2], volume = 0.0;
    for (auto& node : b)
      for (Lanes& component : node) component = 0.0;
    for (std::size_t q = 0; q < tile.num_points; ++q) {
      Lanes H[9], C[9];
      load_rows(H_rows + at.row(q, 9), 9, H);
      cofactor_of_F<3>(H, C);
      volume += at.weight(q);
      RingPoint<num_nodes>(at, q).add_forces(at.weight(q), C, b);
    }
    const Lanes safe = select(volume > Lanes(0.0), volume, Lanes(1.0));
    const Lanes factor = Lanes::load(c_rows + at.in_tile * block_size + at.lane) / safe;
    double* out = K + at.in_tile * static_cast<std::size_t>(rows * block_size) + at.lane;
    for (int a = 0, pair = 0; a < num_nodes; ++a)
      for (int c = a; c < num_nodes; ++c, ++pair)
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) {
            double* entry = out + (pair * 4 + 2 * i + j) * block_size;
            (Lanes::load(entry) + factor * b[a][i] * b[c][j]).store(entry);
          }
  });
}

template <int num_nodes>
constexpr QuadratureKernels ring_kernels = {
    ring_gradients<num_nodes>, add_energies<2, num_nodes>, ring_forces<num_nodes>, ring_hessians<num_nodes>,
    mean<2, num_nodes>,        add_ring_volume<num_nodes>, prefetch<2, num_nodes>, scatter<2, num_nodes>};

const QuadratureKernels& kernels_of_rings(int num_nodes) {
  return num_nodes == 3 ? ring_kernels<3> : num_nodes == 4 ? ring_kernels<4> : ring_kernels<6>;
}

const QuadratureKernels& kernels_of_cells(int dim, int num_nodes) {
  return dim == 2 ? *find<2>(num_nodes, NodeCounts<2>::type{}) : *find<3>(num_nodes, NodeCounts<3>::type{});
}

}  // namespace

}  // namespace resilin::RESILIN_SIMD_NAMESPACE

namespace resilin {

template <InstructionSet>
const QuadratureKernels& compiled_quadrature_kernels(int dim, int num_nodes) {
  return RESILIN_SIMD_NAMESPACE::kernels_of_cells(dim, num_nodes);
}
template const QuadratureKernels& compiled_quadrature_kernels<InstructionSet::RESILIN_SIMD_NAMESPACE>(int,
                                                                                                      int);

template <InstructionSet>
const QuadratureKernels& compiled_axisymmetric_kernels(int num_nodes) {
  return RESILIN_SIMD_NAMESPACE::kernels_of_rings(num_nodes);
}
template const QuadratureKernels& compiled_axisymmetric_kernels<InstructionSet::RESILIN_SIMD_NAMESPACE>(int);

}  // namespace resilin
