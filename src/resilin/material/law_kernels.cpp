// Compiled once for each instruction set: see core/simd.hpp.
#include "resilin/material/law_kernels.hpp"

#include <utility>

#include "resilin/core/simd_math.hpp"
#include "resilin/material/catalog.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {
namespace {

/// A law with its constants in lanes, read from rows of a block.
template <class Law, int... i>
RESILIN_INLINE Law read_law(const double* rows, std::integer_sequence<int, i...>) {
  return Law{Lanes::load(rows + i * block_size)...};
}

template <class T, class Law>
RESILIN_INLINE T evaluate(const Law& law, const T& first, const T& second, const T& third) {
  if constexpr (Law::kind == LawKind::small_strain)
    return law.energy_density(SmallStrain<T>{first, third});
  else
    return law.energy_density(Invariants<T>::from_reduced(first, second, third));
}

/// Calls `evaluate_lanes(law, first, second, third, is_outside, results)` for all lanes of all blocks.
template <class Law, class Body>
RESILIN_INLINE void for_lanes(const LawBatch& batch, int rows, const Body& evaluate_lanes) {
  using Indices = std::make_integer_sequence<int, static_cast<int>(Law::constants.size())>;
  for (std::size_t block = 0; block < batch.num_blocks; ++block) {
    for (int lane = 0; lane < block_size; lane += Lanes::width) {
      const double* in = batch.invariants + block * 3 * block_size + lane;
      const Law law = read_law<Law>(batch.constants + block * batch.constant_stride + lane, Indices{});
      const Lanes third = Lanes::load(in + 2 * block_size);
      double* out = batch.results + block * static_cast<std::size_t>(rows * block_size) + lane;
      evaluate_lanes(law, Lanes::load(in), Lanes::load(in + block_size), third, ~(third > Lanes(-1.0)), out);
    }
  }
}

template <class Law>
[[gnu::flatten]] void energy(const LawBatch& batch) {
  for_lanes<Law>(batch, 1, [](const Law& law, Lanes a, Lanes b, Lanes c, Mask is_outside, double* out) {
    Lanes psi = evaluate<Lanes>(law, a, b, c);
    if constexpr (Law::needs_positive_J) psi = select(is_outside, __builtin_inf(), psi);
    psi.store(out);
  });
}

template <class Law>
[[gnu::flatten]] void gradient(const LawBatch& batch) {
  using Number = Dual<Lanes>;
  for_lanes<Law>(
      batch, gradient_rows, [](const Law& law, Lanes a, Lanes b, Lanes c, Mask is_outside, double* out) {
        const Number psi =
            evaluate<Number>(law, Number::variable(a, 0), Number::variable(b, 1), Number::variable(c, 2));
        const Lanes shift = Law::needs_positive_J ? select(is_outside, __builtin_nan(""), 0.0) : 0.0;
        for (int i = 0; i < 3; ++i) (psi.slope[i] + shift).store(out + i * block_size);
      });
}

template <class Law>
[[gnu::flatten]] void curvature(const LawBatch& batch) {
  using Number = Dual2<Lanes>;
  for_lanes<Law>(
      batch, curvature_rows, [](const Law& law, Lanes a, Lanes b, Lanes c, Mask is_outside, double* out) {
        const Number psi =
            evaluate<Number>(law, Number::variable(a, 0), Number::variable(b, 1), Number::variable(c, 2));
        const Lanes shift = Law::needs_positive_J ? select(is_outside, __builtin_nan(""), 0.0) : 0.0;
        for (int i = 0; i < 3; ++i) (psi.slope[i] + shift).store(out + i * block_size);
        for (int k = 0; k < 6; ++k) (psi.curvature[k] + shift).store(out + (3 + k) * block_size);
      });
}

template <template <class> class... Law>
const LawKernels& kernels_of(LawList<Law...>, int law_index) {
  static constexpr LawKernels table[] = {
      {energy<Law<Lanes>>, gradient<Law<Lanes>>, curvature<Law<Lanes>>}...};
  return table[law_index];
}

}  // namespace

const LawKernels& law_kernels(int law_index) { return kernels_of(Laws{}, law_index); }

}  // namespace resilin::RESILIN_SIMD_NAMESPACE
