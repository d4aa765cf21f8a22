#pragma once

namespace resilin::detail {

struct BlockKernels;
struct MultigridKernels;

/// What the inner loops are compiled for, the plainest first.
enum class InstructionSet { baseline, avx2, avx512 };

/// The kernels of one instruction set; null where the build has none or this machine does not run them.
const BlockKernels* block_kernels_for(InstructionSet set);
const MultigridKernels* multigrid_kernels_for(InstructionSet set);

}  // namespace resilin::detail
