#define PHOTON_SPLAT_LANES 8
#define PHOTON_SPLAT_KERNEL bounce_avx2
#include "simd/bounce_kernel.inl"
