#define PHOTON_SPLAT_LANES 8
#define PHOTON_SPLAT_KERNEL splat_block_avx2
#include "splat_kernel.inl"
