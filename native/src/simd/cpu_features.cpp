#include "simd/cpu_features.h"

#if defined(__x86_64__) || defined(_M_X64)
#define PHOTON_SPLAT_ASKS_CPU
#ifdef _MSC_VER
#include <intrin.h>
#else
#include <cpuid.h>
#endif
#endif

namespace photon_splat {

namespace {

// Intel's Software Developer's Manual, volume 2, CPUID, and volume 1, 13.3, XCR0.
constexpr uint32_t kFma = 1u << 12, kSse42 = 1u << 20, kOsxsave = 1u << 27, kAvx = 1u << 28;
constexpr uint32_t kAvx2 = 1u << 5, kAvx512f = 1u << 16, kAvx512dq = 1u << 17, kAvx512bw = 1u << 30,
                   kAvx512vl = 1u << 31;
constexpr uint64_t kXmmYmm = 0x06, kMaskAndZmm = 0xe0;

constexpr bool has(uint64_t word, uint64_t bits) { return (word & bits) == bits; }

#ifdef PHOTON_SPLAT_ASKS_CPU
struct Registers {
  uint32_t eax, ebx, ecx, edx;
};

Registers cpuid(uint32_t leaf) {
#ifdef _MSC_VER
  int out[4];
  __cpuidex(out, static_cast<int>(leaf), 0);
  return {static_cast<uint32_t>(out[0]), static_cast<uint32_t>(out[1]),
          static_cast<uint32_t>(out[2]), static_cast<uint32_t>(out[3])};
#else
  Registers out;
  __cpuid_count(leaf, 0, out.eax, out.ebx, out.ecx, out.edx);
  return out;
#endif
}

uint64_t xcr0() {
#ifdef _MSC_VER
  return _xgetbv(0);
#else
  // The intrinsic wants -mxsave, which would let the compiler use more here than the machine has.
  uint32_t low, high;
  __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return low | uint64_t{high} << 32;
#endif
}

CpuAnswers ask() {
  CpuAnswers answers;
  const uint32_t last = cpuid(0).eax;
  if (last >= 1) answers.leaf1_ecx = cpuid(1).ecx;
  if (last >= 7) answers.leaf7_ebx = cpuid(7).ebx;
  if (has(answers.leaf1_ecx, kOsxsave)) answers.saved = xcr0();
  return answers;
}
#else
CpuAnswers ask() { return {}; }
#endif

}  // namespace

CpuFeatures features_of(const CpuAnswers& answers) {
  CpuFeatures out;
  out.sse42 = has(answers.leaf1_ecx, kSse42);
  out.avx2 = out.sse42 && has(answers.leaf1_ecx, kOsxsave | kAvx | kFma) &&
             has(answers.leaf7_ebx, kAvx2) && has(answers.saved, kXmmYmm);
  out.avx512 = out.avx2 && has(answers.leaf7_ebx, kAvx512f | kAvx512dq | kAvx512bw | kAvx512vl) &&
               has(answers.saved, kXmmYmm | kMaskAndZmm);
  return out;
}

CpuFeatures cpu_features() {
  static const CpuFeatures features = features_of(ask());
  return features;
}

}  // namespace photon_splat
