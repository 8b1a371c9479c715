#define PHOTON_SPLAT_LANES 1
#define PHOTON_SPLAT_KERNEL noise_generic
#include "simd/noise_kernel.inl"
