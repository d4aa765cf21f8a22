// Prints the best instruction set of this machine, at configuration.
#include <cstdio>

#include "resilin/core/instruction_set.hpp"

int main() {
  using resilin::InstructionSet;
  const bool runs_avx2 = processor_runs(InstructionSet::avx2);
  std::fputs(processor_runs(InstructionSet::avx512) ? "avx512" : runs_avx2 ? "avx2" : "baseline", stdout);
  return 0;
}
