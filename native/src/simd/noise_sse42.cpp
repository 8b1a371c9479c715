#define PHOTON_SPLAT_LANES 4
#define PHOTON_SPLAT_KERNEL noise_sse42
#include "simd/noise_kernel.inl"
