#include "resilin/core/cpu.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "resilin/core/kernel_dispatch.hpp"
#include "resilin/core/text.hpp"

namespace resilin {
namespace {

std::optional<InstructionSet> read_request() {
  const char* variable = std::getenv("RESILIN_ISA");
  if (variable == nullptr || *variable == '\0') return std::nullopt;
  const std::vector<InstructionSet> sets = available_instruction_sets();
  for (const InstructionSet set : sets)
    if (name(set) == variable) return set;
  const std::vector<std::string> known = names(sets);
  throw InputError("environment variable RESILIN_ISA",
                   "one of the instruction sets that this build holds and this processor runs, " +
                       (known.empty() ? "of which there are none" : join(known)),
                   '"' + std::string(variable) + '"', "correct it or unset it");
}

InstructionSet choose() {
  if (const auto requested = requested_instruction_set()) return *requested;
  const std::vector<InstructionSet> available = available_instruction_sets();
  if (!available.empty()) return available.back();
  throw InputError(
      "this processor",
      "one that runs " + join(names(compiled_instruction_sets()), " or ") +
          ", for which alone Resilin was built",
      "one that does not",
      "build it on this machine, or for every machine with cmake -DRESILIN_INSTRUCTION_SETS=all");
}

}  // namespace

std::string_view name(InstructionSet set) {
  switch (set) {
    case InstructionSet::baseline:
      return "baseline";
    case InstructionSet::avx2:
      return "avx2";
    case InstructionSet::avx512:
      return "avx512";
  }
  return "";
}

std::vector<std::string> names(std::span<const InstructionSet> sets) {
  std::vector<std::string> all;
  for (const InstructionSet set : sets) all.emplace_back(name(set));
  return all;
}

std::vector<InstructionSet> compiled_instruction_sets() {
  return {CompiledSets::all.begin(), CompiledSets::all.end()};
}

std::vector<InstructionSet> available_instruction_sets() {
  std::vector<InstructionSet> sets = compiled_instruction_sets();
  std::erase_if(sets, [](InstructionSet set) { return !processor_runs(set); });
  return sets;
}

std::optional<InstructionSet> requested_instruction_set() {
  static const std::optional<InstructionSet> requested = read_request();
  return requested;
}

InstructionSet preferred_instruction_set() {
  static const InstructionSet chosen = choose();
  return chosen;
}

}  // namespace resilin
