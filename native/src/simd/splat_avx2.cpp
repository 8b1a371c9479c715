#define PHOTON_SPLAT_LANES 8
#define PHOTON_SPLAT_KERNEL splat_part_avx2
#include "splat_kernel.inl"
