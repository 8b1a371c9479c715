// Deltas, shading normals, what is gathered, and inputs that nobody should give.
#include <doctest/doctest.h>

#include <limits>

#include "support/approx.h"
#include "support/bsdf_cases.h"

using namespace photon_splat;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                kInf = std::numeric_limits<float>::infinity();

Bsdf at(Transport transport, const Vec3& wo, const Vec3& ng, const Vec3& ns,
        const std::function<void(Bsdf&)>& fill) {
  const bool behind = dot(wo, ng) < 0;
  Bsdf bsdf(transport, wo, behind ? -ng : ng, behind ? -ns : ns, behind);
  fill(bsdf);
  bsdf.finish();
  return bsdf;
}

Bsdf flat(const Vec3& wo, const std::function<void(Bsdf&)>& fill,
          Transport transport = Transport::kRadiance) {
  return at(transport, wo, kUp, kUp, fill);
}

void check_sane(const Bsdf& bsdf) {
  CHECK(is_finite(bsdf.emission()));
  CHECK(is_finite(bsdf.transparency()));
  CHECK(is_finite(bsdf.gather()));
  CHECK(is_finite(bsdf.albedo()));
  for (int i = 0; i < 32; ++i) {
    const Vec2 u = sobol_2d(uint32_t(i), 0, 1), v = sobol_2d(uint32_t(i), 1, 1);
    float pdf = -1;
    Rgb rest, diffuse;
    CHECK(is_finite(bsdf.evaluate(sample_sphere(u), &pdf, &rest, &diffuse)));
    CHECK(std::isfinite(pdf));
    CHECK(pdf >= 0);
    CHECK(is_finite(rest));
    CHECK(is_finite(diffuse));
    if (const auto s = bsdf.sample(v.x, u)) {
      CHECK(is_finite(s->weight));
      CHECK(is_finite(s->rest));
      CHECK(s->weight.x >= 0);
      CHECK(length(s->direction) == approx(1).epsilon(1e-3));
    }
  }
}

// Closures with normals that are neither the surface's own nor its shading normal.
std::vector<std::function<void(Bsdf&)>> bent_closures(const Vec3& ns, const Vec3& bump) {
  return {[=](Bsdf& b) { b.add_diffuse(kGrey, bump, 0); },
          [=](Bsdf& b) { b.add_diffuse(kGrey, ns, 0.7f); },
          [=](Bsdf& b) { b.add_translucent(kGrey, bump); },
          [=](Bsdf& b) {
            b.add_glossy(kGrey, bump, Distribution::kMultiGgx, 0.5f, 0.4f, 0.1f, {1, 0, 0});
          },
          [=](Bsdf& b) { b.add_glass(kGrey, bump, Distribution::kGgx, 0.5f, 1.5f, 0, 1); },
          [=](Bsdf& b) {
            b.add_principled(kWhite, principled_inputs([=](auto& in) {
                               in.normal = bump, in.coat_normal = ns, in.coat_weight = 0.6f,
                               in.coat_roughness = 0.4f, in.coat_tint = {0.9f, 0.5f, 0.2f},
                               in.sheen_weight = 0.5f;
                               in.transmission_weight = 0.3f, in.metallic = 0.2f;
                             }));
          }};
}

}  // namespace

TEST_CASE("a mirror, a smooth boundary: directions, weights, and their adjoints") {
  const Vec3 wo = direction(0.6f, 0);
  for (Transport transport : {Transport::kRadiance, Transport::kFlux}) {
    const Bsdf mirror = flat(
        wo, [](Bsdf& b) { b.add_glossy(kGrey, kUp, Distribution::kGgx, 0, 0, 0, {}); }, transport);
    CHECK(mirror.only_delta());
    const auto m = mirror.sample(0.5f, {0.5f, 0.5f});
    REQUIRE(m);
    CHECK(m->pdf == 0);
    CHECK(m->roughness == 0);
    CHECK(m->weight.x == approx(0.8));
    CHECK(m->direction.x == approx(-wo.x));
    for (float ior : {1.5f, 0.75f})
      for (bool back : {false, true}) {
        const Vec3 from = back ? -wo : wo;
        const Bsdf glass = flat(
            from, [&](Bsdf& b) { b.add_glass(kWhite, kUp, Distribution::kGgx, 0, ior, 0, 1); },
            transport);
        const float eta = back ? 1 / ior : ior;
        double reflected = 0, refracted = 0;
        constexpr int count = 4096;
        for (int i = 0; i < count; ++i) {
          const auto s = glass.sample(0.5f, {(float(i) + 0.5f) / count, 0.5f});
          REQUIRE(s);
          (s->transmitted ? refracted : reflected) += double(s->weight.x) / count;
          if (s->transmitted) CHECK(-s->direction.x * eta == approx(from.x).epsilon(1e-4));
        }
        const double f = double(fresnel_dielectric(0.6f, eta));
        CHECK(reflected == approx(f).epsilon(1e-3).scale(1));
        CHECK(refracted ==
              approx((1 - f) * (transport == Transport::kFlux ? 1 / double(eta * eta) : 1))
                  .epsilon(1e-3));
      }
  }
}

TEST_CASE(
    "glass that bends nothing lets everything pass straight, whatever its roughness, from either side") {
  for (float roughness : {0.0f, 0.5f, 1.0f})
    for (float ior : {1.0f, 1.001f, 0.999f})
      for (float side : {1.0f, -1.0f})
        for (Transport transport : {Transport::kRadiance, Transport::kFlux}) {
          const Vec3 wo = direction(0.3f * side, 1);
          const Bsdf glass = flat(
              wo,
              [&](Bsdf& b) {
                b.add_glass(kGrey, kUp, Distribution::kMultiGgx, roughness, ior, 0, 1);
              },
              transport);
          CHECK(!glass.scatters());
          CHECK(glass.transparency().x == approx(0.8));
          CHECK(glass.straight().x == approx(0.8));
        }
}

TEST_CASE("with shading normals photons are the exact adjoint of camera paths") {
  const Vec3 ns = normalize({0.3f, 0.1f, 1}), bump = normalize({-0.2f, 0.4f, 1});
  const auto fills = bent_closures(ns, bump);
  for (size_t f = 0; f < fills.size(); ++f)
    for (int i = 0; i < 100; ++i) {
      CAPTURE(f);
      const Vec2 u = sobol_2d(uint32_t(i), 0, 9), v = sobol_2d(uint32_t(i), 1, 9);
      const Vec3 from = direction((i % 3 ? 1.0f : -1.0f) * (0.02f + 0.9f * u.x), 6.28f * u.y);
      const Vec3 to = direction((i % 2 ? 1.0f : -1.0f) * (0.02f + 0.9f * v.x), 6.28f * v.y);
      Rgb flux_rest, rest;
      const Rgb flux =
          at(Transport::kFlux, from, kUp, ns, fills[f]).evaluate(to, nullptr, &flux_rest) /
          std::abs(to.z);
      const Rgb radiance =
          at(Transport::kRadiance, to, kUp, ns, fills[f]).evaluate(from, nullptr, &rest) /
          std::abs(from.z);
      for (int k = 0; k < 3; ++k) {
        CHECK(flux[k] == approx(radiance[k]).epsilon(1e-3));
        CHECK(flux_rest[k] / std::abs(to.z) ==
              approx(rest[k] / std::abs(from.z)).epsilon(1e-3).scale(0.1));
      }
    }
}

TEST_CASE("samples find all the light that bent normals scatter, of photons and beside photons") {
  const Vec3 ns = normalize({0.3f, 0.1f, 1}), bump = normalize({-0.6f, 0.7f, 1});
  const auto fills = bent_closures(ns, bump);
  constexpr int count = 1 << 15;
  for (size_t f = 0; f < fills.size(); ++f)
    for (Transport transport : {Transport::kRadiance, Transport::kFlux})
      for (const Vec3& wo :
           {direction(0.9f, 2.5f), direction(0.4f, 2.0f), direction(-0.6f, -1.0f)}) {
        CAPTURE(f);
        CAPTURE(int(transport));
        CAPTURE(wo.z);
        Bsdf bsdf = at(transport, wo, kUp, ns, fills[f]);
        const bool camera = transport == Transport::kRadiance;
        if (camera) bsdf.prefer_rest(0.05f);
        Rgb sampled{}, wanted{};
        for (int i = 0; i < count; ++i) {
          const Vec2 u = sobol_2d(uint32_t(i), 0, 5), v = sobol_2d(uint32_t(i), 1, 5);
          if (const auto s = bsdf.sample(v.x, u)) sampled += camera ? s->rest : s->weight;
          Rgb rest;
          const Rgb whole = bsdf.evaluate(sample_sphere(u), nullptr, &rest) * (4 * kPi);
          wanted += camera ? rest * (4 * kPi) : whole;
        }
        for (int k = 0; k < 3; ++k)
          CHECK(sampled[k] / count == approx(wanted[k] / count).epsilon(0.01).scale(0.5));
      }
}

TEST_CASE("what photons estimate and the rest make up the whole") {
  const Vec3 wo = direction(0.7f, 0.2f), wi = direction(0.4f, 2);
  const Bsdf lambert = flat(wo, [](Bsdf& b) { b.add_diffuse(kGrey, kUp, 0); });
  CHECK_FALSE(lambert.has_rest());
  CHECK(lambert.gather().x == approx(0.8));
  const Bsdf translucent = flat(wo, [](Bsdf& b) { b.add_translucent(kGrey, kUp); });
  CHECK_FALSE(translucent.has_rest());
  CHECK(translucent.gather_through().x == approx(0.8));
  CHECK(translucent.gather().x == 0);
  for (const BsdfCase& c : bsdf_cases()) {
    CAPTURE(c.name);
    const Bsdf bsdf = make_bsdf(c, wo);
    Rgb rest;
    const Rgb f = bsdf.evaluate(wi, nullptr, &rest);
    CHECK(f.x - rest.x == approx(bsdf.gather().x * wi.z / kPi).epsilon(1e-3));
    const Rgb through = bsdf.evaluate(-wi, nullptr, &rest);
    CHECK(through.x - rest.x == approx(bsdf.gather_through().x * wi.z / kPi).epsilon(1e-3));
  }
}

TEST_CASE("normals bent far away from the surface's gather no photons: nothing is taken off") {
  const Vec3 wo = direction(0.7f, 0.2f);
  for (float degrees : {59.0f, 61.0f, 120.0f, 180.0f}) {
    CAPTURE(degrees);
    const float angle = degrees * kPi / 180;
    const Vec3 bump{std::sin(angle), 0, std::cos(angle)};
    Bsdf bsdf = flat(wo, [&](Bsdf& b) { b.add_diffuse(kGrey, bump, 0); });
    CHECK((bsdf.gather().x > 0) == (degrees < 60));
    bsdf.prefer_rest(0.05f);
    float least = 0;
    for (int i = 0; i < 256; ++i) {
      Rgb rest;
      bsdf.evaluate(sample_sphere(sobol_2d(uint32_t(i), 0, 1)), nullptr, &rest);
      least = std::min(least, rest.x);
    }
    CHECK((least < 0) == (degrees < 60));
  }
}

TEST_CASE("light samples find light through rough glass where no facet refracts it, as in Cycles") {
  const Vec3 wo{std::sin(0.9f), 0, std::cos(0.9f)}, wi{std::sin(0.5f), 0, -std::cos(0.5f)};
  const Bsdf glass =
      flat(wo, [](Bsdf& b) { b.add_glass({1, 1, 1}, kUp, Distribution::kGgx, 0.9f, 1.5f, 0, 1); });
  float pdf = -1, lit_pdf = -1;
  CHECK(is_black(glass.evaluate(wi, &pdf)));
  CHECK(pdf == 0);
  // Radiance of a sheet under a lamp of 100 W and 0.5 m by 0.5 m, 5 m away, in Blender 5.2's Cycles
  const double lamp = 100 / (double(kPi) * 0.25), solid_angle = 0.25 / 25;
  Rgb diffuse;
  const Rgb lit = glass.evaluate_light(wi, {false, true}, &lit_pdf, &diffuse, nullptr);
  CHECK(lit.x * lamp * solid_angle == approx(0.10079).epsilon(0.02));
  CHECK(lit_pdf > 0);
  CHECK(is_black(glass.evaluate_light(wi, {false, false}, &lit_pdf, &diffuse, nullptr)));
}

TEST_CASE("a bump's terminator is soft on both sides, behind it for light samples alone") {
  const Vec3 bump = normalize({0.5f, -0.28f, 1}), wi = direction(-0.267f, 3.1f);
  const Vec3 wo = direction(0.267f, 0);
  const Bsdf behind = flat(wo, [&](Bsdf& b) { b.add_translucent(kWhite, bump); }),
             before = flat(wo, [&](Bsdf& b) { b.add_diffuse(kWhite, bump, 0); });
  const float cosine = -dot(bump, wi);
  float pdf = -1;
  Rgb diffuse;
  const Rgb lit = behind.evaluate_light(wi, {false, true}, &pdf, &diffuse, nullptr);
  REQUIRE(cosine > 0);
  CHECK(behind.evaluate(wi, nullptr).x == approx(cosine / kPi));
  CHECK(lit.x < 0.95f * cosine / kPi);
  CHECK(lit.x == approx(before.evaluate(-wi, nullptr).x));
}

TEST_CASE("light samples and rays see the same, but for what rough boundaries let through") {
  for (const BsdfCase& c : bsdf_cases())
    for (uint32_t i = 0; i < 64; ++i) {
      CAPTURE(c.name);
      const Vec2 u = sobol_2d(i, 0, 3), v = sobol_2d(i, 1, 3);
      const Vec3 wo = direction((i % 2 ? 1.0f : -1.0f) * (0.05f + 0.9f * u.x), 6.28f * u.y);
      const Vec3 wi = direction((i % 3 ? 1.0f : -1.0f) * (0.05f + 0.9f * v.x), 6.28f * v.y);
      const Bsdf bsdf = make_bsdf(c, wo);
      float pdf = -1, lit_pdf = -1;
      Rgb diffuse, lit_diffuse;
      const Rgb f = bsdf.evaluate(wi, &pdf, nullptr, &diffuse),
                lit = bsdf.evaluate_light(wi, {false, true}, &lit_pdf, &lit_diffuse, nullptr);
      CHECK(is_finite(lit));
      CHECK(diffuse.x == lit_diffuse.x);
      CHECK(lit.x >= f.x);
      CHECK(lit_pdf >= pdf);
      if (wo.z * wi.z > 0) CHECK(lit.x == f.x);
    }
}

TEST_CASE("transparency, emission and holdout are sums; alpha cuts emission too") {
  const Bsdf bsdf = flat(direction(0.9f, 0), [](Bsdf& b) {
    b.add_transparent({0.2f, 0.1f, 0});
    b.add_transparent({0.1f, 0.1f, 0.1f});
    b.add_emission({3, 2, 1});
    b.add_holdout(0.25f);
    b.add_principled(
        kWhite, principled_inputs([](auto& in) { in.alpha = 0.5f, in.emission_strength = 2; }));
  });
  CHECK(bsdf.transparency().x == approx(0.8));
  CHECK(bsdf.emission().x == approx(4));
  CHECK(bsdf.holdout() == approx(0.25));
  const Bsdf nothing = flat(direction(0.9f, 0), [](Bsdf& b) { b.add_transparent(kWhite); });
  CHECK_FALSE(nothing.scatters());
  CHECK_FALSE(nothing.sample(0.5f, {0.5f, 0.5f}));
}

TEST_CASE("a smooth pane: all of the light, straight on or mirrored; the same from both sides") {
  for (const float cosine : {0.9f, 0.2f, -0.2f}) {
    const auto pane = [&](const Rgb& color) {
      return flat(direction(cosine, 0), [&](Bsdf& b) {
        b.add_principled(kWhite, principled_inputs([&](auto& in) {
                           in.roughness = 0, in.ior = 1.5f, in.base_color = color;
                           in.specular_tint = kWhite;
                           in.transmission_weight = 1, in.thin_wall = true;
                         }));
      });
    };
    const float one = fresnel_dielectric(std::abs(cosine), 1.5f), both = 2 * one / (1 + one);
    const Bsdf clear = pane(kWhite), green = pane({0.5f, 1, 0});
    CHECK(clear.only_delta());
    CHECK(clear.transparency().x == approx(1 - both));
    CHECK(clear.straight().x == clear.transparency().x);
    const auto mirrored = clear.sample(0.5f, {0.5f, 0.5f});
    REQUIRE(mirrored);
    CHECK(mirrored->weight.x == approx(both));
    CHECK(green.transparency().x < 0.5f * clear.transparency().x);
    CHECK(green.transparency().y == approx(1 - both));
    CHECK(green.transparency().z == 0);
    CHECK(green.sample(0.5f, {0.5f, 0.5f})->weight.z == approx(one));
  }
}

TEST_CASE("a rough pane loses nothing between facets, whatever its distribution") {
  const auto pane = [](Distribution distribution, const Rgb& tint) {
    return flat(direction(0.8f, 0), [&](Bsdf& b) {
      b.add_principled(kWhite, principled_inputs([&](auto& in) {
                         in.roughness = 0.9f, in.ior = 1.5f, in.base_color = kWhite;
                         in.specular_tint = tint, in.distribution = distribution;
                         in.transmission_weight = 1, in.thin_wall = true;
                       }));
    });
  };
  const auto scattered = [&](Distribution distribution, const Rgb& tint, float side) {
    return pane(distribution, tint).evaluate(direction(side * 0.7f, 1), nullptr).x;
  };
  for (const float side : {1.0f, -1.0f})
    CHECK(scattered(Distribution::kGgx, kWhite, side) ==
          scattered(Distribution::kMultiGgx, kWhite, side));
  // A tint colours what goes on between facets, too: less than in proportion is left.
  CHECK(scattered(Distribution::kGgx, {0.2f, 1, 1}, 1) <
        0.22f * scattered(Distribution::kGgx, kWhite, 1));
}

TEST_CASE("mirror directions stay above a surface with bent normals") {
  const Vec3 wo = direction(0.1f, 0), tilted = normalize({1, 0, 1.2f});
  for (float roughness : {0.0f, 0.3f}) {
    const Bsdf away = flat(wo, [&](Bsdf& b) {
      b.add_glossy(kWhite, normalize({-0.6f, 0, 1}), Distribution::kGgx, roughness, 0, 0, {});
    });
    const Bsdf towards = flat(wo, [&](Bsdf& b) {
      b.add_glossy(kWhite, tilted, Distribution::kGgx, roughness, 0, 0, {});
    });
    int kept = 0;
    for (int i = 0; i < 256; ++i)
      for (const Bsdf* b : {&away, &towards})
        if (const auto s = b->sample(0.5f, sobol_2d(uint32_t(i), 0, 1))) {
          CHECK(s->direction.z > 0);
          ++kept;
        }
    CHECK(kept > 300);
  }
}

TEST_CASE("numbers nobody should give neither break nor hang anything") {
  const float numbers[] = {-1, 0, 1e-30f, 0.5f, 1, 2, 1e30f, kInf, -kInf, kNan};
  const Vec3 normals[] = {kUp,           {0, 0, 0},  {kNan, 0, 1}, {kInf, 0, 0},
                          {1, 0, 1e-7f}, {-1, 0, 0}, {0, 0, -1}};
  for (Transport transport : {Transport::kRadiance, Transport::kFlux})
    for (const Vec3& wo : {direction(1, 0), direction(1e-4f, 0), direction(-0.5f, 1)})
      for (float x : numbers)
        for (const Vec3& n : normals) {
          const Rgb color{x, 0.5f, 1};
          const auto check = [&](const std::function<void(Bsdf&)>& fill) {
            check_sane(flat(wo, fill, transport));
          };
          check([&](Bsdf& b) { b.add_diffuse(color, n, x); });
          check([&](Bsdf& b) { b.add_translucent(color, n); });
          check([&](Bsdf& b) { b.add_sheen(color, n, x, false); });
          check([&](Bsdf& b) { b.add_sheen(color, n, x, true); });
          check([&](Bsdf& b) { b.add_toon(color, n, true, x, x); });
          check([&](Bsdf& b) { b.add_toon(color, n, false, x, x); });
          check([&](Bsdf& b) {
            b.add_transparent(color);
            b.add_emission(color);
            b.add_holdout(x);
          });
          for (Distribution d :
               {Distribution::kGgx, Distribution::kMultiGgx, Distribution::kBeckmann}) {
            check([&](Bsdf& b) { b.add_glossy(color, n, d, x, x, x, n); });
            check([&](Bsdf& b) { b.add_glossy(color, n, d, 0.3f, x, 0.2f, {1, 0, 0}); });
            check([&](Bsdf& b) {
              b.add_glossy(color, n, Distribution::kAshikhminShirley, x, x, x, n);
            });
            check([&](Bsdf& b) { b.add_glass(color, n, d, 0.5f, x, x, x); });
            check([&](Bsdf& b) { b.add_glass(kWhite, n, d, x, 1.5f, 300, x); });
            check([&](Bsdf& b) { b.add_refraction(color, n, d, x, x); });
            check([&](Bsdf& b) {
              b.add_metallic(color, n, d, 0.5f, x, 0, n, true, color, {x, x, x}, x, 1.5f);
            });
            check([&](Bsdf& b) {
              b.add_metallic(color, n, d, x, 0, 0, n, false, color, {x, x, x}, 100, x);
            });
          }
          check([&](Bsdf& b) {
            PrincipledInputs in;
            in.base_color = in.specular_tint = in.coat_tint = in.sheen_tint = in.emission_color =
                color;
            in.metallic = in.roughness = in.ior = in.diffuse_roughness = in.subsurface_weight =
                in.specular_level = x;
            in.anisotropic = in.anisotropic_rotation = in.transmission_weight = in.coat_weight =
                in.coat_roughness = x;
            in.coat_ior = in.sheen_weight = in.sheen_roughness = in.emission_strength = in.alpha =
                x;
            in.thin_film_thickness = in.thin_film_ior = x;
            in.normal = in.coat_normal = in.tangent = n;
            b.add_principled(color, std::move(in));
          });
          check([&](Bsdf& b) {
            b.add_principled(kWhite, principled_inputs([&](auto& in) {
                               in.ior = x, in.specular_level = 0.7f, in.transmission_weight = 0.5f,
                               in.coat_weight = 1, in.coat_ior = x, in.normal = n;
                             }));
          });
        }
}

TEST_CASE("a thousand closures do no harm") {
  const Bsdf bsdf = flat(
      direction(0.5f, 0),
      [](Bsdf& b) {
        for (int i = 0; i < 1000; ++i)
          b.add_principled(kWhite * 0.001f,
                           principled_inputs([](auto& in) { in.coat_weight = 1; }));
      },
      Transport::kFlux);
  check_sane(bsdf);
}

TEST_CASE("colours of lobes: what reflects is glossy, what passes is transmission") {
  const Vec3 wo{0, 0, 1};
  const Rgb tint{0.9f, 0.5f, 0.2f};
  const auto colors = [&](auto&& add) { return flat(wo, add).colors(); };
  const Bsdf::Colors mirror =
      colors([&](Bsdf& b) { b.add_glossy(tint, kUp, Distribution::kGgx, 0.3f, 0, 0, {}); });
  CHECK(mirror.glossy.x == approx(tint.x));
  CHECK(mirror.glossy.z == approx(tint.z));
  CHECK(max_abs(mirror.transmission) == 0);
  // Of a boundary of index 1.5 seen straight on 4 % is reflected.
  const Bsdf::Colors glass =
      colors([](Bsdf& b) { b.add_glass({1, 1, 1}, kUp, Distribution::kGgx, 0, 1.5f, 0, 1); });
  CHECK(glass.glossy.x == approx(0.04f).epsilon(0.01));
  CHECK(glass.transmission.x == approx(0.96f).epsilon(0.001));
  const Bsdf::Colors bent =
      colors([&](Bsdf& b) { b.add_refraction(tint, kUp, Distribution::kGgx, 0.2f, 1.5f); });
  CHECK(max_abs(bent.glossy) == 0);
  CHECK(bent.transmission.y == approx(tint.y));
  // Diffuse-like lobes have none, and are in the diffuse colour, also where photons bring none of
  // it.
  const Bsdf toon = flat(wo, [&](Bsdf& b) { b.add_toon(tint, kUp, false, 0.5f, 0.1f); });
  CHECK(max_abs(toon.colors().glossy + toon.colors().transmission) == 0);
  CHECK(toon.diffuse_albedo().y == approx(tint.y));
  CHECK(toon.albedo().y == approx(tint.y));
}
