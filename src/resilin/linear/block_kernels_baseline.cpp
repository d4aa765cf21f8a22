#define RESILIN_KERNELS block_kernels_baseline
#define RESILIN_INSTRUCTION_SET "baseline"
#include "resilin/linear/block_kernels.inl"
