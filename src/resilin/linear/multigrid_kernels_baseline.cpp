#define RESILIN_KERNELS multigrid_kernels_baseline
#include "resilin/linear/multigrid_kernels.inl"
