#define PHOTON_SPLAT_LANES 16
#define PHOTON_SPLAT_KERNEL noise_avx512
#include "simd/noise_kernel.inl"
