// What the processor and the system offer: asked of the processor itself, the same way on every
// platform and with every compiler.
#pragma once

#include <cstdint>

namespace photon_splat {

struct CpuFeatures {
  bool sse42 = false;
  bool avx2 = false;    // with fused products and sums
  bool avx512 = false;  // F, VL, DQ and BW
};

// What cpuid and xgetbv answer; 0 where the processor has no such leaf.
struct CpuAnswers {
  uint32_t leaf1_ecx = 0;
  uint32_t leaf7_ebx = 0;
  uint64_t saved = 0;  // registers that the system saves when it switches threads: XCR0
};

// A vector instruction may be used only where the system saves its registers.
CpuFeatures features_of(const CpuAnswers& answers);

// Of this machine; none on other processors than x86-64.
CpuFeatures cpu_features();

}  // namespace photon_splat
