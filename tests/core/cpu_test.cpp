#include "resilin/core/cpu.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "resilin/core/error.hpp"

#define RESILIN_COMPILED_SETS InstructionSet::avx2
#include "resilin/core/kernel_dispatch.hpp"

namespace resilin {
namespace {

TEST(InstructionSets, AreAvailableWhereTheyAreCompiledAndTheProcessorRunsThem) {
  const std::vector<InstructionSet> available = available_instruction_sets();
  for (const InstructionSet set : compiled_instruction_sets())
    EXPECT_EQ(std::ranges::count(available, set), processor_runs(set) ? 1 : 0) << name(set);
  EXPECT_TRUE(std::ranges::is_sorted(available)) << "the slowest first";
  EXPECT_EQ(std::ranges::count(available, preferred_instruction_set()), 1);
}

TEST(InstructionSets, RunOnEveryProcessorWhenTheyAreTheBaseline) {
  EXPECT_TRUE(processor_runs(InstructionSet::baseline));
}

TEST(KernelDispatch, GivesTheKernelsOfASetAndRefusesOneThatIsNotCompiled) {
  static constexpr int kernels[] = {1, 2, 3};
  const auto kernels_of = []<InstructionSet set>() { return &kernels[static_cast<int>(set)]; };
  EXPECT_EQ(*CompiledSets::kernels(InstructionSet::avx2, kernels_of), 2);
  EXPECT_THROW(CompiledSets::kernels(InstructionSet::avx512, kernels_of), InputError);
}

}  // namespace
}  // namespace resilin
