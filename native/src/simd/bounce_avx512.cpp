#define PHOTON_SPLAT_LANES 16
#define PHOTON_SPLAT_KERNEL bounce_avx512
#include "bounce_kernel.inl"
