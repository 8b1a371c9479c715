#define PHOTON_SPLAT_LANES 16
#define PHOTON_SPLAT_KERNEL sobol_avx512
#include "simd/sobol_kernel.inl"
