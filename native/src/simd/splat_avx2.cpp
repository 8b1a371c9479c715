#define PHOTON_SPLAT_LANES 8
#define PHOTON_SPLAT_KERNEL splat_part_avx2
#include "simd/splat_kernel.inl"
