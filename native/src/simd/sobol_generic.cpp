#define PHOTON_SPLAT_LANES 1
#define PHOTON_SPLAT_KERNEL sobol_generic
#include "simd/sobol_kernel.inl"
