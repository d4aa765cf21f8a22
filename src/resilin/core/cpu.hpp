#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "resilin/core/instruction_set.hpp"

namespace resilin {

/// Name of an instruction set as users write it.
std::string_view name(InstructionSet set);
std::vector<std::string> names(std::span<const InstructionSet> sets);

/// Instruction sets that this build holds (cmake -DRESILIN_INSTRUCTION_SETS=...), the slowest first; never
/// empty.
std::vector<InstructionSet> compiled_instruction_sets();

/// Those of them that this processor runs. Empty where the program was built for a better machine alone.
std::vector<InstructionSet> available_instruction_sets();

/// The one that the environment variable RESILIN_ISA asks for, read once: for tests and measurements.
/// @throws InputError  when it is not available
std::optional<InstructionSet> requested_instruction_set();

/// Instruction set of kernels, those of elements and those of linear algebra: the requested set, else the
/// fastest available one.
/// @throws InputError  when there is none, or when RESILIN_ISA asks for one that is not available
InstructionSet preferred_instruction_set();

}  // namespace resilin
