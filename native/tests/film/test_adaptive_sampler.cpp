#include <doctest/doctest.h>

#include "film/adaptive_sampler.h"
#include "math/sampling.h"
#include "support/approx.h"

using namespace photon_splat;

namespace {

constexpr int kWidth = 32, kHeight = 24;

// After `passes` passes of a picture in which camera_noise(x) and photon_noise(x) are the
// deviations of one sample of each kind.
template <class Camera, class Photons>
AdaptiveSampler after(uint32_t passes, Camera&& camera_noise, Photons&& photon_noise,
                      uint32_t least = 1, const PassWork& work = {1, 0},
                      const PhotonSet& asked = {}, uint32_t (*first)(int) = nullptr) {
  ThreadPool pool(2);
  AdaptiveSampler choice;
  choice.reset(kWidth, kHeight, least, {asked});
  for (size_t i = 0; first && i < size_t(kWidth) * kHeight; ++i)
    choice.begin_with(i, first(static_cast<int>(i % kWidth)));
  Film film;
  film.reset(kWidth, kHeight);
  Random random(3, 5);
  const auto noise = [&](float deviation) {
    return deviation * std::sqrt(3.0f) * (2 * random.next() - 1);
  };
  for (uint32_t pass = 0; pass < passes; ++pass) {
    for (size_t i = 0; i < film.pixels.size(); ++i) {
      Pixel& p = film.pixels[i] = {};
      const int x = static_cast<int>(i % kWidth);
      p.samples = static_cast<float>(choice.count(i));
      for (uint32_t s = 0; s < choice.count(i); ++s)
        p.emission += Rgb{1, 1, 1} * (1 + noise(camera_noise(x)));
    }
    choice.see_camera(film, pool);
    PhotonSet& photons = choice.photons(0);
    // Photons are those of the pass, for all its samples
    for (size_t i = 0; i < film.pixels.size(); ++i) {
      Pixel& p = film.pixels[i];
      photons.noise[i] =
          photon_noise(static_cast<int>(i % kWidth)) / static_cast<float>(std::sqrt(photons.count));
      p.diffuse_indirect += Rgb{1, 1, 1} * (p.samples * (1 + noise(photons.noise[i])));
    }
    photons.work = photons.count;
    choice.end_pass(film, work, pool);
    choice.begin_pass(pool);
  }
  return choice;
}

uint32_t total(const AdaptiveSampler& choice) {
  uint32_t sum = 0;
  for (size_t i = 0; i < size_t(kWidth) * kHeight; ++i) sum += choice.count(i);
  return sum;
}

constexpr size_t kMiddle = static_cast<size_t>(kHeight / 2) * kWidth;
const auto nothing = [](int) { return 0.0f; };
const auto even = [](int) { return 0.05f; };
const auto stripe = [](int x) { return x == 20 ? 1.0f : 0.01f; };

}  // namespace

TEST_CASE(
    "camera samples go where they deviate, not many more than photons are worth, and numbers are used once") {
  for (uint32_t passes : {1u, 2u, 8u, 64u}) {
    const AdaptiveSampler choice = after(passes, stripe, even);
    CHECK(choice.count(kMiddle + 20) >= 4);  // of the eight around, two are in the stripe
    CHECK(choice.count(kMiddle + 5) == 1);
    CHECK(total(choice) <= 5 * kWidth * kHeight);
    CHECK(choice.first(kMiddle + 5, passes) == passes);
  }
  const AdaptiveSampler once = after(1, stripe, even), twice = after(2, stripe, even);
  CHECK(once.first(kMiddle + 20, 1) == 1);
  CHECK(twice.first(kMiddle + 20, 2) == 1 + once.count(kMiddle + 20));
}

TEST_CASE(
    "camera noise like the photons' and less, or none at all, asks for no more camera samples") {
  CHECK(total(after(16, [](int) { return 0.1f; }, [](int) { return 0.12f; })) == kWidth * kHeight);
  CHECK(total(after(16, nothing, stripe)) == kWidth * kHeight);
  CHECK(total(after(16, stripe, [](int) { return 5.0f; })) == kWidth * kHeight);
}

TEST_CASE("where a first pass has had more samples, as many are asked for as elsewhere") {
  const auto left_has_more = [](int x) { return x < kWidth / 2 ? 4u : 1u; };
  const AdaptiveSampler choice =
      after(1, [](int) { return 0.3f; }, [](int) { return 0.1f; }, 1, {1, 0}, {}, left_has_more);
  double left = 0, right = 0;
  for (size_t i = 0; i < size_t(kWidth) * kHeight; ++i)
    (i % kWidth < kWidth / 2 ? left : right) += choice.count(i);
  CHECK(left == approx(right).epsilon(0.1));
  CHECK(right > 1.2 * kWidth * kHeight / 2);
}

TEST_CASE("camera noise without any of photons gets more samples everywhere, within bounds") {
  const uint32_t all = total(after(16, [](int) { return 0.3f; }, nothing));
  CHECK(all > kWidth * kHeight);
  CHECK(all <= 12 * kWidth * kHeight);
}

TEST_CASE(
    "a least number of samples is for all pixels from the second pass on, as far as it is worth it") {
  const AdaptiveSampler first = after(0, stripe, even, 4), quiet = after(4, stripe, nothing, 4);
  CHECK(total(first) == kWidth * kHeight);
  CHECK(quiet.count(kMiddle + 5) == 4);
  CHECK(quiet.count(kMiddle + 20) > 4);
  // Of photons is the noise
  CHECK(total(after(4, stripe, [](int) { return 5.0f; }, 4)) == kWidth * kHeight);
  CHECK(total(after(4, nothing, nothing, 4)) == kWidth * kHeight);
}

TEST_CASE(
    "photons that no pixel's variance asks for are had where they are cheap beside the camera") {
  const auto count = [&](double wanted, double camera) {
    PhotonSet asked;
    asked.wanted = wanted;
    return after(4, even, nothing, 1, {camera, 0}, asked).photons(0).count;
  };
  CHECK(count(0, 100) == approx(0.25));  // the fewest
  CHECK(count(4, 1000) == approx(4));
  CHECK(count(100, 1e6) == approx(8));  // the most
  // A quarter of the camera's work, of eight samples in a pixel, in steps of a quarter octave
  CHECK(count(4, 0.5) == approx(1).epsilon(0.2));
}

TEST_CASE("limited samples keep where they go, and number on") {
  AdaptiveSampler choice = after(4, stripe, nothing, 4);
  const uint32_t first = choice.first(kMiddle + 20, 4), count = choice.count(kMiddle + 20);
  ThreadPool pool(2);
  choice.limit(3, 8, pool);
  CHECK(choice.mean_count() <= 3);
  CHECK(choice.mean_count() > 2.98);  // all of what is allowed
  CHECK(choice.count(kMiddle + 20) > choice.count(kMiddle + 5));
  CHECK(choice.count(kMiddle + 20) < count);
  CHECK(choice.first(kMiddle + 20, 4) == first);
  choice.limit(1, 8, pool);
  CHECK(choice.mean_count() == 1);
  CHECK_FALSE(choice.lacks_pixels());
}

TEST_CASE("a last pass may have samples of some pixels alone, of no column more than of others") {
  AdaptiveSampler choice = after(4, nothing, nothing);
  ThreadPool pool(2);
  choice.limit(0.4, 8, pool);
  CHECK(choice.lacks_pixels());
  CHECK(choice.mean_count() == approx(0.4).epsilon(0.02));
  const auto in_column = [&](size_t x) {
    int sum = 0;
    for (size_t y = 0; y < kHeight; ++y) sum += static_cast<int>(choice.count(y * kWidth + x));
    return static_cast<double>(sum) / static_cast<double>(kHeight);
  };
  for (size_t x = 0; x < kWidth; ++x) CHECK(in_column(x) == approx(0.4).epsilon(0.3));
  const uint32_t seen = choice.count(5), first = choice.first(5, 4);
  choice.count_pass();
  CHECK(choice.first(5, 5) == first + seen);  // none is left out of the sequence
  CHECK_FALSE(choice.lacks_pixels());
}

TEST_CASE("a black picture and light that is not finite ask for nothing") {
  CHECK(total(after(4, nothing, nothing)) == kWidth * kHeight);
  CHECK(total(after(4, [](int) { return INFINITY; }, nothing)) == kWidth * kHeight);
}

TEST_CASE("photons get what they are worth beside the camera's samples, within bounds") {
  const auto photons_after = [](float camera, float photons, const PassWork& work) {
    return after(
               16, [=](int) { return camera; }, [=](int) { return photons; }, 1, work)
        .photons(0)
        .count;
  };
  // Random samples: their order gains nothing. One of each pixel, as noise is the photons': (c^2 +
  // s^2/m) (1 + m) is least for m = s/c. With their blur, half of it again, they count as sqrt(1.5)
  // times as much.
  CHECK(photons_after(0.1f, 0.3f, {1, 0}) == approx(3 * std::sqrt(1.5)).epsilon(0.15));
  // Three times the work is fixed
  CHECK(photons_after(0.1f, 0.3f, {1, 3}) == approx(6 * std::sqrt(1.5)).epsilon(0.15));
  CHECK(photons_after(0.01f, 0.3f, {1, 0}) == 8);
  CHECK(photons_after(0.0f, 0.3f, {1, 0}) == 8);
  CHECK(photons_after(0.3f, 0.001f, {1, 0}) == 0.25);
  CHECK(photons_after(0.3f, 0.0f, {1, 0}) == 0.25);
}

TEST_CASE("a first pass has fewer photons where few paths bring light to where it is seen") {
  const auto first = [](double share) {
    PhotonSet photons;
    photons.begin_with_share(share);
    return photons.count;
  };
  CHECK(first(1) == 1);
  CHECK(first(0.5) == 1);
  CHECK(first(0.04) == approx(0.5));
  CHECK(first(0.003) == 0.25);
  CHECK(first(0) == 0.25);
  PhotonSet fixed;
  fixed.fewest = fixed.most = 1;
  fixed.begin_with_share(0.01);
  CHECK(fixed.count == 1);
}

TEST_CASE("limited photons keep their proportions; where all passes have to have as many they do") {
  ThreadPool pool(2);
  PhotonSet fixed;
  fixed.fewest = fixed.most = 1;
  AdaptiveSampler choice;
  choice.reset(kWidth, kHeight, 1, {PhotonSet{}, PhotonSet{}, fixed});
  Film film;
  film.reset(kWidth, kHeight);
  for (Pixel& p : film.pixels) p = {}, p.samples = 1;
  for (uint32_t pass = 0; pass < 2; ++pass) {
    choice.see_camera(film, pool);
    for (size_t set = 0; set < 3; ++set) {
      PhotonSet& photons = choice.photons(set);
      std::fill(photons.noise.begin(), photons.noise.end(), set ? 0.1f : 0.0f);
      photons.work = photons.count;
    }
    choice.end_pass(film, {1, 1}, pool);
    choice.begin_pass(pool);
  }
  CHECK(choice.photons(0).count == 0.25);
  CHECK(choice.photons(1).count == 8);
  CHECK(choice.photons(2).count == 1);
  CHECK(choice.photon_count() == approx(9.25 / 3));
  choice.limit(1, 9.25 / 6, pool);
  CHECK(choice.photons(1).count == approx(4));
  CHECK(choice.photons(0).count == approx(0.125));
  CHECK(choice.photons(2).count == 1);
}

TEST_CASE("heavy-tailed noise: samples that ask for more do not make the mean darker") {
  // One sample in 50 is 50, the others are 0; a picture of mean 1.
  ThreadPool pool(2);
  double sum = 0, squares = 0;
  constexpr int kRuns = 40;
  for (int run = 0; run < kRuns; ++run) {
    AdaptiveSampler choice;
    choice.reset(kWidth, kHeight, 1, {});
    Film film;
    film.reset(kWidth, kHeight);
    Random random(11, static_cast<uint32_t>(run));
    std::vector<double> light(film.pixels.size()), samples(film.pixels.size());
    for (uint32_t pass = 0; pass < 6; ++pass) {
      for (size_t i = 0; i < film.pixels.size(); ++i) {
        Pixel& p = film.pixels[i] = {};
        p.samples = static_cast<float>(choice.count(i));
        for (uint32_t s = 0; s < choice.count(i); ++s)
          p.emission += Rgb{1, 1, 1} * (random.next() < 0.02f ? 50.0f : 0.0f);
        light[i] += luminance(p.emission);
        samples[i] += p.samples;
      }
      choice.see_camera(film, pool);
      choice.end_pass(film, {1, 1}, pool);
      choice.begin_pass(pool);
    }
    double mean = 0;
    for (size_t i = 0; i < light.size(); ++i)
      mean += light[i] / samples[i] / static_cast<double>(light.size());
    sum += mean;
    squares += mean * mean;
  }
  const double mean = sum / kRuns, error = std::sqrt((squares / kRuns - mean * mean) / (kRuns - 1));
  CAPTURE(mean);
  CHECK(std::abs(mean - 1) < 3.5 * error);
  CHECK(error < 0.02);
}
