// Compiled once for each instruction set: see core/simd.hpp.
#include "resilin/energy/kernels/element_kernels.hpp"

#include "resilin/energy/kernels/gather.hpp"
#include "resilin/energy/kernels/lane_hessians.hpp"
#include "resilin/material/kernels/law_kernels.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {
namespace {

constexpr int num_pairs(int dim) { return (dim + 1) * (dim + 2) / 2; }

/// Where the data of one group of lanes begins.
template <int dim>
struct Place {
  std::size_t in_tile;  ///< number of the block in the tile
  std::size_t block;    ///< and among all blocks
  int lane;             ///< first lane

  const std::int32_t* nodes(const ElementTile& tile, int a) const {
    return tile.nodes + (block * (dim + 1) + static_cast<std::size_t>(a)) * block_size + lane;
  }
  std::size_t row(int rows) const {
    return in_tile * static_cast<std::size_t>(rows * block_size) + static_cast<std::size_t>(lane);
  }
  Lanes weight(const ElementTile& tile) const {
    return Lanes::load(tile.weights + block * block_size + lane);
  }
  /// Directions of the fibres; null where there are none.
  const double* directions(const ElementTile& tile) const {
    return tile.directions == nullptr ? nullptr : tile.directions + block * (fibre_rows * block_size) + lane;
  }
  RESILIN_INLINE void gradients(const ElementTile& tile, Lanes g[dim][dim]) const {
    const std::size_t place = tile.gradients_are_of_tile ? in_tile : block;
    load_rows(tile.gradients + place * (dim * dim * block_size) + lane, dim * dim, g[0]);
  }
};

template <int dim, class Body>
RESILIN_INLINE void for_lanes(const ElementTile& tile, const Body& body) {
  for (std::size_t i = 0; i < tile.num_blocks; ++i)
    for (int lane = 0; lane < block_size; lane += Lanes::width)
      body(Place<dim>{i, static_cast<std::size_t>(tile.blocks[i]), lane});
}

/// Calls the geometry of the block after the next tile into the cache, when blocks follow in order.
template <int dim>
RESILIN_INLINE void prefetch_geometry(const ElementTile& tile, std::size_t block) {
  constexpr std::size_t nodes_per_block = (dim + 1) * block_size,
                        gradients_per_block = dim * dim * block_size;
  const std::size_t ahead = block + 2 * tile.num_blocks;
  if (ahead >= tile.total_blocks) return;
  for (std::size_t i = 0; !tile.gradients_are_of_tile && i < gradients_per_block; i += 8)
    __builtin_prefetch(tile.gradients + ahead * gradients_per_block + i);
  __builtin_prefetch(tile.weights + ahead * block_size);
  for (std::size_t i = 0; i < nodes_per_block; i += 16)
    __builtin_prefetch(tile.nodes + ahead * nodes_per_block + i);
}

/// With the edges e_a = X_a - X_0: g_1 = e_2 x e_3 / V, V = e_1 . e_2 x e_3, and so around.
template <int dim>
[[gnu::flatten]] void shape_gradients(const ElementTile& tile, const double* rest_positions, double* rows) {
  for_lanes<dim>(tile, [&](const Place<dim>& at) {
    Lanes X0[dim], e[dim][dim], g[dim][dim];
    gather<dim>(rest_positions, at.nodes(tile, 0), X0);
    for (int a = 0; a < dim; ++a) {
      gather<dim>(rest_positions, at.nodes(tile, a + 1), e[a]);
      for (int i = 0; i < dim; ++i) e[a][i] -= X0[i];
    }
    if constexpr (dim == 2) {
      g[0][0] = e[1][1];
      g[0][1] = -e[1][0];
      g[1][0] = -e[0][1];
      g[1][1] = e[0][0];
    } else {
      for (int a = 0; a < 3; ++a)
        for (int i = 0; i < 3; ++i)
          g[a][i] = e[(a + 1) % 3][(i + 1) % 3] * e[(a + 2) % 3][(i + 2) % 3] -
                    e[(a + 1) % 3][(i + 2) % 3] * e[(a + 2) % 3][(i + 1) % 3];
    }
    const Mask has_volume = at.weight(tile) > Lanes(0.0);
    const Lanes V = select(has_volume, dot<dim>(e[0], g[0]), Lanes(1.0));
    const Lanes inverse = select(has_volume, Lanes(1.0) / V, Lanes(0.0));
    for (int a = 0; a < dim; ++a)
      for (int i = 0; i < dim; ++i) g[a][i] *= inverse;
    store_rows(g[0], dim * dim, rows + at.row(dim * dim));
  });
}

template <int dim>
[[gnu::flatten]] void measure(const ElementTile& tile, const LawForm& law, const double* displacements,
                              double* H_rows, double* variables, double* frames) {
  const int rows = num_variables(law.kind);
  for_lanes<dim>(tile, [&](const Place<dim>& at) {
    Lanes u0[dim], u[dim], g[dim][dim], H[dim * dim], out[max_variables], frame[frame_rows(dim)];
    if (at.lane == 0) prefetch_geometry<dim>(tile, at.block);
    at.gradients(tile, g);
    gather<dim>(displacements, at.nodes(tile, 0), u0);
    for (int a = 0; a < dim; ++a) {
      gather<dim>(displacements, at.nodes(tile, a + 1), u);
      for (int i = 0; i < dim; ++i) {
        u[i] -= u0[i];
        for (int k = 0; k < dim; ++k)
          H[dim * i + k] = a == 0 ? u[i] * g[a][k] : H[dim * i + k] + u[i] * g[a][k];
      }
    }
    const bool keeps_frame = law.kind == LawKind::stretches && frames != nullptr;
    variables_of<dim>(law, H, at.directions(tile), out, keeps_frame ? frame : nullptr);
    store_rows(H, dim * dim, H_rows + at.row(dim * dim));
    store_variables(law, out, variables + at.row(rows));
    if (keeps_frame) store_rows(frame, frame_rows(dim), frames + at.row(frame_rows(dim)));
  });
}

template <int dim>
[[gnu::flatten]] void add_energies(const ElementTile& tile, const double* psi, const double* psi_from,
                                   EnergySum& total) {
  Mask is_outside = Lanes(0.0) > Lanes(1.0);
  for_lanes<dim>(tile, [&](const Place<dim>& at) {
    Lanes value = Lanes::load(psi + at.row(1));
    is_outside |= ~(value < Lanes(__builtin_inf()));
    if (psi_from != nullptr) value -= Lanes::load(psi_from + at.row(1));
    const Lanes part = at.weight(tile) * value, sum = Lanes::load(total.sum + at.lane);
    const Lanes next = sum + part, shown = next - sum;  // two-sum (Knuth)
    const Lanes rest = (sum - (next - shown)) + (part - shown);
    next.store(total.sum + at.lane);
    (Lanes::load(total.rest + at.lane) + rest).store(total.rest + at.lane);
  });
  total.is_outside = total.is_outside || any(is_outside);
}

template <int dim>
[[gnu::flatten]] void add_forces(const ElementTile& tile, const LawForm& law, const double* H_rows,
                                 const double* frames, const double* law_gradient, bool is_magnitude,
                                 const OwnedNodes& owned, double* forces) {
  const int rows = num_slopes(law.kind);
  for_lanes<dim>(tile, [&](const Place<dim>& at) {
    Lanes H[dim * dim], frame[frame_rows(dim)], slopes[max_slopes], P[dim * dim], g[dim][dim],
        f[dim + 1][dim];
    load_rows(H_rows + at.row(dim * dim), dim * dim, H);
    load_rows(law_gradient + at.row(rows), rows, slopes);
    if (law.kind == LawKind::stretches) load_rows(frames + at.row(frame_rows(dim)), frame_rows(dim), frame);
    at.gradients(tile, g);
    stress<dim>(law, H, frame, at.directions(tile), slopes, P);
    const Lanes w = at.weight(tile);
    for (int i = 0; i < dim * dim; ++i) P[i] *= w;
    apply<dim>(P, g, f + 1);
    for (int i = 0; i < dim; ++i) {
      f[0][i] = -f[1][i];
      for (int a = 2; a <= dim; ++a) f[0][i] -= f[a][i];
    }
    if (is_magnitude)
      for (auto& node_force : f)
        for (Lanes& component : node_force) component = abs(component);
    const bool is_complete = owns_all(owned, at.nodes(tile, 0), dim + 1);
    for (int a = 0; a <= dim; ++a) {
      if (is_complete)
        scatter_add<dim>(f[a], at.nodes(tile, a), [](std::int32_t) { return true; }, forces);
      else
        scatter_add<dim>(
            f[a], at.nodes(tile, a), [&](std::int32_t node) { return owns(owned, node); }, forces);
    }
  });
}

/// For a law of invariants, by the shortest way.
template <int dim>
RESILIN_INLINE void invariant_hessian(const HessianForm& form, const Lanes H[], const double* law,
                                      const Lanes g[dim][dim], Lanes w, ElementHessian<dim>& K) {
  Lanes F[dim * dim];
  for (int i = 0; i < dim * dim; ++i) F[i] = H[i];
  add_identity<dim>(F);
  if constexpr (dim == 2) {
    const InvariantDerivatives d = plane_strain_derivatives(law, H[0] + H[3] + (H[0] * H[3] - H[1] * H[2]));
    if (form.removed > 0)
      projected_hessian2(H, d, g, w, form.removed, K);
    else
      plain_hessian2(F, d, g, w, K);
  } else {
    const InvariantDerivatives d = invariant_derivatives(law);
    if (form.removed > 0) {
      const Svd3 m = svd<false>(H);
      PrincipalTangent t =
          form.law.uses_second_invariant ? principal_tangent<true>(d, m.s) : principal_tangent<false>(d, m.s);
      t.project(form.removed);
      principal_hessian3(t, m.U, m.V, g, w, K);
    } else if (form.law.uses_second_invariant) {
      plain_hessian3<true>(F, d, g, w, K);
    } else {
      plain_hessian3<false>(F, d, g, w, K);
    }
  }
}

template <int dim>
RESILIN_INLINE void stretch_hessian3(const HessianForm& form, const Lanes frame[], const double* law,
                                     const Lanes g[dim][dim], Lanes w, ElementHessian<dim>& K) {
  PrincipalTangent t = principal_tangent(law);
  if (form.removed > 0) t.project(form.removed);
  const auto* columns = reinterpret_cast<const Column3*>(frame);  // columns of U, then of V
  principal_hessian3(t, columns, columns + 3, g, w, K);
}

template <int dim>
RESILIN_INLINE void element_hessian(const HessianForm& form, const Lanes H[], const Lanes frame[],
                                    const double* directions, const double* law, const Lanes g[dim][dim],
                                    Lanes w, ElementHessian<dim>& K) {
  if (form.law.kind == LawKind::small_strain) {
    small_strain_hessian<dim>(Lanes::load(law), Lanes::load(law + 8 * block_size), g, w, K);
  } else if (form.law.kind == LawKind::invariants) {
    invariant_hessian<dim>(form, H, law, g, w, K);
  } else if (dim == 3 && form.law.kind == LawKind::stretches) {
    if constexpr (dim == 3) stretch_hessian3<dim>(form, frame, law, g, w, K);
  } else {
    Lanes A[dim * dim * dim * dim];
    tangent<dim>(form.law, form.removed, H, frame, directions, law, A);
    hessian_from_tangent<dim>(A, g, w, K);
  }
}

template <int dim>
void hessians(const ElementTile& tile, const HessianForm& form, const double* H_rows, const double* frames,
              const double* law_curvature, double* out_rows) {
  constexpr int rows = num_pairs(dim) * dim * dim;
  const int law_rows = num_curvature_rows(form.law.kind);
  for_lanes<dim>(tile, [&](const Place<dim>& at) {
    Lanes H[dim * dim], frame[frame_rows(dim)], g[dim][dim];
    load_rows(H_rows + at.row(dim * dim), dim * dim, H);
    if (form.law.kind == LawKind::stretches)
      load_rows(frames + at.row(frame_rows(dim)), frame_rows(dim), frame);
    at.gradients(tile, g);
    const double* law = law_curvature + at.row(law_rows);
    double* out = out_rows + at.row(rows);
    if constexpr (Lanes::width == block_size) {  // a row of lanes is a row of the block: no copy
      element_hessian<dim>(form, H, frame, at.directions(tile), law, g, at.weight(tile),
                           *reinterpret_cast<ElementHessian<dim>*>(out));
    } else {
      ElementHessian<dim> K;
      element_hessian<dim>(form, H, frame, at.directions(tile), law, g, at.weight(tile), K);
      store_rows(K[0], rows, out);
    }
  });
}

/// In line: a call whose only effect is on the cache is none to the compiler.
template <int dim, class Place>
RESILIN_INLINE void prefetch_slots(const ElementTile& tile, const double* displacements,
                                   const std::uint32_t* row_begin, const Place* places,
                                   const double* values) {
  constexpr std::size_t nodes_per_block = (dim + 1) * block_size;
  constexpr std::size_t slots_per_block = num_pairs(dim) * block_size, entries = dim * dim;
  for (std::size_t i = 0; i < tile.num_blocks; ++i) {
    const auto block = static_cast<std::size_t>(tile.blocks[i]);
    const std::int32_t* row_nodes = tile.nodes + block * nodes_per_block;
    const Place* place = places + block * slots_per_block;
    for (int a = 0; a <= dim; ++a, row_nodes += block_size) {
      const double* rows[block_size];
      for (int lane = 0; lane < block_size; ++lane)
        rows[lane] = values + entries * row_begin[row_nodes[lane]];
      for (int b = a; b <= dim; ++b)
        for (int lane = 0; lane < block_size; ++lane, ++place) {
          __builtin_prefetch(rows[lane] + entries * *place, 1);
          if constexpr (dim == 3) __builtin_prefetch(rows[lane] + entries * *place + 8, 1);
        }
    }
    const std::size_t next = block + tile.num_blocks;
    if (next >= tile.total_blocks) continue;
    for (std::size_t k = 0; k < nodes_per_block; ++k)
      __builtin_prefetch(displacements + node_stride(dim) * tile.nodes[next * nodes_per_block + k]);
  }
}

template <int dim>
void prefetch(const ElementTile& tile, const double* displacements, const MatrixPlaces& at,
              const double* values) {
  at.narrow != nullptr ? prefetch_slots<dim>(tile, displacements, at.row_begin, at.narrow, values)
                       : prefetch_slots<dim>(tile, displacements, at.row_begin, at.wide, values);
}

template <int dim, class Place>
void scatter_to(const ElementTile& tile, const double* K, const std::uint32_t* row_begin, const Place* places,
                const OwnedNodes& owned, double* values) {
  constexpr int pairs = num_pairs(dim), entries = dim * dim;
  for (std::size_t i = 0; i < tile.num_blocks; ++i) {
    const auto block = static_cast<std::size_t>(tile.blocks[i]);
    for (int a = 0, pair = 0; a <= dim; ++a) {
      bool is_owned[block_size];
      std::uint32_t first_slot[block_size];
      const std::int32_t* row_nodes =
          tile.nodes + (block * (dim + 1) + static_cast<std::size_t>(a)) * block_size;
      for (int lane = 0; lane < block_size; ++lane) {
        is_owned[lane] = owns(owned, row_nodes[lane]);
        first_slot[lane] = row_begin[row_nodes[lane]];
      }
      for (int b = a; b <= dim; ++b, ++pair) {
        const double* rows = K + (i * pairs + static_cast<std::size_t>(pair)) * (entries * block_size);
        const Place* place = places + (block * pairs + static_cast<std::size_t>(pair)) * block_size;
        std::uint32_t slot[block_size];
        for (int lane = 0; lane < block_size; ++lane) slot[lane] = first_slot[lane] + place[lane];
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
}

template <int dim>
void scatter(const ElementTile& tile, const double* K, const MatrixPlaces& at, const OwnedNodes& owned,
             double* values) {
  at.narrow != nullptr ? scatter_to<dim>(tile, K, at.row_begin, at.narrow, owned, values)
                       : scatter_to<dim>(tile, K, at.row_begin, at.wide, owned, values);
}

template <int dim>
void volume_cubics(std::size_t num_blocks, const double* H_rows, const double* G_rows, double* cubics) {
  for (std::size_t block = 0; block < num_blocks; ++block)
    for (int lane = 0; lane < block_size; lane += Lanes::width) {
      const Place<dim> at{block, block, lane};
      Lanes F[dim * dim], G[dim * dim], c[4], variables[3];
      load_rows(H_rows + at.row(dim * dim), dim * dim, F);
      load_rows(G_rows + at.row(dim * dim), dim * dim, G);
      invariants<dim>(F, false, variables);
      add_identity<dim>(F);
      c[0] = 1.0 + variables[2];
      if constexpr (dim == 2) {
        c[1] = F[3] * G[0] - F[2] * G[1] - F[1] * G[2] + F[0] * G[3];
        c[2] = G[0] * G[3] - G[1] * G[2];
        c[3] = 0.0;
      } else {
        Lanes cof_F[9], cof_G[9];
        cofactor(F, cof_F);
        cofactor(G, cof_G);
        c[1] = dot<9>(cof_F, G);
        c[2] = dot<9>(F, cof_G);
        c[3] = dot<3>(G, cof_G);
      }
      store_rows(c, 4, cubics + at.row(4));
    }
}

template <int dim>
constexpr ElementKernels kernels = {shape_gradients<dim>, measure<dim>,      add_energies<dim>,
                                    add_forces<dim>,      hessians<dim>,     prefetch<dim>,
                                    scatter<dim>,         volume_cubics<dim>};

}  // namespace

}  // namespace resilin::RESILIN_SIMD_NAMESPACE

namespace resilin {

template <InstructionSet>
const ElementKernels& compiled_element_kernels(int dim) {
  return dim == 2 ? RESILIN_SIMD_NAMESPACE::kernels<2> : RESILIN_SIMD_NAMESPACE::kernels<3>;
}
template const ElementKernels& compiled_element_kernels<InstructionSet::RESILIN_SIMD_NAMESPACE>(int);

}  // namespace resilin
