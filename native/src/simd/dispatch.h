// Which variant of a kernel this machine runs.
#pragma once

#include <array>
#include <string>

// GCC's and Clang's vector extensions, for the one processor that there are kernels for.
#if defined(__x86_64__) && defined(__GNUC__)
#define PHOTON_SPLAT_VECTOR_KERNELS
#endif

namespace photon_splat {

// In the order of preference.
enum class InstructionSet { kAvx512, kAvx2, kSse42, kGeneric };
inline constexpr std::array<const char*, 4> kInstructionSetNames = {"avx512", "avx2", "sse42",
                                                                    "generic"};

// Whether this machine and this build have it, and the environment variable PHOTON_SPLAT_SIMD, the
// name of the widest one that may be used, allows it. std::invalid_argument if that is no name.
bool runs_here(InstructionSet set);

// By InstructionSet.
template <class Kernel>
using KernelVariants = std::array<Kernel, 4>;

// "generic", "sse42", "avx2", "avx512"; empty: the widest that this machine runs. nullptr for one
// that it does not run. `chosen`, if any, is told the name.
template <class Kernel>
Kernel choose_variant(const KernelVariants<Kernel>& variants, const std::string& name,
                      std::string* chosen = nullptr) {
  for (size_t i = 0; i < variants.size(); ++i) {
    if (!runs_here(static_cast<InstructionSet>(i))) continue;
    if (!name.empty() && name != kInstructionSetNames[i]) continue;
    if (chosen) *chosen = kInstructionSetNames[i];
    return variants[i];
  }
  return nullptr;
}

// The variants of the kernel NAME_generic, ...; other processors and compilers have that one alone.
#ifdef PHOTON_SPLAT_VECTOR_KERNELS
#define PHOTON_SPLAT_VARIANTS(NAME) {NAME##_avx512, NAME##_avx2, NAME##_sse42, NAME##_generic}
#else
#define PHOTON_SPLAT_VARIANTS(NAME) {nullptr, nullptr, nullptr, NAME##_generic}
#endif

}  // namespace photon_splat
