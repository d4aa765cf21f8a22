#include "resilin/core/cpu.hpp"

#include <cstdlib>

namespace resilin {

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

std::vector<InstructionSet> available_instruction_sets() {
  std::vector<InstructionSet> sets = {InstructionSet::baseline};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) sets.push_back(InstructionSet::avx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw"))
    sets.push_back(InstructionSet::avx512);
#endif
  return sets;
}

std::optional<InstructionSet> find_instruction_set(std::string_view wanted) {
  for (const InstructionSet set : available_instruction_sets())
    if (name(set) == wanted) return set;
  return std::nullopt;
}

InstructionSet preferred_instruction_set() {
  const char* variable = std::getenv("RESILIN_ISA");
  if (variable != nullptr)
    if (const auto set = find_instruction_set(variable)) return *set;
  return available_instruction_sets().back();
}

}  // namespace resilin
