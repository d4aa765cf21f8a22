#pragma once

#include <type_traits>
#include <utility>

#include "resilin/core/simd_power.hpp"
#include "resilin/material/invariants.hpp"
#include "resilin/material/kernels/law_kernels.hpp"
#include "resilin/material/stretches.hpp"

/// The kernels of a law, made of its energy. Each law is compiled by itself, once for each instruction set:
/// see law_object.cpp.in and core/simd.hpp.
namespace resilin::RESILIN_SIMD_NAMESPACE {
namespace {

/// A number that depends on a constant of the law, or on two.
using OneConstant = Dual<Lanes, 1>;
using TwoConstants = Dual<OneConstant, 1>;

template <class Real>
RESILIN_INLINE Real lifted(Lanes x) {
  if constexpr (std::is_same_v<Real, Lanes>) {
    return x;
  } else {
    Real result(0.0);
    result.value = lifted<typename Real::Number>(x);
    return result;
  }
}

/// The constants in lanes, read from rows of a block.
template <class Law, int... i>
RESILIN_INLINE Law read_law(const double* rows, std::integer_sequence<int, i...>) {
  return Law{Lanes::load(rows + i * block_size)...};
}
RESILIN_INLINE OneConstant read_constant(const double* rows, int i, int p) {
  OneConstant constant(0.0);
  constant.value = Lanes::load(rows + i * block_size);
  constant.slope[0] = i == p ? 1.0 : 0.0;
  return constant;
}
RESILIN_INLINE TwoConstants read_constant(const double* rows, int i, int p, int q) {
  TwoConstants constant(0.0);
  constant.value = read_constant(rows, i, p);
  constant.slope[0].value = i == q ? 1.0 : 0.0;
  return constant;
}
template <class Law, int... i>
RESILIN_INLINE Law read_law_of(const double* rows, std::integer_sequence<int, i...>, auto... place) {
  return Law{read_constant(rows, i, place...)...};
}

template <class Law>
using Places = std::make_integer_sequence<int, static_cast<int>(Law::constants.size())>;

/// The variables of the law's kind as numbers of type T, which carries derivatives by them unless it is Real
/// itself.
template <LawKind kind, class T, class Real>
RESILIN_INLINE auto read_variables(const double* rows) {
  // Lifted where it is used: as a variable of its own it would keep g++ 12 from holding the numbers in
  // registers.
  const auto variable = [rows](int i) {
    const Lanes x = Lanes::load(rows + i * block_size);
    if constexpr (std::is_same_v<T, Real>)
      return lifted<Real>(x);
    else
      return T::variable(lifted<Real>(x), i);
  };
  if constexpr (kind == LawKind::small_strain) {
    return SmallStrain<T>{variable(0), variable(2)};
  } else if constexpr (kind == LawKind::invariants) {
    return Invariants<T>::from_reduced(variable(0), variable(1), variable(2));
  } else if constexpr (kind == LawKind::stretches) {
    Real e[3];
    for (int i = 0; i < 3; ++i) e[i] = lifted<Real>(Lanes::load(rows + i * block_size));
    return Stretches<T>(e);
  } else if constexpr (kind == LawKind::axes) {
    return AxesStrain<T>{variable(0), variable(1), variable(2), variable(3),
                         variable(4), variable(5), variable(6)};
  } else {
    FibreInvariants<T> c{
        Invariants<T>::from_reduced(variable(0), variable(1), variable(2)), {variable(3), variable(4)}, {}};
    for (int i = 0; i < max_fibre_families; ++i)
      c.weight[i] = lifted<Real>(Lanes::load(rows + (5 + i) * block_size));
    return c;
  }
}

/// Whether the law has a limit of its own, beside J > 0.
template <class Law>
constexpr bool has_margin = Law::kind == LawKind::invariants &&
                            requires(const Law& law, const Invariants<Lanes>& c) { law.margin(c); };
template <class Law>
constexpr bool has_domain = Law::needs_positive_J || has_margin<Law>;

/// Whether Psi is infinite.
template <class Law>
RESILIN_INLINE Mask is_outside([[maybe_unused]] const Law& law, const double* rows) {
  Mask outside = Lanes(0.0) > Lanes(1.0);
  if constexpr (Law::needs_positive_J) {
    if constexpr (Law::kind == LawKind::stretches) {
      for (int i = 0; i < 3; ++i) outside |= ~(Lanes::load(rows + i * block_size) > Lanes(-1.0));
    } else {
      outside |= ~(Lanes::load(rows + 2 * block_size) > Lanes(-1.0));
    }
  }
  if constexpr (has_margin<Law>)
    outside |= ~(law.margin(read_variables<LawKind::invariants, Lanes, Lanes>(rows)) > Lanes(0.0));
  return outside;
}

/// Addend that takes `x` out of the numbers in the lanes that lie outside the domain.
template <class Law>
RESILIN_INLINE Lanes undefined_outside(const Law& law, const double* rows) {
  if constexpr (has_domain<Law>)
    return select(is_outside(law, rows), __builtin_nan(""), 0.0);
  else
    return 0.0;
}

/// Calls `body(variables, constants, results)` for all groups of lanes.
template <LawKind kind, class Body>
RESILIN_INLINE void for_lanes(const LawBatch& batch, int num_rows, const Body& body) {
  for (std::size_t block = 0; block < batch.num_blocks; ++block)
    for (int lane = 0; lane < block_size; lane += Lanes::width)
      body(batch.variables + block * static_cast<std::size_t>(num_variables(kind) * block_size) + lane,
           batch.constants + block * batch.constant_stride + lane,
           batch.results + block * static_cast<std::size_t>(num_rows * block_size) + lane);
}

/// The variables as numbers that carry first derivatives by themselves, over `Real`.
template <LawKind kind, class Real>
RESILIN_INLINE auto read_first_order(const double* rows) {
  return read_variables<kind, Dual<Real, num_slopes(kind)>, Real>(rows);
}

/// The value of Psi alone. Stretches and fibres are written with numbers that carry derivatives in any case.
template <class Real, class Law>
RESILIN_INLINE Real value_of(const Law& law, const double* variables) {
  if constexpr (Law::kind == LawKind::invariants || Law::kind == LawKind::small_strain ||
                Law::kind == LawKind::axes)
    return law.energy_density(read_variables<Law::kind, Real, Real>(variables));
  else
    return law.energy_density(read_first_order<Law::kind, Real>(variables)).value;
}

template <class Law>
[[gnu::flatten]] void energy(const LawBatch& batch) {
  for_lanes<Law::kind>(batch, 1, [](const double* variables, const double* constants, double* out) {
    const Law law = read_law<Law>(constants, Places<Law>{});
    Lanes psi = value_of<Lanes>(law, variables);
    if constexpr (has_domain<Law>) psi = select(is_outside(law, variables), __builtin_inf(), psi);
    psi.store(out);
  });
}

template <class Law>
[[gnu::flatten]] void gradient(const LawBatch& batch) {
  constexpr int n = num_slopes(Law::kind);
  for_lanes<Law::kind>(batch, n, [](const double* variables, const double* constants, double* out) {
    const Law law = read_law<Law>(constants, Places<Law>{});
    const auto psi = law.energy_density(read_first_order<Law::kind, Lanes>(variables));
    const Lanes shift = undefined_outside(law, variables);
    for (int i = 0; i < n; ++i) (psi.slope[i] + shift).store(out + i * block_size);
  });
}

template <class Law>
[[gnu::flatten]] void curvature(const LawBatch& batch) {
  constexpr int n = num_slopes(Law::kind), rows = num_curvature_rows(Law::kind);
  constexpr int others = Law::kind == LawKind::stretches ? 6 : 0;
  using Number = Dual2<Lanes, n, others>;
  for_lanes<Law::kind>(batch, rows, [](const double* variables, const double* constants, double* out) {
    const Law law = read_law<Law>(constants, Places<Law>{});
    const Number psi = law.energy_density(read_variables<Law::kind, Number, Lanes>(variables));
    const Lanes shift = undefined_outside(law, variables);
    for (int i = 0; i < n; ++i) (psi.slope[i] + shift).store(out + i * block_size);
    out += n * block_size;
    for (int k = 0; k < Number::num_curvatures; ++k) (psi.curvature[k] + shift).store(out + k * block_size);
    out += Number::num_curvatures * block_size;
    for (int k = 0; k < others; ++k) (psi.other[k] + shift).store(out + k * block_size);
  });
}

/// Psi(J) of the law's volume energy, where the law tells it apart.
template <class Law>
[[gnu::flatten]] void volume(const LawBatch& batch) {
  using Number = Dual2<Lanes, 1>;
  for (std::size_t block = 0; block < batch.num_blocks; ++block)
    for (int lane = 0; lane < block_size; lane += Lanes::width) {
      const Law law = read_law<Law>(batch.constants + block * batch.constant_stride + lane, Places<Law>{});
      const Lanes j = Lanes::load(batch.variables + block * block_size + lane);
      const Number psi = law.volume_energy(Number::variable(j, 0));
      const Lanes shift =
          Law::needs_positive_J ? select(j > Lanes(-1.0), Lanes(0.0), Lanes(__builtin_nan(""))) : Lanes(0.0);
      double* out = batch.results + block * (3 * block_size) + lane;
      (psi.value + shift).store(out);
      (psi.slope[0] + shift).store(out + block_size);
      (psi.curvature[0] + shift).store(out + 2 * block_size);
    }
}
template <class Law>
constexpr auto volume_or_null() -> void (*)(const LawBatch&) {
  if constexpr (has_volume_energy<Law>)
    return volume<Law>;
  else
    return nullptr;
}

template <template <class> class Law>
void constant_gradient(const LawBatch& batch, int p) {
  using Plain = Law<Lanes>;
  constexpr int n = num_slopes(Plain::kind);
  for_lanes<Plain::kind>(batch, n + 1, [p](const double* variables, const double* constants, double* out) {
    const auto law = read_law_of<Law<OneConstant>>(constants, Places<Plain>{}, p);
    const auto psi = law.energy_density(read_first_order<Plain::kind, OneConstant>(variables));
    const Lanes shift = undefined_outside(read_law<Plain>(constants, Places<Plain>{}), variables);
    (psi.value.slope[0] + shift).store(out);
    for (int i = 0; i < n; ++i) (psi.slope[i].slope[0] + shift).store(out + (i + 1) * block_size);
  });
}

template <template <class> class Law>
void constant_curvature(const LawBatch& batch, int p, int q) {
  using Plain = Law<Lanes>;
  for_lanes<Plain::kind>(batch, 1, [p, q](const double* variables, const double* constants, double* out) {
    const auto law = read_law_of<Law<TwoConstants>>(constants, Places<Plain>{}, p, q);
    const auto psi = value_of<TwoConstants>(law, variables);
    const Lanes shift = undefined_outside(read_law<Plain>(constants, Places<Plain>{}), variables);
    (psi.slope[0].slope[0] + shift).store(out);
  });
}

template <template <class> class Law>
constexpr LawKernels kernels_of = {energy<Law<Lanes>>,     gradient<Law<Lanes>>,
                                   curvature<Law<Lanes>>,  volume_or_null<Law<Lanes>>(),
                                   constant_gradient<Law>, constant_curvature<Law>};

}  // namespace
}  // namespace resilin::RESILIN_SIMD_NAMESPACE

namespace resilin {

template <template <class> class Law, InstructionSet>
const LawKernels& compiled_law_kernels() {
  return RESILIN_SIMD_NAMESPACE::kernels_of<Law>;
}

}  // namespace resilin
