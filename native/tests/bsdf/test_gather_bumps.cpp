// Photons that follow bumps: what they estimate and what is left to camera paths.
#include "bsdf/bsdf.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <functional>

#include "math/bumps.h"
#include "support/bsdf_cases.h"

using namespace photon_splat;

namespace {

constexpr Vec3 kAbove{0, 0, 1};

using Fill = std::function<void(Bsdf&)>;

Bsdf bumped(const Vec3& wo, const Vec3& ns, const Fill& fill, bool follows = true) {
  const bool behind = wo.z < 0;
  Bsdf bsdf(Transport::kRadiance, wo, behind ? -kAbove : kAbove, behind ? -ns : ns, behind);
  if (follows) bsdf.gather_bumps();
  fill(bsdf);
  bsdf.finish();
  return bsdf;
}

std::vector<Fill> closures(const Vec3& bump, const Vec3& other) {
  return {[=](Bsdf& b) { b.add_diffuse(kGrey, bump, 0); },
          [=](Bsdf& b) { b.add_diffuse(kGrey, bump, 0.7f); },
          [=](Bsdf& b) { b.add_translucent(kGrey, bump); },
          [=](Bsdf& b) {
            b.add_diffuse(kGrey * 0.5f, bump, 0);
            b.add_translucent(kGrey * 0.5f, bump);
          },
          [=](Bsdf& b) {  // two normals, and more than photons tell apart
            b.add_diffuse(kGrey * 0.5f, bump, 0);
            b.add_diffuse(kGrey * 0.5f, normalize(bump + Vec3{0.3f, 0, 0}), 0);
          },
          [=](Bsdf& b) {
            for (float x : {0.0f, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f}) {
              b.add_diffuse(kGrey * 0.1f, normalize(bump + Vec3{x, 0, 0}), 0);
              b.add_translucent(kGrey * 0.1f, normalize(bump + Vec3{x, 0, 0}));
            }
          },
          [=](Bsdf& b) {
            b.add_principled({1, 1, 1}, principled_inputs([=](auto& in) {
                               in.normal = bump, in.coat_normal = other, in.coat_weight = 0.6f;
                               in.coat_roughness = 0.4f, in.roughness = 0.5f;
                               in.sheen_weight = 0.5f, in.transmission_weight = 0.3f;
                             }));
          }};
}

// Something that is not the same from anywhere.
float radiance_from(const Vec3& w) { return 1 + 0.6f * w.x + 0.3f * w.y * w.z + (w.y > 0.4f); }

double mean_absolute_rest(const Bsdf& bsdf) {
  double sum = 0;
  constexpr int count = 1 << 14;
  for (int i = 0; i < count; ++i) {
    Rgb rest;
    bsdf.evaluate(sample_sphere(sobol_2d(uint32_t(i), 0, 7)), nullptr, &rest);
    sum += double(std::abs(rest.x)) * 4 * double(kPi) / count;
  }
  return sum;
}

}  // namespace

TEST_CASE("offsets of normals come back in steps of 1/511, none as none") {
  CHECK(encode_offset({}) == 0);
  CHECK(length(decode_offset(0)) == 0);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 d = sample_sphere(sobol_2d(uint32_t(i), 0, 1)) * (0.001f * float(i));
    const Vec3 back = decode_offset(encode_offset(d));
    CHECK(max_abs(back - d) <= 0.51f / 511);
    CHECK(encode_offset(back) == encode_offset(d));
  }
  CHECK(decode_offset(encode_offset({-1, 1, -2})).x == -1);
  CHECK(decode_offset(encode_offset({-1, 1, -2})).z == -1);
}

TEST_CASE("light that photons bring to a bump and what camera paths look for make up the whole") {
  const Vec3 ns = normalize({0.05f, -0.03f, 1});
  for (float steep : {0.1f, 0.4f, 1.0f})
    for (const Fill& fill : closures(normalize({steep, 0.3f * steep, 1}), ns))
      for (const Vec3& wo : {direction(0.9f, 2.5f), direction(-0.6f, -1.0f)}) {
        CAPTURE(steep);
        CAPTURE(wo.z);
        const Bsdf bsdf = bumped(wo, ns, fill);
        const float side = wo.z < 0 ? -1.0f : 1.0f;
        CHECK(!bsdf.gather_parts().empty());
        double whole = 0, rest_of_it = 0;
        float irradiance[2] = {};  // here, through
        Vec3 ways[2] = {};
        constexpr int count = 1 << 15;
        for (int i = 0; i < count; ++i) {
          const Vec3 w = sample_sphere(sobol_2d(uint32_t(i), 0, 4));
          const float light = radiance_from(w) * 4 * kPi / count;
          Rgb rest;
          whole += double(bsdf.evaluate(w, nullptr, &rest).x * light);
          rest_of_it += double(rest.x * light);
          const bool through = w.z * side < 0;
          const Vec3 smooth = w.z > 0 ? ns : -ns, ng = w.z > 0 ? kAbove : -kAbove;
          // A photon's flux, with the factor of smooth normals that is stored with it
          const float flux = light * std::max(0.0f, dot(w, smooth));
          irradiance[through] += flux;
          ways[through] += way_over_cosine(way_for_smooth(w, ng, smooth), ng) * flux;
        }
        double photons = 0;
        for (const Bsdf::Part& part : bsdf.gather_parts())
          photons += double(part.albedo.x / kPi *
                            (irradiance[part.through] + dot(part.offset, ways[part.through])));
        CHECK(photons + rest_of_it == approx(whole).epsilon(1e-3).scale(0.1));
      }
}

TEST_CASE("samples find all the light that photons on bumps leave") {
  const Vec3 ns = normalize({0.1f, 0.05f, 1});
  constexpr int count = 1 << 15;
  for (float steep : {0.1f, 0.4f, 1.0f}) {
    const auto fills = closures(normalize({-steep, 0.8f * steep, 1}), ns);
    for (size_t f = 0; f < fills.size(); ++f)
      for (const Vec3& wo :
           {direction(0.9f, 2.5f), direction(0.4f, 2.0f), direction(-0.6f, -1.0f)}) {
        CAPTURE(steep);
        CAPTURE(f);
        CAPTURE(wo.z);
        Bsdf bsdf = bumped(wo, ns, fills[f]);
        bsdf.prefer_rest(0.05f);
        double sampled = 0, wanted = 0, kept = 0, density = 0, most = 0;
        for (int i = 0; i < count; ++i) {
          const Vec2 u = sobol_2d(uint32_t(i), 0, 5), v = sobol_2d(uint32_t(i), 1, 5);
          if (const auto s = bsdf.sample(v.x, u)) {
            kept += 1.0 / count;
            sampled += double(s->rest.x * radiance_from(s->direction)) / count;
            most = std::max(most, double(std::abs(s->rest.x)));
          }
          const Vec3 w = sample_sphere(u);
          float pdf;
          Rgb rest;
          bsdf.evaluate(w, &pdf, &rest);
          wanted += double(rest.x * radiance_from(w)) * 4 * double(kPi) / count;
          density += double(pdf) * 4 * double(kPi) / count;
        }
        CHECK(sampled == approx(wanted).epsilon(0.01).scale(0.5));
        CHECK(kept == approx(density).epsilon(0.02).scale(1));
        CHECK(most < 60);
      }
  }
}

TEST_CASE("photons that follow bumps leave a fraction to camera paths") {
  const Vec3 wo = direction(0.7f, 0.2f);
  for (float degrees : {5.0f, 20.0f, 40.0f}) {
    CAPTURE(degrees);
    const float angle = degrees * kPi / 180;
    const Vec3 bump{std::sin(angle), 0, std::cos(angle)};
    for (const Fill& fill : {Fill([&](Bsdf& b) { b.add_diffuse(kGrey, bump, 0); }),
                             Fill([&](Bsdf& b) { b.add_translucent(kGrey, bump); })}) {
      const double follows = mean_absolute_rest(bumped(wo, kAbove, fill)),
                   else_left = mean_absolute_rest(bumped(wo, kAbove, fill, false));
      CHECK(follows < 0.4 * else_left);
    }
  }
}
