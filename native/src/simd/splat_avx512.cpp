#define PHOTON_SPLAT_LANES 16
#define PHOTON_SPLAT_KERNEL splat_part_avx512
#include "simd/splat_kernel.inl"
