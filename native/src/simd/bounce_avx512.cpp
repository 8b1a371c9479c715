#define PHOTON_SPLAT_LANES 16
#define PHOTON_SPLAT_KERNEL bounce_avx512
#include "simd/bounce_kernel.inl"
