// Strands of facets: energy, densities, and that photons scatter as camera paths do.
#include <doctest/doctest.h>

#include <functional>
#include <vector>

#include "bsdf/bsdf.h"
#include "math/sampling.h"
#include "support/approx.h"

using namespace photon_splat;

namespace {

const Vec3 kTangent = normalize({1, 0.2f, -0.1f}), kMajor = normalize({0.1f, 1, 0.4f});

Vec3 seen_from(float sine, float azimuth) {
  const Basis basis(kTangent);
  const float cosine = std::sqrt(1 - sine * sine);
  return kTangent * sine +
         (basis.tangent * std::cos(azimuth) + basis.bitangent * std::sin(azimuth)) * cosine;
}

FacetHairInputs inputs_of(float roughness, float ior = 1.55f, float aspect = 1, float offset = 0) {
  FacetHairInputs in;
  in.roughness = roughness;
  in.ior = ior;
  in.aspect = aspect;
  in.major = kMajor;
  in.offset = offset;
  return in;
}

std::vector<FacetHairInputs> kinds() {
  return {inputs_of(0.3f),
          inputs_of(0.6f),
          inputs_of(1),
          inputs_of(0.3f, 1.2f),
          inputs_of(0.3f, 1.9f),
          inputs_of(0.3f, 1.55f, 0.5f),
          inputs_of(0.5f, 1.4f, 2),
          inputs_of(0.3f, 1.55f, 1, 0.15f),
          inputs_of(0.1f, 1.55f, 1),
          inputs_of(0.4f, 1.55f, 0.7f, 0.1f)};
}

Bsdf strand(FacetHairInputs in, const Vec3& wo, uint32_t seed, float across = 0,
            Transport transport = Transport::kRadiance) {
  const Vec3 facing = normalize(wo - kTangent * dot(wo, kTangent));
  Bsdf bsdf(transport, wo, facing, facing, false);
  bsdf.gather_nothing();
  in.frame = {kTangent, across, true};
  in.seed = hash32(seed);
  bsdf.add_facet_hair({1, 1, 1}, {0, 0, 1}, std::move(in));
  bsdf.finish();
  return bsdf;
}

float width_of(FacetHairInputs in, const Vec3& wo) {
  in.frame.tangent = kTangent;
  return facet_hair_width(in, wo);
}

std::optional<BsdfSample> sample_of(const Bsdf& bsdf, uint32_t i) {
  return bsdf.sample(sobol_2d(i, 1, 5).x, sobol_2d(i, 0, 5));
}

constexpr int kMoments = 4;
float moment_of(const Vec3& w, int i) {
  return i == 0 ? 1 : i == 1 ? w.x : i == 2 ? w.y * w.z : w.z;
}

void over_directions(const std::function<void(const Vec3& wi, double area)>& visit) {
  constexpr int kAlong = 160, kAround = 120;
  for (int i = 0; i < kAlong; ++i)
    for (int k = 0; k < kAround; ++k)
      visit(seen_from(2 * (float(i) + 0.5f) / kAlong - 1, 2 * kPi * (float(k) + 0.5f) / kAround),
            4 * double(kPi) / (kAlong * kAround));
}

}  // namespace

TEST_CASE("clear strands of facets keep the light") {
  for (const FacetHairInputs& in : kinds()) {
    CAPTURE(in.roughness);
    CAPTURE(in.ior);
    CAPTURE(in.aspect);
    CAPTURE(in.offset);
    for (const float sine : {0.0f, 0.5f, -0.8f}) {
      double sum = 0;
      constexpr uint32_t kSamples = 1 << 14;
      for (uint32_t i = 0; i < kSamples; ++i)
        if (const auto s = sample_of(strand(in, seen_from(sine, 0.7f), i), i))
          sum += double(s->weight.y) / kSamples;
      // What the model makes of a boundary's inner side is the less exact the rougher it is, and
      // light that falls along the scales meets some from below
      const double most = in.roughness > 0.5f ? 1.1 : 1.035;
      CHECK(sum < most);
      CHECK(sum > (in.offset > 0 ? 0.93 : 0.98));
    }
  }
}

TEST_CASE("strands of facets have the density of their samples") {
  for (const FacetHairInputs& in : kinds()) {
    if (in.roughness < 0.3f) continue;
    CAPTURE(in.roughness);
    CAPTURE(in.ior);
    CAPTURE(in.aspect);
    CAPTURE(in.offset);
    for (const float sine : {0.1f, -0.7f}) {
      const Bsdf bsdf = strand(in, seen_from(sine, 0.7f), 3);
      double density[kMoments] = {}, drawn[kMoments] = {}, scattered = 0, weight = 0;
      over_directions([&](const Vec3& wi, double area) {
        float pdf = 0;
        scattered += area * double(bsdf.evaluate(wi, &pdf).y);
        for (int m = 0; m < kMoments; ++m) density[m] += area * double(pdf * moment_of(wi, m));
      });
      constexpr uint32_t kSamples = 1 << 14;
      for (uint32_t i = 0; i < kSamples; ++i) {
        const auto s = sample_of(bsdf, i);
        if (!s) continue;
        weight += double(s->weight.y) / kSamples;
        for (int m = 0; m < kMoments; ++m)
          drawn[m] += double(moment_of(s->direction, m)) / kSamples;
      }
      CHECK(scattered == approx(weight).epsilon(0.02));
      for (int m = 0; m < kMoments; ++m) CHECK(std::abs(drawn[m] - density[m]) < 0.015);
    }
  }
}

TEST_CASE("photons that strands of facets scatter are those that camera paths look for") {
  const Vec3 a = seen_from(0.3f, 0.2f), b = seen_from(-0.5f, 1.9f);
  for (const FacetHairInputs& in : kinds()) {
    if (in.roughness < 0.3f) continue;
    double looked = 0, looked2 = 0, sent = 0, sent2 = 0;
    constexpr uint32_t kSeeds = 1 << 13;
    for (uint32_t i = 0; i < kSeeds; ++i) {
      const double x = double(strand(in, b, i).evaluate(a, nullptr).y) / kSeeds,
                   y = double(strand(in, a, i, 0, Transport::kFlux).evaluate(b, nullptr).y) /
                       kSeeds;
      looked += x, looked2 += x * x;
      sent += y, sent2 += y * y;
    }
    // Either meets the strand as wide as it is seen
    const double wide = double(std::sqrt(1 - 0.5f * 0.5f) / std::sqrt(1 - 0.3f * 0.3f)) *
                        double(width_of(in, b) / width_of(in, a));
    const double noise = std::sqrt(looked2 * wide * wide + sent2);
    CHECK(noise < 0.1 * sent);
    CHECK(std::abs(sent - looked * wide) < 4 * noise);
  }
}

TEST_CASE("light of clear strands of facets is kept by photons as well") {
  for (const FacetHairInputs& in : kinds()) {
    if (in.roughness != 0.3f || in.offset > 0) continue;
    CAPTURE(in.ior);
    CAPTURE(in.aspect);
    double sum = 0;
    constexpr uint32_t kSamples = 1 << 16;
    for (uint32_t i = 0; i < kSamples; ++i)
      if (const auto s = sample_of(strand(in, seen_from(0.4f, 0.7f), i, 0, Transport::kFlux), i))
        sum += double(s->weight.y) / kSamples;
    CHECK(sum == approx(1).epsilon(0.06));
  }
}

TEST_CASE("a strand of facets that is wide is seen place by place") {
  // By light from beside, its near edge is bright and its far edge dark
  const Vec3 wo = seen_from(0, 0.7f), wi = seen_from(0, 0.7f + 1.2f);
  FacetHairInputs in = inputs_of(0.3f);
  in.absorption = {50, 50, 50};
  const auto mean = [&](float across, float coverage) {
    in.coverage = coverage;
    double sum = 0;
    for (uint32_t i = 0; i < 512; ++i)
      sum += double(strand(in, wo, i, across).evaluate(wi, nullptr).y) / 512;
    return sum;
  };
  double whole = 0;
  for (int i = 0; i < 20; ++i) whole += mean(0.1f * float(i) - 0.95f, 0.05f) / 20;
  CHECK(mean(0.55f, 0.05f) > 20 * mean(-0.55f, 0.05f));
  CHECK(whole == approx(mean(0.3f, 1)).epsilon(0.05));
}

TEST_CASE("inputs of strands of facets that are of no use do no harm") {
  const Vec3 wo = seen_from(0.2f, 0.5f);
  for (const float bad : {NAN, INFINITY, -INFINITY, -1.0f, 0.0f, 1e30f}) {
    Bsdf bsdf(Transport::kRadiance, wo, wo, wo, false);
    FacetHairInputs in;
    in.frame = {kTangent, bad, true};
    in.absorption = in.major = {bad, bad, 1};
    in.roughness = in.aspect = in.offset = in.ior = in.coverage = bad;
    in.reflection = in.transmission = in.secondary = bad;
    bsdf.add_facet_hair({1, 1, 1}, wo, std::move(in));
    bsdf.finish();
    for (uint32_t i = 0; i < 64; ++i) {
      if (const auto s = sample_of(bsdf, i)) CHECK(is_finite(s->weight));
      float pdf = 0;
      CHECK(is_finite(bsdf.evaluate(seen_from(2 * sobol_2d(i, 0, 5).x - 1, float(i)), &pdf)));
      CHECK(pdf >= 0);
    }
  }
  // along the strand itself
  CHECK(is_finite(strand(inputs_of(0.3f), seen_from(0.9999999f, 0), 1).evaluate(wo, nullptr)));
}
