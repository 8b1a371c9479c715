#include <doctest/doctest.h>

#include "sample_choice.h"
#include "sampling.h"

using namespace photon_splat;

namespace {

constexpr int kWidth = 32, kHeight = 24;

// After `passes` passes of a picture in which camera_noise(x) and photon_noise(x) are the deviations of one sample of each kind.
template <class Camera, class Photons>
SampleChoice after(uint32_t passes, Camera&& camera_noise, Photons&& photon_noise, uint32_t least = 1) {
  ThreadPool pool(2);
  SampleChoice choice;
  choice.reset(kWidth, kHeight, least);
  Film film;
  film.reset(kWidth, kHeight);
  Random random(3, 5);
  const auto noise = [&](float deviation) { return deviation * std::sqrt(3.0f) * (2 * random.next() - 1); };
  for (uint32_t pass = 0; pass < passes; ++pass) {
    for (size_t i = 0; i < film.pixels.size(); ++i) {
      Pixel& p = film.pixels[i] = {};
      const int x = static_cast<int>(i % kWidth);
      p.samples = static_cast<float>(choice.count(i));
      for (uint32_t s = 0; s < choice.count(i); ++s) p.emission += Rgb{1, 1, 1} * (1 + noise(camera_noise(x)));
    }
    choice.see_camera(film, pool);
    for (size_t i = 0; i < film.pixels.size(); ++i) {  // photons are those of the pass, for all its samples
      Pixel& p = film.pixels[i];
      p.diffuse_indirect += Rgb{1, 1, 1} * (p.samples * (1 + noise(photon_noise(static_cast<int>(i % kWidth)))));
    }
    choice.end_pass(film, 1, pool);
    choice.begin_pass(pool);
  }
  return choice;
}

uint32_t total(const SampleChoice& choice) {
  uint32_t sum = 0;
  for (size_t i = 0; i < size_t(kWidth) * kHeight; ++i) sum += choice.count(i);
  return sum;
}

constexpr size_t kMiddle = static_cast<size_t>(kHeight / 2) * kWidth;
const auto nothing = [](int) { return 0.0f; };
const auto even = [](int) { return 0.05f; };
const auto stripe = [](int x) { return x == 20 ? 1.0f : 0.01f; };

}  // namespace

TEST_CASE("camera samples go where they deviate, not many more than photons are worth, and numbers are used once") {
  for (uint32_t passes : {1u, 2u, 8u, 64u}) {
    const SampleChoice choice = after(passes, stripe, even);
    CHECK(choice.count(kMiddle + 20) >= 4);  // of the eight around, two are in the stripe
    CHECK(choice.count(kMiddle + 5) == 1);
    CHECK(total(choice) <= 5 * kWidth * kHeight);
    CHECK(choice.first(kMiddle + 5, passes) == passes);
  }
  const SampleChoice once = after(1, stripe, even), twice = after(2, stripe, even);
  CHECK(once.first(kMiddle + 20, 1) == 1);
  CHECK(twice.first(kMiddle + 20, 2) == 1 + once.count(kMiddle + 20));
}

TEST_CASE("camera noise like the photons' and less, or none at all, asks for no more camera samples") {
  CHECK(total(after(16, [](int) { return 0.1f; }, [](int) { return 0.12f; })) == kWidth * kHeight);
  CHECK(total(after(16, nothing, stripe)) == kWidth * kHeight);
  CHECK(total(after(16, stripe, [](int) { return 5.0f; })) == kWidth * kHeight);
}

TEST_CASE("camera noise without any of photons gets more samples everywhere, within bounds") {
  const uint32_t all = total(after(16, [](int) { return 0.3f; }, nothing));
  CHECK(all > kWidth * kHeight);
  CHECK(all <= 4 * kWidth * kHeight);
}

TEST_CASE("a least number of samples is for all pixels from the second pass on, as far as it is worth it") {
  const SampleChoice first = after(0, stripe, even, 4), quiet = after(4, stripe, nothing, 4);
  CHECK(total(first) == kWidth * kHeight);
  CHECK(quiet.count(kMiddle + 5) == 4);
  CHECK(quiet.count(kMiddle + 20) > 4);
  CHECK(total(after(4, stripe, [](int) { return 5.0f; }, 4)) == kWidth * kHeight);  // of photons is the noise
  CHECK(total(after(4, nothing, nothing, 4)) == kWidth * kHeight);
}

TEST_CASE("limited samples keep where they go, and number on") {
  SampleChoice choice = after(4, stripe, nothing, 4);
  const uint32_t first = choice.first(kMiddle + 20, 4), count = choice.count(kMiddle + 20);
  ThreadPool pool(2);
  choice.limit(3, pool);
  CHECK(choice.mean_count() <= 3);
  CHECK(choice.count(kMiddle + 20) > choice.count(kMiddle + 5));
  CHECK(choice.count(kMiddle + 20) < count);
  CHECK(choice.first(kMiddle + 20, 4) == first);
  choice.limit(0, pool);
  CHECK(choice.mean_count() == 1);
}

TEST_CASE("a black picture and light that is not finite ask for nothing") {
  CHECK(total(after(4, nothing, nothing)) == kWidth * kHeight);
  CHECK(total(after(4, [](int) { return INFINITY; }, nothing)) == kWidth * kHeight);
}

TEST_CASE("heavy-tailed noise: samples that ask for more do not make the mean darker") {
  // One sample in 50 is 50, the others are 0; a picture of mean 1.
  ThreadPool pool(2);
  double sum = 0, squares = 0;
  constexpr int kRuns = 40;
  for (int run = 0; run < kRuns; ++run) {
    SampleChoice choice;
    choice.reset(kWidth, kHeight);
    Film film;
    film.reset(kWidth, kHeight);
    Random random(11, static_cast<uint32_t>(run));
    std::vector<double> light(film.pixels.size()), samples(film.pixels.size());
    for (uint32_t pass = 0; pass < 6; ++pass) {
      for (size_t i = 0; i < film.pixels.size(); ++i) {
        Pixel& p = film.pixels[i] = {};
        p.samples = static_cast<float>(choice.count(i));
        for (uint32_t s = 0; s < choice.count(i); ++s) p.emission += Rgb{1, 1, 1} * (random.next() < 0.02f ? 50.0f : 0.0f);
        light[i] += luminance(p.emission);
        samples[i] += p.samples;
      }
      choice.see_camera(film, pool);
      choice.end_pass(film, 1, pool);
      choice.begin_pass(pool);
    }
    double mean = 0;
    for (size_t i = 0; i < light.size(); ++i) mean += light[i] / samples[i] / static_cast<double>(light.size());
    sum += mean;
    squares += mean * mean;
  }
  const double mean = sum / kRuns, error = std::sqrt((squares / kRuns - mean * mean) / (kRuns - 1));
  CAPTURE(mean);
  CHECK(std::abs(mean - 1) < 3.5 * error);
  CHECK(error < 0.02);
}
