#include "math/sampling.h"

namespace photon_splat {

SobolKernel choose_sobol_kernel(const std::string& name) {
#if defined(__x86_64__) && defined(__GNUC__)
  __builtin_cpu_init();
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  if (avx512 && (name.empty() || name == "avx512")) return sobol_avx512;
  if (__builtin_cpu_supports("avx2") && (name.empty() || name == "avx2")) return sobol_avx2;
  if (__builtin_cpu_supports("sse4.2") && (name.empty() || name == "sse42")) return sobol_sse42;
#endif
  return name.empty() || name == "generic" ? sobol_generic : nullptr;
}

void SobolPair::fill(uint32_t first, uint32_t count, Run& out) const {
  static_assert(kMost % kSobolLanes == 0);
  static const SobolKernel kernel = choose_sobol_kernel();
  kernel({key_, x_key_, y_key_}, first, count, out.x, out.y);
}

}  // namespace photon_splat
