#define RESILIN_KERNELS block_kernels_avx2
#define RESILIN_INSTRUCTION_SET "AVX2"
#include "resilin/linear/block_kernels.inl"
