#define PHOTON_SPLAT_LANES 4
#define PHOTON_SPLAT_KERNEL splat_part_sse42
#include "simd/splat_kernel.inl"
