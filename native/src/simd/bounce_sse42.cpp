#define PHOTON_SPLAT_LANES 4
#define PHOTON_SPLAT_KERNEL bounce_sse42
#include "simd/bounce_kernel.inl"
