#pragma once

// For the sources that choose between kernels: cmake/ResilinKernels.cmake tells them, and core/cpu.cpp, which
// instruction sets are compiled (RESILIN_COMPILED_SETS).

#include <array>
#include <string>

#include "resilin/core/cpu.hpp"
#include "resilin/core/error.hpp"

namespace resilin {

/// A list of instruction sets, which leads a set at run time to its compiled kernels.
template <InstructionSet... sets>
struct InstructionSets {
  static constexpr std::array<InstructionSet, sizeof...(sets)> all = {sets...};

  /// Result of `kernels_of.operator()<set>()`, a pointer to the kernels of that set.
  template <class KernelsOf>
  static auto kernels(InstructionSet set, const KernelsOf& kernels_of) {
    decltype((kernels_of.template operator()<sets>(), ...)) found = nullptr;
    static_cast<void>(((set == sets && (found = kernels_of.template operator()<sets>(), true)) || ...));
    if (found == nullptr)
      throw InputError("instruction set", "one that this build holds", std::string(name(set)));
    return found;
  }
};

/// Instruction sets that this build holds.
using CompiledSets = InstructionSets<RESILIN_COMPILED_SETS>;

}  // namespace resilin
