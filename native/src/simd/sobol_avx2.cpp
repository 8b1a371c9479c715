#define PHOTON_SPLAT_LANES 8
#define PHOTON_SPLAT_KERNEL sobol_avx2
#include "simd/sobol_kernel.inl"
