#define PHOTON_SPLAT_LANES 8
#define PHOTON_SPLAT_KERNEL noise_avx2
#include "simd/noise_kernel.inl"
