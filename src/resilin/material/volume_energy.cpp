#include "resilin/material/volume_energy.hpp"

#include <algorithm>
#include <array>

#include "resilin/core/simd.hpp"
#include "resilin/material/kernels/law_kernels.hpp"
#include "resilin/material/law_sum.hpp"

namespace resilin {

std::vector<VolumeSlopes> volume_slopes(const LawInfo& law, std::span<const double> j,
                                        std::span<const Column> constants, InstructionSet set) {
  if (is_sum(law)) {
    std::vector<VolumeSlopes> sums(j.size(), {0, 0});
    for (const LawPart& part : parts_of(law)) {
      const auto own = volume_slopes(*part.law, j,
                                     constants.subspan(part.first_constant, part.law->constants.size()), set);
      for (std::size_t i = 0; i < own.size(); ++i) {
        sums[i].pressure += own[i].pressure;
        sums[i].stiffness += own[i].stiffness;
      }
    }
    return sums;
  }
  const LawKernels& kernels = law_kernels(law.index, set);
  alignas(64) std::array<double, block_size> in;
  alignas(64) std::array<double, 3 * block_size> out;
  alignas(64) std::array<double, max_constants * block_size> rows;
  std::vector<VolumeSlopes> slopes(j.size());
  for (std::size_t first = 0; first < j.size(); first += block_size) {
    const std::size_t count = std::min<std::size_t>(block_size, j.size() - first);
    for (std::size_t lane = 0; lane < block_size; ++lane) {
      const std::size_t state = first + std::min(lane, count - 1);
      in[lane] = j[state];
      for (std::size_t k = 0; k < constants.size(); ++k)
        rows[k * block_size + lane] = constants[k].data[state * constants[k].stride];
    }
    kernels.volume({1, in.data(), rows.data(), 0, out.data()});
    for (std::size_t lane = 0; lane < count; ++lane)
      slopes[first + lane] = {out[block_size + lane], out[2 * block_size + lane]};
  }
  return slopes;
}

void volume_of_stretches(const double* stretches, double* j) {
  for (int lane = 0; lane < block_size; ++lane) {
    const double a = stretches[lane], b = stretches[block_size + lane], c = stretches[2 * block_size + lane];
    j[lane] = a + b + c + (a * b + b * c + c * a) + a * b * c;
  }
}

void add_volume_energy(LawKind kind, const double* variables, const double* pressure, const double* stiffness,
                       double* rows) {
  const auto row = [rows](int i) { return rows + i * block_size; };
  if (kind != LawKind::stretches) {
    for (int lane = 0; lane < block_size; ++lane) {
      row(volume_slope_row)[lane] += pressure[lane];
      if (stiffness != nullptr) row(volume_curvature_row(kind))[lane] += stiffness[lane];
    }
    return;
  }
  constexpr int pairs[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  for (int lane = 0; lane < block_size; ++lane) {
    std::array<double, 3> s, slope;
    for (std::size_t i = 0; i < 3; ++i) s[i] = 1 + variables[i * block_size + static_cast<std::size_t>(lane)];
    for (std::size_t i = 0; i < 3; ++i) slope[i] = s[(i + 1) % 3] * s[(i + 2) % 3];
    const double p = pressure[lane];
    for (std::size_t i = 0; i < 3; ++i) row(static_cast<int>(i))[lane] += p * slope[i];
    if (stiffness == nullptr) continue;
    for (int k = 0; k < 6; ++k) {
      const auto i = static_cast<std::size_t>(pairs[k][0]), m = static_cast<std::size_t>(pairs[k][1]);
      row(3 + k)[lane] += stiffness[lane] * slope[i] * slope[m] + (i == m ? 0 : p * s[3 - i - m]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      row(9 + static_cast<int>(i))[lane] -= p * s[i];
      row(12 + static_cast<int>(i))[lane] += p * s[i];
    }
  }
}

}  // namespace resilin
