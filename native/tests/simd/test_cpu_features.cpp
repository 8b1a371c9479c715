#include "simd/cpu_features.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "simd/dispatch.h"

using namespace photon_splat;

namespace {

// A Skylake-X as it answers, and what of it older machines lack.
constexpr CpuAnswers kServer{0x7ffefbff, 0xd39ffffb, 0xe7};

// Sets PHOTON_SPLAT_SIMD while it lives.
struct Allowed {
  explicit Allowed(const char* name) { set(name); }
  ~Allowed() { set(""); }
  static void set(const char* name) {
#ifdef _WIN32
    _putenv_s("PHOTON_SPLAT_SIMD", name);
#else
    setenv("PHOTON_SPLAT_SIMD", name, 1);
#endif
  }
};

int widest() {
  for (int i = 0; i < 4; ++i)
    if (runs_here(static_cast<InstructionSet>(i))) return i;
  return -1;
}

}  // namespace

TEST_CASE(
    "an instruction set needs its bits, and a system that saves its "
    "registers") {
  const auto check = [](const CpuAnswers& answers, bool sse42, bool avx2, bool avx512) {
    const CpuFeatures found = features_of(answers);
    CHECK(found.sse42 == sse42);
    CHECK(found.avx2 == avx2);
    CHECK(found.avx512 == avx512);
  };
  check(kServer, true, true, true);
  check({}, false, false, false);
  const auto without = [](uint32_t leaf1, uint32_t leaf7, uint64_t saved) {
    return CpuAnswers{kServer.leaf1_ecx & ~leaf1, kServer.leaf7_ebx & ~leaf7,
                      kServer.saved & ~saved};
  };
  for (const uint32_t bit : {16u, 17u, 30u, 31u})
    check(without(0, 1u << bit, 0), true, true, false);
  for (const uint64_t state : {0x20u, 0x40u, 0x80u}) check(without(0, 0, state), true, true, false);
  check(without(1u << 12, 0, 0), true, false, false);  // no FMA
  check(without(1u << 28, 0, 0), true, false, false);  // no AVX
  check(without(0, 1u << 5, 0), true, false, false);   // no AVX2
  check(without(0, 0, 0x4), true, false, false);       // upper halves not saved
  check(without(1u << 27, 0, ~0ull), true, false,
        false);  // a system without XSAVE
  check(without(1u << 20, 0, 0), false, false, false);
}

#if defined(__x86_64__) && defined(__linux__)
TEST_CASE("this machine has what the compiler's own question says") {
  const CpuFeatures here = cpu_features();
  __builtin_cpu_init();
  CHECK(here.sse42 == bool(__builtin_cpu_supports("sse4.2")));
  CHECK(here.avx2 == (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")));
  CHECK(here.avx512 == (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")));
}
#endif

TEST_CASE("PHOTON_SPLAT_SIMD names the widest instruction set that may be used") {
  const int own = widest();
  for (int i = 0; i < 4; ++i) {
    const Allowed allowed(kInstructionSetNames[static_cast<size_t>(i)]);
    CHECK(widest() == std::max(i, own));
  }
  CHECK(widest() == own);
  const Allowed unknown("sse9");
#ifdef PHOTON_SPLAT_VECTOR_KERNELS
  CHECK_THROWS_WITH_AS(runs_here(InstructionSet::kSse42),
                       "The environment variable PHOTON_SPLAT_SIMD must be "
                       "avx512, avx2, sse42 or generic, and is 'sse9'.",
                       std::invalid_argument);
#endif
  CHECK(runs_here(InstructionSet::kGeneric));
}
