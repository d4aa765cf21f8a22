// Compiled once for each instruction set: see core/simd.hpp.
#include "lanes_probe.hpp"

#include "resilin/core/simd_arrays.hpp"
#include "resilin/core/simd_math.hpp"
#include "resilin/core/simd_svd.hpp"

namespace resilin::RESILIN_SIMD_NAMESPACE {
namespace {

using testing::LanesProbe;
using testing::Svd2Numbers;
using testing::SvdNumbers;

constexpr auto width = static_cast<std::size_t>(Lanes::width);

template <class Body>
RESILIN_INLINE void for_lanes(std::size_t size, const Body& body) {
  for (std::size_t i = 0; i < size; i += width) body(i);
}

/// Entry `entry` of `width` matrices with `entries` each.
RESILIN_INLINE Lanes gather(const double* matrices, std::size_t entries, std::size_t entry) {
  double numbers[width];
  for (std::size_t lane = 0; lane < width; ++lane) numbers[lane] = matrices[lane * entries + entry];
  return Lanes::load(numbers);
}
RESILIN_INLINE void scatter(Lanes x, double* matrices, std::size_t entries, std::size_t entry) {
  double numbers[width];
  x.store(numbers);
  for (std::size_t lane = 0; lane < width; ++lane) matrices[lane * entries + entry] = numbers[lane];
}

template <auto function>
void apply(std::size_t size, const double* x, double* y) {
  for_lanes(size, [&](std::size_t i) { function(Lanes::load(x + i)).store(y + i); });
}

void apply_power_difference(std::size_t size, const double* x, const double* alpha, double* y) {
  for_lanes(size, [&](std::size_t i) {
    power_difference(Lanes::load(x + i), Lanes::load(alpha + i)).store(y + i);
  });
}

template <bool keeps_strain>
RESILIN_INLINE void decompose(std::size_t count, const double* H_numbers, SvdNumbers* out) {
  constexpr std::size_t size = sizeof(SvdNumbers) / sizeof(double);
  for_lanes(count, [&](std::size_t i) {
    Lanes H[9];
    for (std::size_t k = 0; k < 9; ++k) H[k] = gather(H_numbers + 9 * i, 9, k);
    const Svd3 r = svd<keeps_strain>(H);
    double* numbers = out[i].U;
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        scatter(r.U[j].x[k], numbers, size, 3 * j + k);
        scatter(r.V[j].x[k], numbers, size, 9 + 3 * j + k);
      }
      scatter(r.s[j], numbers, size, 18 + j);
      if (keeps_strain) scatter(r.e[j], numbers, size, 21 + j);
    }
  });
}

void apply_svd(std::size_t count, bool keeps_strain, const double* H, SvdNumbers* out) {
  keeps_strain ? decompose<true>(count, H, out) : decompose<false>(count, H, out);
}

void apply_svd2(std::size_t count, const double* H_numbers, Svd2Numbers* out) {
  constexpr std::size_t size = sizeof(Svd2Numbers) / sizeof(double);
  for_lanes(count, [&](std::size_t i) {
    Lanes H[4];
    for (std::size_t k = 0; k < 4; ++k) H[k] = gather(H_numbers + 4 * i, 4, k);
    const Svd2 r = svd2(H);
    double* numbers = out[i].U;
    for (std::size_t j = 0; j < 2; ++j) {
      for (std::size_t k = 0; k < 2; ++k) {
        scatter(r.U[j][k], numbers, size, 2 * j + k);
        scatter(r.V[j][k], numbers, size, 4 + 2 * j + k);
      }
      scatter(r.s[j], numbers, size, 8 + j);
      scatter(r.e[j], numbers, size, 10 + j);
    }
  });
}

template <int n>
void apply_diagonalize(std::size_t count, double* A_numbers, double* V_numbers) {
  constexpr std::size_t entries = n * n;
  for_lanes(count, [&](std::size_t i) {
    Lanes A[n][n], V[n][n];
    for (int p = 0; p < n; ++p)
      for (int q = 0; q < n; ++q)
        A[p][q] = gather(A_numbers + entries * i, entries, static_cast<std::size_t>(n * p + q));
    diagonalize<n>(A, V);
    for (int p = 0; p < n; ++p)
      for (int q = 0; q < n; ++q) {
        const auto entry = static_cast<std::size_t>(n * p + q);
        scatter(A[p][q], A_numbers + entries * i, entries, entry);
        scatter(V[p][q], V_numbers + entries * i, entries, entry);
      }
  });
}

void apply_diagonalize3(std::size_t count, int sweeps, double* A_numbers, double* V_numbers) {
  if (sweeps == 0) return apply_diagonalize<3>(count, A_numbers, V_numbers);
  for_lanes(count, [&](std::size_t i) {
    double* numbers = A_numbers + 9 * i;
    const auto entry = [&](std::size_t k) { return gather(numbers, 9, k); };
    Symmetric3 A = {entry(0), entry(4), entry(8), entry(1), entry(2), entry(5)};
    Column3 V[3];
    diagonalize(A, V, sweeps);
    const Lanes rows[9] = {A.m00, A.m01, A.m02, A.m01, A.m11, A.m12, A.m02, A.m12, A.m22};
    for (std::size_t k = 0; k < 9; ++k) {
      scatter(rows[k], numbers, 9, k);
      scatter(V[k % 3].x[k / 3], V_numbers + 9 * i, 9, k);
    }
  });
}

const LanesProbe probe = {
    .sqrt = apply<[](Lanes x) { return sqrt(x); }>,
    .reciprocal_sqrt = apply<[](Lanes x) { return reciprocal_sqrt(x); }>,
    .power_of_two = apply<[](Lanes x) { return power_of_two(x); }>,
    .log1p = apply<[](Lanes x) { return log1p(x); }>,
    .log1p_minus = apply<[](Lanes x) { return log1p_minus(x); }>,
    .cbrt1p = apply<[](Lanes x) { return cbrt1p(x); }>,
    .exp = apply<[](Lanes x) { return exp(x); }>,
    .expm1 = apply<[](Lanes x) { return expm1(x); }>,
    .expm1_minus = apply<[](Lanes x) { return expm1_minus(x); }>,
    .power_difference = apply_power_difference,
    .svd = apply_svd,
    .svd2 = apply_svd2,
    .diagonalize3 = apply_diagonalize3,
    .diagonalize6 = apply_diagonalize<6>,
    .read_block = read_block<double>,
    .write_block = write_block<double>,
};

}  // namespace
}  // namespace resilin::RESILIN_SIMD_NAMESPACE

template <>
const resilin::testing::LanesProbe&
resilin::testing::compiled_lanes_probe<resilin::InstructionSet::RESILIN_SIMD_NAMESPACE>() {
  return resilin::RESILIN_SIMD_NAMESPACE::probe;
}
