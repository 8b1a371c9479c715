// Bouncing photon paths off Lambertian surfaces, written once for vectors of kLanes (GCC and Clang
// vector extensions) or for plain numbers (1). Included with PHOTON_SPLAT_LANES and
// PHOTON_SPLAT_KERNEL defined, in files compiled for one instruction set each and without
// contraction of products and sums: each formula is that of the function of vec.h or sampling.h
// that is named beside it, step by step, so that all give the same numbers.
#include <cstring>

#include "photons/photon_paths.h"

#if PHOTON_SPLAT_LANES > 1
#include <immintrin.h>
#endif

namespace photon_splat {
namespace {

constexpr uint32_t kLanes = PHOTON_SPLAT_LANES;
#if PHOTON_SPLAT_LANES == 1
using Words = uint32_t;
using Signed = int32_t;
using Floats = float;
using Mask = bool;
template <class To, class From>
inline To converted(From x) {
  return static_cast<To>(x);
}
inline uint32_t bits_of(Mask m) { return m; }
inline Floats root(Floats x) { return __builtin_sqrtf(x); }
#else
typedef uint32_t Words __attribute__((vector_size(4 * kLanes)));
typedef int32_t Signed __attribute__((vector_size(4 * kLanes)));
typedef float Floats __attribute__((vector_size(4 * kLanes)));
using Mask = Signed;
template <class To, class From>
inline To converted(const From& x) {
  return __builtin_convertvector(x, To);
}
#if PHOTON_SPLAT_LANES == 16
inline uint32_t bits_of(Mask m) { return _mm512_movepi32_mask(reinterpret_cast<__m512i>(m)); }
inline Floats root(Floats x) {
  return reinterpret_cast<Floats>(_mm512_maskz_sqrt_ps(0xffff, reinterpret_cast<__m512>(x)));
}
#elif PHOTON_SPLAT_LANES == 8
inline uint32_t bits_of(Mask m) {
  return static_cast<uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(m)));
}
inline Floats root(Floats x) {
  return reinterpret_cast<Floats>(_mm256_sqrt_ps(reinterpret_cast<__m256>(x)));
}
#else
inline uint32_t bits_of(Mask m) {
  return static_cast<uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(m)));
}
inline Floats root(Floats x) {
  return reinterpret_cast<Floats>(_mm_sqrt_ps(reinterpret_cast<__m128>(x)));
}
#endif
#endif

template <class To, class From>
inline To cast(const From& from) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  std::memcpy(&to, &from, sizeof to);
  return to;
}
template <class To, class Element>
inline To load(const Element* from) {
  To to;
  std::memcpy(&to, from, sizeof to);
  return to;
}
template <class Element, class From>
inline void keep(Element* to, const From& from) {
  std::memcpy(to, &from, sizeof from);
}

inline Floats all(float x) { return Floats{} + x; }
inline Floats magnitude(Floats x) { return cast<Floats>(cast<Words>(x) & 0x7fffffffu); }
inline Floats with_sign_of(Floats x, Floats sign) {
  return cast<Floats>((cast<Words>(x) & 0x7fffffffu) | (cast<Words>(sign) & 0x80000000u));
}
inline Floats larger(Floats a, Floats b) { return a < b ? b : a; }   // std::max(a, b)
inline Floats smaller(Floats a, Floats b) { return b < a ? b : a; }  // std::min(a, b)

struct Vectors {
  Floats x, y, z;
  Vectors operator-() const { return {-x, -y, -z}; }
};
inline Vectors operator*(const Vectors& a, Floats s) { return {a.x * s, a.y * s, a.z * s}; }
inline Floats dot(const Vectors& a, const Vectors& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vectors chosen(Mask m, const Vectors& a, const Vectors& b) {
  return {m ? a.x : b.x, m ? a.y : b.y, m ? a.z : b.z};
}

// encode_direction()
inline Words encoded(const Vectors& d) {
  const Floats s = 1.0f / (magnitude(d.x) + magnitude(d.y) + magnitude(d.z));
  const Floats u = d.x * s, v = d.y * s, one = all(1);
  const Mask below = d.z < 0.0f;
  const auto quantized = [&](Floats f) __attribute__((always_inline)) {
    f = f < -one ? -one : one < f ? one : f;
    return cast<Words>(converted<Signed>(f * 127.0f + 127.5f)) & 0xffffu;
  };
  const Words x = quantized(below ? with_sign_of(one, u) * (1.0f - magnitude(v)) : u);
  const Words y = quantized(below ? (1.0f - magnitude(u)) * with_sign_of(one, v) : v);
  return (x | y << 8) & 0xffffu;
}

// Random::next() of all lanes. Plain loops: not every instruction set has vectors of 64-bit
// products.
inline void next(uint64_t* state, float* out) {
  for (uint32_t k = 0; k < kBounceLanes; ++k) {
    const uint64_t old = state[k];
    state[k] = old * 6364136223846793005ull + 1442695040888963407ull;
    const uint32_t shifted = static_cast<uint32_t>(((old >> 18) ^ old) >> 27),
                   rotate = static_cast<uint32_t>(old >> 59);
    const uint32_t turned = (shifted >> rotate) | (shifted << ((32 - rotate) & 31));
    out[k] = static_cast<float>(static_cast<int32_t>(turned >> 8)) * 0x1p-24f;
  }
}

struct alignas(64) Chances {
  float survive[kBounceLanes], u[kBounceLanes], v[kBounceLanes];
};

inline void draw(const PhotonPaths& paths, uint32_t first, Chances& chances, Bounced& out) {
  alignas(64) uint64_t once[kBounceLanes], thrice[kBounceLanes];
  for (uint32_t k = 0; k < kBounceLanes; ++k) once[k] = paths.random[first + k];
  next(once, chances.survive);
  for (uint32_t k = 0; k < kBounceLanes; ++k) thrice[k] = once[k];
  next(thrice, chances.u);
  next(thrice, chances.v);
  for (uint32_t k = 0; k < kBounceLanes; ++k)
    out.random[k] = paths.bounces[first + k] ? thrice[k] : once[k];
}

// Basis(n).to_world(sample_cosine_hemisphere({u, v}))
inline Vectors diffuse(const Vectors& n, Floats first, Floats second) {
  constexpr float kPi = 3.14159265358979f;
  const Floats a = 2.0f * first - 1.0f, b = 2.0f * second - 1.0f, one = all(1);
  const Mask wide = magnitude(a) > magnitude(b);
  const Floats r = wide ? a : b;
  const Floats t = kPi / 4 * ((wide ? b : a) / (r == 0.0f ? one : r)), t2 = t * t;
  const Floats cosine =
      1.0f + t2 * (-1 / 2.0f + t2 * (1 / 24.0f + t2 * (-1 / 720.0f + t2 * (1 / 40320.0f))));
  const Floats sine =
      t *
      (1.0f + t2 * (-1 / 6.0f + t2 * (1 / 120.0f + t2 * (-1 / 5040.0f + t2 * (1 / 362880.0f)))));
  const Floats x = r * (wide ? cosine : sine), y = r * (wide ? sine : cosine);
  const Floats z = root(larger(all(0), 1.0f - x * x - y * y));
  const Floats sign = with_sign_of(one, n.z), p = -1.0f / (sign + n.z), q = n.x * n.y * p;
  const Vectors tangent{1.0f + sign * n.x * n.x * p, sign * q, -sign * n.x},
      bitangent{q, sign + n.y * n.y * p, -n.y};
  return {tangent.x * x + bitangent.x * y + n.x * z, tangent.y * x + bitangent.y * y + n.y * z,
          tangent.z * x + bitangent.z * y + n.z * z};
}

inline void bounce(const PhotonPaths& paths, uint32_t i, const RayHits& hits,
                   const PlainSurfaces& surfaces, const Chances& chances,
                   const BounceSettings& settings, uint32_t k, Bounced& out) {
  const Vectors position{load<Floats>(hits.x + k), load<Floats>(hits.y + k),
                         load<Floats>(hits.z + k)};
  const Vectors ng{load<Floats>(hits.nx + k), load<Floats>(hits.ny + k), load<Floats>(hits.nz + k)};
  const Vectors smooth{load<Floats>(surfaces.nx + k), load<Floats>(surfaces.ny + k),
                       load<Floats>(surfaces.nz + k)};
  const Vectors way{load<Floats>(paths.direction_x + i), load<Floats>(paths.direction_y + i),
                    load<Floats>(paths.direction_z + i)};
  const Mask back = load<Words>(hits.back + k) != 0u;
  const Floats len = root(dot(smooth, smooth));
  const Vectors front = smooth * (1.0f / len);
  const Vectors ns = chosen(len > 0.0f, chosen(back, -front, front), ng);
  const Floats cos_shading = -dot(way, ns), cos_geometric = -dot(way, ng);
  const Mask faces = (cos_shading > 0.0f) & (cos_geometric > 0.0f);

  const Words bounces = load<Words>(paths.bounces + i);
  const Mask direct = bounces == 0u;
  const Floats share = settings.share + settings.share_of_caustic * load<Floats>(paths.caustic + i);
  const Floats stored = share * cos_shading / cos_geometric;
  const Vectors power{load<Floats>(paths.red + i), load<Floats>(paths.green + i),
                      load<Floats>(paths.blue + i)};
  keep(out.stored_red + k, power.x * stored);
  keep(out.stored_green + k, power.y * stored);
  keep(out.stored_blue + k, power.z * stored);
  keep(out.directions + k, encoded(ng) | encoded(-way) << 16);
  out.stores |= bits_of(faces & (bounces != 0u) & (share > 0.0f)) << k;

  const Floats ratio = cos_shading / cos_geometric;
  const Vectors scattered{power.x * (load<Floats>(surfaces.red + k) * ratio),
                          power.y * (load<Floats>(surfaces.green + k) * ratio),
                          power.z * (load<Floats>(surfaces.blue + k) * ratio)};
  const Floats most = larger(larger(scattered.x, scattered.y), scattered.z);
  const Floats survival = smaller(all(1), most / load<Floats>(paths.reference + i));
  out.goes_on |= bits_of(faces & (bounces != settings.max_bounces) & (survival > 0.0f) &
                         (load<Floats>(chances.survive + k) < survival))
                 << k;
  const Vectors kept = scattered * (1.0f / survival);
  keep(out.red + k, kept.x);
  keep(out.green + k, kept.y);
  keep(out.blue + k, kept.z);
  const Floats farthest =
      larger(larger(magnitude(position.x), magnitude(position.y)), magnitude(position.z));
  const Floats epsilon = larger(4e-6f * larger(farthest, load<Floats>(hits.distance + k)),
                                load<Floats>(surfaces.rounding + k));
  keep(out.origin_x + k, position.x + ng.x * epsilon);
  keep(out.origin_y + k, position.y + ng.y * epsilon);
  keep(out.origin_z + k, position.z + ng.z * epsilon);
  const Vectors on =
      diffuse(ng, direct ? load<Floats>(paths.first_u + i) : load<Floats>(chances.u + k),
              direct ? load<Floats>(paths.first_v + i) : load<Floats>(chances.v + k));
  keep(out.direction_x + k, on.x);
  keep(out.direction_y + k, on.y);
  keep(out.direction_z + k, on.z);
}

}  // namespace

void PHOTON_SPLAT_KERNEL(const PhotonPaths& paths, uint32_t first, const RayHits& hits,
                         const PlainSurfaces& surfaces, const BounceSettings& settings,
                         Bounced& out) {
  Chances chances;
  draw(paths, first, chances, out);
  out.stores = out.goes_on = 0;
  for (uint32_t k = 0; k < kBounceLanes; k += kLanes)
    bounce(paths, first + k, hits, surfaces, chances, settings, k, out);
}

}  // namespace photon_splat
