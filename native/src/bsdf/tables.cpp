#include "bsdf/tables.h"

#include <memory>

#include "bsdf/microfacet.h"

namespace photon_splat {
namespace {

constexpr float kMinMu = 1e-3f;
constexpr int kFine = 377, kCoarse = 144;  // facets per entry: about 0.1 % of error

// Position between grid points 0 .. n - 1 of a value in [0, 1].
struct Between {
  int index;
  float part;
  Between(float x, int n) {
    const float f = saturate(x) * static_cast<float>(n - 1);
    index = std::min(static_cast<int>(f), n - 2);
    part = f - static_cast<float>(index);
  }
};

float lerp(float a, float b, float t) { return a + (b - a) * t; }

template <int N>
float bilinear(const float (&table)[N][N], const Between& r, const Between& c) {
  const float* p = table[r.index];
  const float* q = table[r.index + 1];
  return lerp(lerp(p[c.index], p[c.index + 1], c.part), lerp(q[c.index], q[c.index + 1], c.part),
              r.part);
}

// N points spread evenly over the unit disc: a spiral by the golden angle (Vogel 1979).
template <int N>
struct Disk {
  Vec2 points[N];
  Disk() {
    for (int i = 0; i < N; ++i) {
      const float r = std::sqrt((static_cast<float>(i) + 0.5f) / N),
                  phi = kGoldenAngle * static_cast<float>(i);
      points[i] = {r * std::cos(phi), r * std::sin(phi)};
    }
  }
};

// Light that a facet refracts towards the wrong side counts, as it does in Cycles' tables (rays
// that leave glass at grazing angles: measured). Sums over facets seen from mu: visit(reflected
// share G2/G1, refracted share, cos to the facet).
template <int N, class Visit>
void visit_facets(const Disk<N>& disk, float roughness, float mu, float ior, Visit&& visit) {
  Facets facets;
  facets.ax = facets.ay = std::max(sqr(roughness), 1e-4f);
  mu = std::max(mu, kMinMu);
  const Vec3 wo{std::sqrt(1 - sqr(mu)), 0, mu};
  const float lambda_o = facets.lambda(wo);
  const auto share = [&](const Vec3& w) {
    return (1 + lambda_o) / (1 + lambda_o + facets.lambda(w));
  };
  for (const Vec2& point : disk.points) {
    const Vec3 m = facets.visible(wo, point);
    const float om = dot(wo, m);
    if (!(om > 0)) continue;
    const Vec3 reflected = m * (2 * om) - wo;
    Vec3 refracted;
    const bool through = ior != 1 && refract(wo, m, ior, &refracted);
    visit(reflected.z > 0 ? share(reflected) : 0.0f, through ? share(refracted) : 0.0f, om);
  }
}

// Tables over roughness and mu, and the mean over mu.
template <int N>
struct Plane {
  float directional[N][N];
  float mean[N];

  void take_means() {
    for (int r = 0; r < N; ++r) {
      float sum = 0;  // trapezoids, exact for piecewise linear
      for (int c = 0; c + 1 < N; ++c) {
        const float m0 = static_cast<float>(c) / (N - 1), m1 = static_cast<float>(c + 1) / (N - 1);
        const float a = directional[r][c], b = directional[r][c + 1];
        sum += (m1 - m0) * (a * (2 * m0 + m1) + b * (m0 + 2 * m1)) / 3;
      }
      mean[r] = sum;
    }
  }
};

struct GgxTable {
  static constexpr int N = 32;
  Plane<N> plane;
  GgxTable() {
    const Disk<kFine> disk;
    for (int r = 0; r < N; ++r)
      for (int c = 0; c < N; ++c) {
        float sum = 0;
        visit_facets(disk, static_cast<float>(r) / (N - 1), static_cast<float>(c) / (N - 1), 1,
                     [&](float reflected, float, float) { sum += reflected; });
        plane.directional[r][c] = sum / kFine;
      }
    plane.take_means();
  }
};

constexpr int kIorSteps = 16;

float ior_coordinate(float ior) { return std::sqrt(std::abs((ior - 1) / (ior + 1))); }
float ior_of_coordinate(float z) {
  z = std::min(sqr(z), 0.99f);
  return std::max((1 + z) / (1 - z), 1 + 1e-4f);
}

struct GlassTable {
  static constexpr int N = 16;
  Plane<N> planes[kIorSteps];
  explicit GlassTable(bool inverse) {
    const Disk<kCoarse> disk;
    for (int k = 0; k < kIorSteps; ++k) {
      const float n = ior_of_coordinate(static_cast<float>(k) / (kIorSteps - 1)),
                  ior = inverse ? 1 / n : n;
      for (int r = 0; r < N; ++r)
        for (int c = 0; c < N; ++c) {
          float sum = 0;
          visit_facets(disk, static_cast<float>(r) / (N - 1), static_cast<float>(c) / (N - 1), ior,
                       [&](float reflected, float refracted, float cosine) {
                         const float f = fresnel_dielectric(cosine, ior);
                         sum += f * reflected + (1 - f) * refracted;
                       });
          planes[k].directional[r][c] = sum / kCoarse;
        }
      planes[k].take_means();
    }
  }
};

struct RiseTable {
  static constexpr int N = 16;
  float rise[kIorSteps][N][N];
  RiseTable() {
    const Disk<kCoarse> disk;
    for (int k = 0; k < kIorSteps; ++k) {
      const float ior = ior_of_coordinate(static_cast<float>(k) / (kIorSteps - 1)),
                  f0 = f0_from_ior(ior);
      for (int r = 0; r < N; ++r)
        for (int c = 0; c < N; ++c) {
          float sum = 0;
          visit_facets(disk, static_cast<float>(r) / (N - 1), static_cast<float>(c) / (N - 1), 1,
                       [&](float reflected, float, float cosine) {
                         if (reflected > 0)
                           sum += saturate((fresnel_dielectric(cosine, ior) - f0) / (1 - f0));
                       });
          rise[k][r][c] = sum / kCoarse;
        }
    }
  }
};

}  // namespace

Albedo ggx_albedo(float roughness, float mu) {
  static const GgxTable table;
  const Between r(roughness, GgxTable::N), c(mu, GgxTable::N);
  return {bilinear(table.plane.directional, r, c),
          lerp(table.plane.mean[r.index], table.plane.mean[r.index + 1], r.part)};
}

Albedo glass_albedo(float roughness, float mu, float ior) {
  const auto look_up = [&](const GlassTable& table) {
    const Between r(roughness, GlassTable::N), c(mu, GlassTable::N),
        z(ior_coordinate(ior), kIorSteps);
    const auto &p = table.planes[z.index], &q = table.planes[z.index + 1];
    return Albedo{lerp(bilinear(p.directional, r, c), bilinear(q.directional, r, c), z.part),
                  lerp(lerp(p.mean[r.index], p.mean[r.index + 1], r.part),
                       lerp(q.mean[r.index], q.mean[r.index + 1], r.part), z.part)};
  };
  if (ior >= 1) {
    static const auto denser = std::make_unique<const GlassTable>(false);
    return look_up(*denser);
  }
  static const auto thinner = std::make_unique<const GlassTable>(true);
  return look_up(*thinner);
}

float dielectric_rise(float roughness, float mu, float ior) {
  static const auto table = std::make_unique<const RiseTable>();
  const Between r(roughness, RiseTable::N), c(mu, RiseTable::N), z(ior_coordinate(ior), kIorSteps);
  return lerp(bilinear(table->rise[z.index], r, c), bilinear(table->rise[z.index + 1], r, c),
              z.part);
}

}  // namespace photon_splat
