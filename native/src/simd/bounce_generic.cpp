#define PHOTON_SPLAT_LANES 1
#define PHOTON_SPLAT_KERNEL bounce_generic
#include "simd/bounce_kernel.inl"
