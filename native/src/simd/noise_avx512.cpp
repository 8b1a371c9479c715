#define PHOTON_SPLAT_LANES 16
#define PHOTON_SPLAT_KERNEL noise_avx512
#include "noise_kernel.inl"
