#include "film/error_estimate.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include "math/sampling.h"

using namespace photon_splat;

namespace {

constexpr int kWidth = 40, kHeight = 30;

// Passes of a picture whose pixels are sample(pass, pixel); its estimate after `passes` of them.
template <class Sample>
ErrorEstimate estimate(uint32_t passes, Sample&& sample) {
  ThreadPool pool(2);
  ErrorEstimate errors;
  errors.reset(kWidth, kHeight);
  Film film;
  film.reset(kWidth, kHeight);
  for (uint32_t p = 0; p < passes; ++p) {
    for (uint32_t i = 0; i < film.pixels.size(); ++i) {
      film.pixels[i] = {};
      film.pixels[i].samples = 1;
      sample(p, i, film.pixels[i]);
    }
    errors.add(film, pool);
  }
  errors.update(pool);
  return errors;
}

double root_mean_square(const std::vector<float>& squares) {
  double sum = 0;
  for (float s : squares) sum += s;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

}  // namespace

TEST_CASE(
    "pixels of several samples a pass: the standard error is sigma over the root of all samples") {
  Random random(7, 9);
  const auto e = estimate(24, [&](uint32_t pass, uint32_t pixel, Pixel& p) {
    const int samples = pass && pixel % kWidth >= kWidth / 2 ? 16 : 1;
    float sum = 0;
    for (int s = 0; s < samples; ++s) sum += 1 + 0.5f * (2 * random.next() - 1);
    p.emission = Rgb{1, 1, 1} * sum;
    p.samples = static_cast<float>(samples);
  });
  const double sigma = 0.5 / std::sqrt(3.0);
  double few = 0, many = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (std::abs(x - kWidth / 2) < 12) continue;  // neighbours lend each other their statistics
      (x < kWidth / 2 ? few : many) += e.variance()[static_cast<size_t>(y) * kWidth + x];
    }
  CHECK(std::sqrt(few / (8 * kHeight)) == approx(sigma / std::sqrt(24.0)).epsilon(0.2));
  CHECK(std::sqrt(many / (9 * kHeight)) == approx(sigma / std::sqrt(1 + 23 * 16.0)).epsilon(0.2));
}

TEST_CASE("independent passes: the standard error is sigma over the root of their number") {
  const double sigma = 1 / std::sqrt(12.0);
  for (uint32_t passes : {2u, 8u, 13u, 64u, 200u}) {
    CAPTURE(passes);
    const ErrorEstimate errors = estimate(passes, [](uint32_t p, uint32_t i, Pixel& pixel) {
      const float v = Random(p, i).next();
      pixel.emission = {v, v, v};
    });
    const double ratio = root_mean_square(errors.variance()) / (sigma / std::sqrt(double(passes)));
    CHECK(ratio > 0.7);
    CHECK(ratio < 1.2);
    CHECK(errors.figures().mean_luminance == approx(0.5).epsilon(0.02));
    CHECK(errors.figures().bias == 0);
    CHECK(errors.figures().relative_rmse == approx(errors.figures().standard_error));
  }
}

TEST_CASE(
    "low-discrepancy passes: the estimate follows the error of the mean, not the spread of the passes") {
  // Of a pixel that an edge cuts at a place of its own.
  for (uint32_t passes : {8u, 16u, 24u, 48u, 60u, 256u}) {
    CAPTURE(passes);
    std::vector<double> sums(kWidth * kHeight);
    const ErrorEstimate errors = estimate(passes, [&](uint32_t p, uint32_t i, Pixel& pixel) {
      const Vec2 u = sobol_2d(p, 0, hash32(i));
      const float v = u.x + 0.5f * u.y < 0.2f + to_unit_float(hash32(i + 77)) ? 1 : 0;
      pixel.emission = {v, v, v};
      sums[i] += v;
    });
    double reference = 0;
    for (uint32_t i = 0; i < sums.size(); ++i) {
      double area = 0;  // by a fine grid
      for (int k = 0; k < 400; ++k)
        area +=
            std::clamp(0.2 + to_unit_float(hash32(i + 77)) - 0.5 * (k + 0.5) / 400, 0.0, 1.0) / 400;
      reference += std::pow(sums[i] / passes - area, 2);
    }
    const double ratio = std::sqrt(reference / static_cast<double>(sums.size())) /
                         root_mean_square(errors.variance());
    CHECK(ratio > 0.65);
    CHECK(ratio < 0.9);
  }
}

TEST_CASE("what narrower discs would change is bias, unless it is noise") {
  const auto with_detail = [](float offset) {
    return estimate(64, [offset](uint32_t p, uint32_t i, Pixel& pixel) {
      pixel.emission = {1, 1, 1};
      pixel.detail = offset + 0.2f * (Random(p, i).next() - 0.5f);
    });
  };
  CHECK(with_detail(0.1f).figures().bias == approx(0.2).epsilon(0.05));
  CHECK(with_detail(0).figures().bias < 0.01);
}

TEST_CASE("a lamp's rim says nothing of pixels that do not see it; lights met rarely do") {
  // Lit evenly but for a little noise, and a lamp of nine pixels, those at its rim half covered.
  constexpr int kLamp = 15, kFirst = 14, kLast = 16;
  const float noise = 0.01f, sigma = noise / std::sqrt(12.0f);
  const ErrorEstimate lamp = estimate(16, [&](uint32_t p, uint32_t i, Pixel& pixel) {
    const int x = static_cast<int>(i) % kWidth, y = static_cast<int>(i) / kWidth;
    const float v = 1 + noise * Random(p, i).next();
    pixel.diffuse_direct = {v, v, v};
    if (x < kFirst || x > kLast || y < kFirst || y > kLast) return;
    if ((x == kLamp && y == kLamp) || Random(p + 1000, i).next() < 0.5f)
      pixel.emission = {500, 500, 500};
  });
  double told = 0;
  int pixels = 0;
  for (int y = kFirst - 8; y <= kLast + 8; ++y)
    for (int x = kFirst - 8; x <= kLast + 8; ++x) {
      if (x >= kFirst - 1 && x <= kLast + 1 && y >= kFirst - 1 && y <= kLast + 1) continue;
      told += lamp.variance()[static_cast<size_t>(y) * kWidth + x];
      ++pixels;
    }
  CHECK(std::sqrt(told / pixels) == approx(sigma / std::sqrt(16.0)).epsilon(0.2));
  const double rim = lamp.variance()[static_cast<size_t>(kLamp) * kWidth + kFirst];
  CHECK(std::sqrt(rim) > 20);
  // As often bright as a lamp out of focus that one sample in two hundred meets
  const ErrorEstimate rare = estimate(16, [&](uint32_t p, uint32_t i, Pixel& pixel) {
    if (Random(p, i).next() < 0.005f) pixel.emission = {100, 100, 100};
  });
  const double true_error = 100 * std::sqrt(0.005 * 0.995 / 16);
  CHECK(root_mean_square(rare.variance()) > 0.7 * true_error);
  CHECK(root_mean_square(rare.variance()) < 1.3 * true_error);
}

TEST_CASE(
    "one pass is judged by its neighbours; a black picture has no error; no passes, no estimate") {
  const ErrorEstimate one = estimate(
      1, [](uint32_t p, uint32_t i, Pixel& pixel) { pixel.emission.y = Random(p, i).next(); });
  CHECK(root_mean_square(one.variance()) == approx(0.7152 / std::sqrt(12.0)).epsilon(0.4));
  const ErrorEstimate black = estimate(5, [](uint32_t, uint32_t, Pixel&) {});
  CHECK(black.figures().relative_rmse == 0);
  CHECK(root_mean_square(black.variance()) < 1e-6);
  CHECK(estimate(0, [](uint32_t, uint32_t, Pixel&) {}).figures().mean_luminance == 0);
}
