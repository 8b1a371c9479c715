#include <doctest/doctest.h>

#include <cstring>
#include <memory>

#include "photons/photon_tracer.h"
#include "support/approx.h"

using namespace photon_splat;

namespace {

struct Case {
  PhotonPaths paths{};
  RayHits hits{};
  PlainSurfaces surfaces{};
};

std::unique_ptr<Case> random_case(uint32_t seed) {
  auto out = std::make_unique<Case>();
  auto& [paths, hits, surfaces] = *out;
  Random random(7, seed);
  const auto put = [](const Vec3& v, uint32_t i, float* x, float* y, float* z) {
    x[i] = v.x, y[i] = v.y, z[i] = v.z;
  };
  for (uint32_t i = 0; i < kBounceLanes; ++i) {
    const Vec3 way = sample_sphere(random.next2()),
               n = Basis(-way).to_world(sample_cosine_hemisphere(random.next2()));
    put({random.next(), random.next(), random.next()}, i, paths.red, paths.green, paths.blue);
    put(way, i, paths.direction_x, paths.direction_y, paths.direction_z);
    paths.reference[i] = 0.5f + random.next();
    paths.caustic[i] = i % 3 ? random.next() : 1;
    paths.bounces[i] = i % 4;
    paths.random[i] = random.state();
    paths.first_u[i] = i ? random.next() : 0.5f;
    paths.first_v[i] = i ? random.next() : 0.5f;
    put(n, i, hits.nx, hits.ny, hits.nz);
    put({10 * random.next() - 5, 4 * random.next() - 9, random.next()}, i, hits.x, hits.y, hits.z);
    hits.distance[i] = 20 * random.next();
    hits.back[i] = i & 1;
    const Vec3 smooth =
        i % 5 ? (n + sample_sphere(random.next2()) * 0.7f) * (i & 1 ? -3.0f : 3.0f) : Vec3{};
    put(smooth, i, surfaces.nx, surfaces.ny, surfaces.nz);
    put({random.next(), random.next(), i % 7 ? random.next() : 1.5f}, i, surfaces.red,
        surfaces.green, surfaces.blue);
  }
  return out;
}

}  // namespace

TEST_CASE(
    "paths bounce to the same places, bit for bit, on every instruction set, and as the plain formulas say") {
  int went_on = 0, stored = 0;
  for (uint32_t seed = 0; seed < 40; ++seed) {
    const auto given = random_case(seed);
    const auto& [paths, hits, surfaces] = *given;
    const BounceSettings settings{1, seed & 1 ? -1.0f : 0.0f, 3};
    Bounced plain{};
    choose_bounce_kernel("generic")(paths, 0, hits, surfaces, settings, plain);
    for (const char* name : {"sse42", "avx2", "avx512"}) {
      const BounceKernel kernel = choose_bounce_kernel(name);
      if (!kernel) continue;
      Bounced out{};
      kernel(paths, 0, hits, surfaces, settings, out);
      CAPTURE(name);
      CHECK(std::memcmp(&out, &plain, sizeof out) == 0);
    }
    for (uint32_t i = 0; i < kBounceLanes; ++i) {
      CAPTURE(i);
      const Vec3 way{paths.direction_x[i], paths.direction_y[i], paths.direction_z[i]},
          ng{hits.nx[i], hits.ny[i], hits.nz[i]};
      const Vec3 smooth{surfaces.nx[i], surfaces.ny[i], surfaces.nz[i]},
          x{hits.x[i], hits.y[i], hits.z[i]};
      const Vec3 ns = length(smooth) > 0 ? normalize(smooth) * (hits.back[i] ? -1.0f : 1.0f) : ng;
      const float cos_shading = -dot(way, ns), cos_geometric = -dot(way, ng),
                  share = 1 + settings.share_of_caustic * paths.caustic[i];
      const Rgb power{paths.red[i], paths.green[i], paths.blue[i]};
      const bool faces = cos_shading > 0 && cos_geometric > 0;
      CHECK((plain.stores >> i & 1) == (faces && paths.bounces[i] && share > 0));
      CHECK(plain.stored_green[i] == power.y * (share * cos_shading / cos_geometric));
      CHECK(plain.directions[i] ==
            (encode_direction(ng) | static_cast<uint32_t>(encode_direction(-way)) << 16));
      Random random = Random::at(paths.random[i]);
      const Rgb scattered = power * (Rgb{surfaces.red[i], surfaces.green[i], surfaces.blue[i]} *
                                     (cos_shading / cos_geometric));
      const float survival = std::min(1.0f, max_component(scattered) / paths.reference[i]);
      const bool goes_on =
          faces && paths.bounces[i] != 3 && survival > 0 && random.next() < survival;
      CHECK((plain.goes_on >> i & 1) == goes_on);
      stored += plain.stores >> i & 1, went_on += goes_on;
      if (!goes_on) continue;
      const Vec3 origin = x + ng * ray_epsilon(x, hits.distance[i]);
      const Vec2 u = paths.bounces[i] ? random.next2() : Vec2{paths.first_u[i], paths.first_v[i]};
      const Vec3 on = Basis(ng).to_world(sample_cosine_hemisphere(u));
      CHECK(plain.blue[i] == scattered.z * (1 / survival));
      CHECK(plain.random[i] == random.state());
      CHECK(plain.origin_x[i] == origin.x);
      CHECK(plain.direction_x[i] == on.x);
      CHECK(plain.direction_y[i] == on.y);
      CHECK(plain.direction_z[i] == on.z);
    }
  }
  CHECK(stored > 100);
  CHECK(went_on > 100);
}

TEST_CASE(
    "runs of photons are joined in their order, however they come and however many were expected") {
  constexpr size_t kRuns = 200;
  ThreadPool pool(4);
  const CancelFlag never;
  PhotonJoin join;
  for (const size_t expected : {size_t{0}, size_t{50}, size_t{1000}, size_t{100000}}) {
    CAPTURE(expected);
    join.begin(kRuns, expected, true);
    pool.for_each(kRuns, never, [&](size_t c, int) {
      const size_t number = c ^ 3;  // neighbours change places
      std::unique_ptr<PhotonRun> run = join.take();
      CHECK(run->photons.empty());
      for (size_t i = 0; i < number % 17; ++i) {
        Photon photon{};
        photon.key = static_cast<uint32_t>(100 * number + i);
        run->photons.push_back(photon);
        run->groups.push_back(static_cast<int16_t>(number));
      }
      run->rays = number;
      join.add(number, std::move(run));
    });
    join.finish(pool, never);
    size_t place = 0;
    for (size_t number = 0; number < kRuns; ++number)
      for (size_t i = 0; i < number % 17; ++i, ++place) {
        REQUIRE(place < join.photons().size());
        CHECK(join.photons()[place].key == 100 * number + i);
        CHECK(join.groups()[place] == static_cast<int16_t>(number));
      }
    CHECK(join.photons().size() == place);
    CHECK(join.groups().size() == place);
    CHECK(join.rays() == kRuns * (kRuns - 1) / 2);
  }
}

TEST_CASE(
    "the dispersion of photons' power is its mean square over the squared mean, and within bounds") {
  const auto of = [](std::initializer_list<float> powers) {
    Photons photons;
    for (const float power : powers) photons.push_back({{}, 0, 0, 0, {power, power, power}});
    return power_dispersion(photons);
  };
  CHECK(of({2, 2, 2}) == approx(1));
  CHECK(of({1, 3}) == approx(1.25));
  CHECK(of({}) == 1);
  CHECK(of({0, 0}) == 1);
  Photons rare(1000, Photon{});
  rare[7].power = {1, 1, 1};
  CHECK(power_dispersion(rare) == 32);
}
