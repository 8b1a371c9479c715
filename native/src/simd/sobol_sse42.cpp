#define PHOTON_SPLAT_LANES 4
#define PHOTON_SPLAT_KERNEL sobol_sse42
#include "simd/sobol_kernel.inl"
