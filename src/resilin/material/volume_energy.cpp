#include "resilin/material/volume_energy.hpp"

#include <algorithm>
#include <array>

#include "resilin/core/simd.hpp"
#include "resilin/material/kernels/law_kernels.hpp"

namespace resilin {

std::vector<VolumeSlopes> volume_slopes(const LawInfo& law, std::span<const double> j,
                                        std::span<const Column> constants, InstructionSet set) {
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

}  // namespace resilin
