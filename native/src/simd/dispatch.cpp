#include "simd/dispatch.h"

#include <cstdlib>
#include <stdexcept>

#include "simd/cpu_features.h"

namespace photon_splat {

#ifdef PHOTON_SPLAT_VECTOR_KERNELS
namespace {

// The widest that PHOTON_SPLAT_SIMD allows.
InstructionSet widest_allowed() {
  const char* name = std::getenv("PHOTON_SPLAT_SIMD");
  if (!name || !*name) return InstructionSet::kAvx512;
  for (size_t i = 0; i < kInstructionSetNames.size(); ++i)
    if (std::string(name) == kInstructionSetNames[i]) return static_cast<InstructionSet>(i);
  throw std::invalid_argument(
      "The environment variable PHOTON_SPLAT_SIMD must be avx512, avx2, sse42 or generic, and is '" +
      std::string(name) + "'.");
}

}  // namespace
#endif

bool runs_here(InstructionSet set) {
  if (set == InstructionSet::kGeneric) return true;
#ifdef PHOTON_SPLAT_VECTOR_KERNELS
  if (set < widest_allowed()) return false;
  const CpuFeatures here = cpu_features();
  switch (set) {
    case InstructionSet::kAvx512: return here.avx512;
    case InstructionSet::kAvx2: return here.avx2;
    case InstructionSet::kSse42: return here.sse42;
    case InstructionSet::kGeneric: break;
  }
#endif
  return false;
}

}  // namespace photon_splat
