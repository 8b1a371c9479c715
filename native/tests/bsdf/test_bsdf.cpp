#include "bsdf/bsdf.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <array>
#include <numeric>

#include "support/bsdf_cases.h"

using namespace photon_splat;

namespace {

constexpr float kCosines[] = {1.0f, 0.8f, 0.45f, 0.15f};

Rgb mean_weight(const Bsdf& bsdf, int count, uint32_t seed, Rgb* rest = nullptr) {
  double sum[6] = {};
  for (int i = 0; i < count; ++i) {
    const Vec2 u = sobol_2d(uint32_t(i), 0, seed), v = sobol_2d(uint32_t(i), 1, seed);
    const auto s = bsdf.sample(v.x, u);
    if (!s) continue;
    for (int c = 0; c < 3; ++c) sum[c] += double(s->weight[c]), sum[3 + c] += double(s->rest[c]);
  }
  if (rest) *rest = {float(sum[3] / count), float(sum[4] / count), float(sum[5] / count)};
  return {float(sum[0] / count), float(sum[1] / count), float(sum[2] / count)};
}

using Points = std::vector<std::pair<double, double>>;
using Sums = std::array<double, 7>;  // density, f, rest

Sums operator+(const Sums& a, const Sums& b) {
  Sums out;
  for (size_t i = 0; i < a.size(); ++i) out[i] = a[i] + b[i];
  return out;
}

// Integral of density, f and rest over a cell of one hemisphere's equal-area map on the disc, x =
// wx / sqrt(1 + |wz|): quartered until the quarters agree with the whole and the cell holds few of
// the `points` where light is known to go.
Sums integrate(const Bsdf& bsdf, double side, const Points& around, double x0, double y0,
               double size, int depth, double tolerance) {
  Points points;
  for (const auto& [x, y] : around)
    if (x >= x0 && x <= x0 + size && y >= y0 && y <= y0 + size) points.push_back({x, y});
  const auto rule = [&](double cx, double cy, double width) {
    Sums sums{};
    for (double s : {0.2113248654, 0.7886751346})
      for (double t : {0.2113248654, 0.7886751346}) {
        const double x = cx + width * s, y = cy + width * t, z = 1 - x * x - y * y,
                     r = std::sqrt(1 + z);
        if (z <= 0) continue;
        float pdf = 0;
        Rgb rest;
        const Rgb f = bsdf.evaluate({float(r * x), float(r * y), float(side * z)}, &pdf, &rest);
        const float values[7] = {pdf, f.x, f.y, f.z, rest.x, rest.y, rest.z};
        // The map halves areas
        for (size_t i = 0; i < 7; ++i) sums[i] += width * width / 2 * double(values[i]);
      }
    return sums;
  };
  const double half = size / 2;
  const Sums whole = rule(x0, y0, size);
  const Sums parts = rule(x0, y0, half) + rule(x0 + half, y0, half) + rule(x0, y0 + half, half) +
                     rule(x0 + half, y0 + half, half);
  double worst = 0;
  for (size_t i = 0; i < 7; ++i) worst = std::max(worst, std::abs(whole[i] - parts[i]));
  const double far = std::hypot(std::max(std::abs(x0), std::abs(x0 + size)),
                                std::max(std::abs(y0), std::abs(y0 + size)));
  const double near =
      std::hypot(x0 * (x0 + size) < 0 ? 0 : std::min(std::abs(x0), std::abs(x0 + size)),
                 y0 * (y0 + size) < 0 ? 0 : std::min(std::abs(y0), std::abs(y0 + size)));
  const bool horizon = near < 1 && far > 1 && size > 0.04;
  if (depth <= 0 || (!horizon && points.size() <= 4 && worst < tolerance)) return parts;
  return integrate(bsdf, side, points, x0, y0, half, depth - 1, tolerance) +
         integrate(bsdf, side, points, x0 + half, y0, half, depth - 1, tolerance) +
         integrate(bsdf, side, points, x0, y0 + half, half, depth - 1, tolerance) +
         integrate(bsdf, side, points, x0 + half, y0 + half, half, depth - 1, tolerance);
}

// Over both hemispheres, to about a thousandth.
Sums integrate(const Bsdf& bsdf) {
  Sums sums{};
  for (double side : {-1.0, 1.0}) {
    Points points;
    for (int i = 0; i < 256; ++i)
      if (const auto s = bsdf.sample(sobol_2d(uint32_t(i), 1, 11).x, sobol_2d(uint32_t(i), 0, 11)))
        if (const double z = side * double(s->direction.z); z > 0)
          points.push_back({double(s->direction.x) / std::sqrt(1 + z),
                            double(s->direction.y) / std::sqrt(1 + z)});
    sums = sums + integrate(bsdf, side, points, -1, -1, 2, 12, 1e-3);
  }
  return sums;
}

}  // namespace

TEST_CASE(
    "sampling and evaluation agree: mean weight is the integral of f, the density integrates to the samples kept") {
  for (const BsdfCase& c : bsdf_cases())
    for (float cosine : kCosines)
      for (Transport transport : {Transport::kRadiance, Transport::kFlux})
        for (bool back : {false, true}) {
          CAPTURE(c.name);
          CAPTURE(cosine);
          CAPTURE(int(transport));
          CAPTURE(back);
          const Bsdf bsdf = make_bsdf(c, direction(back ? -cosine : cosine, 0.4f), transport);
          const int count = transport == Transport::kFlux ? 1 << 11 : 1 << 12;
          int kept = 0;
          for (int i = 0; i < count; ++i)
            if (bsdf.sample(sobol_2d(uint32_t(i), 1, 3).x, sobol_2d(uint32_t(i), 0, 3))) ++kept;
          Rgb rest;
          const Rgb mean = mean_weight(bsdf, count, 3, &rest);
          const Sums sums = integrate(bsdf);
          CHECK(sums[0] == approx(double(kept) / count).epsilon(0.02).scale(1));
          for (size_t k = 0; k < 3; ++k) {
            CHECK(std::abs(double(mean[int(k)]) - sums[1 + k]) < 0.02 * std::max(1.0, sums[1 + k]));
            CHECK(std::abs(double(rest[int(k)]) - sums[4 + k]) < 0.03);
          }
        }
}

TEST_CASE("no closure reflects more than it gets; those that must reflect all do") {
  for (const BsdfCase& c : bsdf_cases())
    for (float cosine : kCosines) {
      CAPTURE(c.name);
      CAPTURE(cosine);
      const Rgb mean = mean_weight(make_bsdf(c, direction(cosine, 0.3f)), 1 << 12, 5);
      CHECK(max_component(mean) < 1.02);
      if (c.furnace >= 0) CHECK(mean.x == approx(c.furnace).epsilon(0.01));
    }
}

TEST_CASE("reciprocal closures give the same for exchanged directions") {
  for (const BsdfCase& c : bsdf_cases())
    if (c.reciprocal)
      for (int i = 0; i < 50; ++i) {
        CAPTURE(c.name);
        const Vec2 u = sobol_2d(uint32_t(i), 0, 7), v = sobol_2d(uint32_t(i), 1, 7);
        const Vec3 a = direction(0.05f + 0.9f * u.x, 6.28f * u.y),
                   b = direction((i % 4 ? 1.0f : -1.0f) * (0.05f + 0.9f * v.x), 6.28f * v.y);
        const Rgb ab = make_bsdf(c, a).evaluate(b, nullptr) / std::abs(b.z),
                  ba = make_bsdf(c, b).evaluate(a, nullptr) / std::abs(a.z);
        for (int k = 0; k < 3; ++k) CHECK(ab[k] == approx(ba[k]).epsilon(2e-3));
      }
}

TEST_CASE("photons see the adjoint: the radiance closure with the directions exchanged") {
  for (const BsdfCase& c : bsdf_cases())
    for (int i = 0; i < 50; ++i) {
      CAPTURE(c.name);
      const Vec2 u = sobol_2d(uint32_t(i), 0, 9), v = sobol_2d(uint32_t(i), 1, 9);
      const Vec3 from = direction((i % 3 ? 1.0f : -1.0f) * (0.05f + 0.9f * u.x), 6.28f * u.y);
      const Vec3 to = direction((i % 2 ? 1.0f : -1.0f) * (0.05f + 0.9f * v.x), 6.28f * v.y);
      const Rgb flux = make_bsdf(c, from, Transport::kFlux).evaluate(to, nullptr) / std::abs(to.z);
      const Rgb radiance = make_bsdf(c, to).evaluate(from, nullptr) / std::abs(from.z);
      for (int k = 0; k < 3; ++k) CHECK(flux[k] == approx(radiance[k]).epsilon(1e-4));
    }
}

TEST_CASE("a photon's weight follows from what a camera path sees on the way back") {
  int refracted = 0;
  for (const BsdfCase& c : bsdf_cases())
    for (uint32_t i = 0; i < 40; ++i) {
      CAPTURE(c.name);
      const Vec2 u = sobol_2d(i, 0, 9), v = sobol_2d(i, 1, 9);
      const Vec3 from = direction((i % 3 ? 1.0f : -1.0f) * (0.05f + 0.9f * u.x), 6.28f * u.y);
      Bsdf photon = make_bsdf(c, from, Transport::kFlux);
      if (i % 2) photon.send_through(make_bsdf(c, from, Transport::kFlux));
      const auto s = photon.sample(sobol_2d(i, 2, 9).x, v);
      if (!s) continue;
      REQUIRE(s->pdf > 0);
      const Rgb value = make_bsdf(c, s->direction).evaluate(from, nullptr) * s->per_value;
      for (int k = 0; k < 3; ++k) CHECK(s->weight[k] == approx(value[k]).epsilon(1e-3));
    }
  for (uint32_t i = 0; i < 40; ++i) {  // a mirror, seen in another colour from there
    const Vec2 u = sobol_2d(i, 0, 9);
    const auto seen_from = [](const Vec3& w, Transport transport, const Rgb& color) {
      Bsdf bsdf(transport, w, {0, 0, 1}, {0, 0, 1}, false);
      bsdf.add_diffuse({0.1f, 0.1f, 0.1f}, {0, 0, 1}, 0);
      bsdf.add_glossy(color, {0, 0, 1}, Distribution::kGgx, 0, 0, 0, {});
      bsdf.finish();
      return bsdf;
    };
    const Vec3 from = direction(0.05f + 0.9f * u.x, 6.28f * u.y);
    const auto s =
        seen_from(from, Transport::kFlux, {0.7f, 0.7f, 0.7f}).sample(0.5f, {0.99f, 0.5f});
    REQUIRE(s);
    REQUIRE(s->pdf <= 0);
    const Rgb color{0.9f, 0.4f, 0.2f};
    const Rgb value =
        seen_from(s->direction, Transport::kRadiance, color).mirror_share(s->lobe) * s->per_value;
    for (int k = 0; k < 3; ++k)
      CHECK(value[k] == approx(s->weight[k] * color[k] / 0.7f).epsilon(1e-3));
  }
  for (uint32_t i = 0; i < 40; ++i) {  // through a smooth boundary
    const Vec2 u = sobol_2d(i, 0, 9);
    const Vec3 from = direction((i % 2 ? 1.0f : -1.0f) * (0.05f + 0.9f * u.x), 6.28f * u.y);
    const auto seen_from = [](const Vec3& w, Transport transport) {
      const Vec3 up{0, 0, w.z > 0 ? 1.0f : -1.0f};
      Bsdf bsdf(transport, w, up, up, w.z < 0);
      bsdf.add_glass({0.9f, 0.8f, 0.7f}, {0, 0, 1}, Distribution::kGgx, 0, 1.5f, 0, 1);
      bsdf.finish();
      return bsdf;
    };
    const auto s = seen_from(from, Transport::kFlux).sample(0, {0.999f, 0.5f});
    if (!s || !s->transmitted) continue;
    const Bsdf camera = seen_from(s->direction, Transport::kRadiance);
    const Bsdf::SmoothWays back = camera.smooth_ways(from);
    REQUIRE(back.count == 1);
    CHECK(dot(back.ways[0].to, s->direction) == approx(1));
    const float chance = seen_from(from, Transport::kFlux).smooth_chance(i % 3 == 0);
    const Rgb value = camera.smooth_share(back.ways[0].lobe) * (back.ways[0].spread / chance);
    for (int k = 0; k < 3; ++k) CHECK(s->weight[k] == approx(value[k]).epsilon(1e-3));
    ++refracted;
  }
  CHECK(refracted > 20);
}

TEST_CASE("what counts as diffuse: rays by the lobes they are drawn by, the same for photons") {
  for (const BsdfCase& c : bsdf_cases()) {
    CAPTURE(c.name);
    const Vec3 wo = direction(0.6f, 0.4f);
    const Bsdf bsdf = make_bsdf(c, wo);
    double drawn = 0, told = 0, pulled = 0;
    int count = 0;
    for (int i = 0; i < 1 << 12; ++i) {
      const auto s = bsdf.sample(sobol_2d(uint32_t(i), 1, 3).x, sobol_2d(uint32_t(i), 0, 3));
      if (!s || !(s->pdf > 0)) continue;
      ++count;
      drawn += s->diffuse;
      const float share = bsdf.diffuse_share(s->direction, 0).x;
      told += share;
      Rgb diffuse;
      float pdf;
      const Rgb whole = bsdf.evaluate(s->direction, &pdf, nullptr, &diffuse);
      const float by_value = bsdf.diffuse_share(s->direction, INFINITY).y;
      CHECK(by_value * whole.y == approx(diffuse.y).epsilon(1e-4).scale(1e-3));
      // Where as many light samples fall as rays the two have halves of it.
      const float half = bsdf.diffuse_share(s->direction, pdf).y;
      pulled += std::abs(double(half) - 0.5 * (double(share) + double(by_value)));
      const Bsdf photon = make_bsdf(c, s->direction, Transport::kFlux);
      for (float light_pdf : {0.0f, 1.0f, INFINITY})
        CHECK(photon.diffuse_share(wo, light_pdf).y ==
              approx(bsdf.diffuse_share(s->direction, light_pdf).y).epsilon(0.01).scale(0.1));
    }
    if (!count) continue;
    CHECK(told / count == approx(drawn / count).epsilon(0.02).scale(1));
    CHECK(pulled / count < 0.01);
  }
}

TEST_CASE("samples fall as the density says: chi-square over cells of both hemispheres") {
  constexpr int kSide = 10, kSamples = 20000;
  int tests = 0;
  for (const BsdfCase& c : bsdf_cases())
    for (float cosine : {0.95f, 0.3f})
      for (bool back : {false, true}) {
        const Bsdf bsdf = make_bsdf(c, direction(back ? -cosine : cosine, 0.9f));
        std::vector<double> expected, seen;
        std::vector<Vec3> directions;
        for (int i = 0; i < kSamples; ++i) {
          Random random(uint64_t(i), 17);
          const float choice = random.next();
          if (const auto s = bsdf.sample(choice, random.next2()))
            directions.push_back(s->direction);
        }
        int kept = 0;
        for (double side : {-1.0, 1.0}) {
          Points points;
          std::vector<double> counts(kSide * kSide);
          for (const Vec3& to : directions) {
            if (side * double(to.z) <= 0) continue;
            const double r = 1 / std::sqrt(1 + side * double(to.z));
            const double x = double(to.x) * r, y = double(to.y) * r;
            if (points.size() < 256) points.push_back({x, y});
            const auto cell = [](double v) {
              return std::clamp(int((v + 1) / 2 * kSide), 0, kSide - 1);
            };
            ++counts[size_t(cell(y) * kSide + cell(x))];
            ++kept;
          }
          for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
              expected.push_back(kSamples * integrate(bsdf, side, points, x * 2.0 / kSide - 1,
                                                      y * 2.0 / kSide - 1, 2.0 / kSide, 8,
                                                      1e-5)[0]);
              seen.push_back(counts[size_t(y * kSide + x)]);
            }
        }
        expected.push_back(
            std::max(0.0, kSamples - std::accumulate(expected.begin(), expected.end(), 0.0)));
        seen.push_back(kSamples - kept);
        double statistic = 0, rare_expected = 0, rare_seen = 0;
        int freedom = -1;
        const auto add = [&](double e, double o) { statistic += (o - e) * (o - e) / e, ++freedom; };
        for (size_t i = 0; i < expected.size(); ++i) {
          if (expected[i] >= 8)
            add(expected[i], seen[i]);
          else
            rare_expected += expected[i], rare_seen += seen[i];
        }
        if (rare_expected >= 8) add(rare_expected, rare_seen);
        if (freedom < 1) continue;
        ++tests;
        // Wilson & Hilferty 1931: the cube root is nearly normal. 5 sigma, over some hundred tests;
        // 0.5 % for the quadrature.
        const double k = freedom, spread = 2 / (9 * k);
        const double z = (std::cbrt(statistic / k) - (1 - spread)) / std::sqrt(spread);
        CAPTURE(c.name);
        CAPTURE(cosine);
        CAPTURE(back);
        CAPTURE(statistic);
        CAPTURE(freedom);
        CHECK(z < 5);
      }
  CHECK(tests > 200);
}

TEST_CASE("others drawn towards a cone: the same light by both together, and less by each inside") {
  const Cone cone{normalize({0.8f, 0.1f, 0.6f}), 0.01f};
  constexpr float kOthers = 0.7f;  // for each sample
  for (const BsdfCase& c : bsdf_cases()) {
    CAPTURE(c.name);
    for (const Transport transport : {Transport::kRadiance, Transport::kFlux}) {
      const Bsdf bsdf = make_bsdf(c, direction(0.6f, 0.9f), transport);
      constexpr uint32_t kCount = 1 << 16;
      double plain[2] = {}, both[2] = {}, squares[2] = {};
      bool heavier = false;
      for (uint32_t i = 0; i < kCount; ++i) {
        const float choice = sobol_2d(i, 0, 1).x;
        const Vec2 u = sobol_2d(i, 1, 1);
        const auto weight = [&](const std::optional<BsdfSample>& s) {
          return s ? double(average(s->weight)) / kCount : 0;
        };
        const auto inside = [&](const std::optional<BsdfSample>& s) {
          return s && s->pdf > 0 && cone.pdf(s->direction) > 0;
        };
        const auto as_ever = bsdf.sample(choice, u);
        plain[inside(as_ever)] += weight(as_ever);
        squares[inside(as_ever)] += weight(as_ever) * weight(as_ever) * kCount;
        const auto own = bsdf.sample(choice, u, {cone, kOthers, false});
        both[inside(own)] += weight(own);
        heavier |= weight(own) > weight(as_ever);
        if (const auto drawn = bsdf.sample(choice, u, {cone, kOthers, true}))
          both[1] += kOthers * weight(drawn);
      }
      CHECK(!heavier);
      for (const int k : {0, 1}) {
        const double deviation =
            std::sqrt(std::max(squares[k] - plain[k] * plain[k], 0.0) / kCount);
        CHECK(std::abs(both[k] - plain[k]) <= 5 * deviation + 0.002 * plain[k]);
      }
    }
  }
}

TEST_CASE("samples of sharp lobes alone: as much light by them as by all samples") {
  const Vec3 up{0, 0, 1}, wo = normalize({0.6f, 0.1f, 0.8f});
  for (const float roughness : {0.0f, 0.15f, 0.3f}) {
    Bsdf bsdf(Transport::kFlux, wo, up, up, false);
    bsdf.add_diffuse({0.6f, 0.5f, 0.4f}, up, 0);
    bsdf.add_glossy({0.1f, 0.1f, 0.1f}, up, Distribution::kGgx, roughness, 0, 0, {});
    bsdf.add_glossy({0.2f, 0.2f, 0.2f}, up, Distribution::kGgx, 0.9f, 0, 0, {});
    bsdf.finish();
    constexpr uint32_t kCount = 1 << 17;
    double all = 0, sharp = 0;
    for (uint32_t i = 0; i < kCount; ++i) {
      const float choice = sobol_2d(i, 0, 1).x;
      const Vec2 u = sobol_2d(i, 1, 1);
      const auto caustic = [](const BsdfSample& s) {
        return s.diffuse ? 0 : double(s.weight.x) * sharpness(s.roughness) / kCount;
      };
      if (const auto s = bsdf.sample(choice, u)) all += caustic(*s);
      if (const auto s = bsdf.sample_sharp(choice, u)) {
        CHECK(sharpness(s->roughness) > 0);
        sharp += caustic(*s);
      }
    }
    CHECK(all > 0.01);
    CHECK(sharp == approx(all).epsilon(0.01));
  }
  Bsdf dull(Transport::kFlux, wo, up, up, false);
  dull.add_diffuse({0.6f, 0.5f, 0.4f}, up, 0);
  dull.finish();
  CHECK_FALSE(dull.sample_sharp(0.5f, {0.5f, 0.5f}));
}

TEST_CASE("the mean normal is that of the lobes, by what they scatter") {
  const Vec3 up{0, 0, 1}, bent = normalize({0.5f, 0, 1}), wo = normalize({0.1f, 0.2f, 1});
  Bsdf bsdf(Transport::kRadiance, wo, up, up, false);
  bsdf.add_diffuse({0.5f, 0.5f, 0.5f}, bent, 0);
  bsdf.finish();
  CHECK(length(bsdf.mean_normal() - bent) < 1e-5f);
  Bsdf both(Transport::kRadiance, wo, up, up, false);
  both.add_diffuse({0.5f, 0.5f, 0.5f}, bent, 0);
  both.add_diffuse({0.5f, 0.5f, 0.5f}, up, 0);
  both.finish();
  CHECK(length(both.mean_normal() - normalize(bent + up)) < 1e-5f);
  Bsdf none(Transport::kRadiance, wo, up, bent, false);
  none.finish();
  CHECK(length(none.mean_normal() - bent) < 1e-5f);
}
