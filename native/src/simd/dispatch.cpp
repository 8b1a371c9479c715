#include "simd/dispatch.h"

namespace photon_splat {

bool runs_here(InstructionSet set) {
#if defined(__x86_64__) && defined(__GNUC__)
  __builtin_cpu_init();
  switch (set) {
    case InstructionSet::kAvx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
    case InstructionSet::kAvx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case InstructionSet::kSse42: return __builtin_cpu_supports("sse4.2");
    case InstructionSet::kGeneric: return true;
  }
#endif
  return set == InstructionSet::kGeneric;
}

}  // namespace photon_splat
