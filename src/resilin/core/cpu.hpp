#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace resilin {

/// Instruction sets for which the kernels are compiled, the slowest first.
enum class InstructionSet {
  baseline,  ///< whatever the compiler targets without flags: 2 lanes of doubles
  avx2,      ///< AVX2 and FMA: 4 lanes
  avx512,    ///< AVX-512 F, DQ, VL, BW: 8 lanes
};

std::string_view name(InstructionSet set);

/// Instruction sets that this build holds and this processor runs, the slowest first; never empty.
std::vector<InstructionSet> available_instruction_sets();

/// The one by this name, when it is available.
std::optional<InstructionSet> find_instruction_set(std::string_view name);

/// What new energies use: the environment variable RESILIN_ISA when it names an available set (for tests and
/// measurements), else the fastest available one.
InstructionSet preferred_instruction_set();

}  // namespace resilin
