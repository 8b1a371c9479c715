#define PHOTON_SPLAT_LANES 8
#define PHOTON_SPLAT_KERNEL sobol_avx2
#include "sobol_kernel.inl"
