#define RESILIN_KERNELS block_kernels_avx512
#define RESILIN_INSTRUCTION_SET "AVX-512"
#include "resilin/linear/block_kernels.inl"
