// Four numbers that are computed with at once: the compiler's vectors where it has them, else plain
// arrays.
#pragma once

#include <cstdint>
#include <cstring>

namespace photon_splat::nodes {

#if defined(__GNUC__)

using Words = uint32_t __attribute__((vector_size(16)));
using Signed = int32_t __attribute__((vector_size(16)));
using Floats = float __attribute__((vector_size(16)));

inline Floats to_floats(const Words& x) { return __builtin_convertvector(x, Floats); }
inline Floats to_floats(const Signed& x) { return __builtin_convertvector(x, Floats); }

#else

template <class T>
struct Lanes {
  T lane[4]{};

  T& operator[](int i) { return lane[i]; }
  T operator[](int i) const { return lane[i]; }
};
using Words = Lanes<uint32_t>;
using Signed = Lanes<int32_t>;
using Floats = Lanes<float>;

#define LANEWISE(op)                                                        \
  template <class T>                                                        \
  Lanes<T> operator op(Lanes<T> a, const Lanes<T>& b) {                     \
    for (int i = 0; i < 4; ++i) a.lane[i] = a.lane[i] op b.lane[i];         \
    return a;                                                               \
  }                                                                         \
  template <class T, class S>                                               \
  Lanes<T> operator op(Lanes<T> a, S b) {                                   \
    for (int i = 0; i < 4; ++i) a.lane[i] = a.lane[i] op static_cast<T>(b); \
    return a;                                                               \
  }                                                                         \
  template <class T, class S>                                               \
  Lanes<T>& operator op## = (Lanes<T> & a, const S& b) {                    \
    return a = a op b;                                                      \
  }
LANEWISE(+)
LANEWISE(-)
LANEWISE(*)
LANEWISE(/)
LANEWISE(&)
LANEWISE(|)
LANEWISE(^)
LANEWISE(<<)
LANEWISE(>>)
#undef LANEWISE
template <class T>
Floats to_floats(const Lanes<T>& x) {
  Floats f;
  for (int i = 0; i < 4; ++i) f[i] = static_cast<float>(x[i]);
  return f;
}

#endif

// The same bits as another type.
template <class To, class From>
To bits_of(const From& from) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  std::memcpy(&to, &from, sizeof to);
  return to;
}

}  // namespace photon_splat::nodes
