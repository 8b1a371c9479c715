#include "density/splatter.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <cstring>

#include "math/sampling.h"

using namespace photon_splat;

namespace {

Vec3 random_place(Random& random) { return {random.next(), random.next(), random.next() * 0.05f}; }

// Blocks of points scattered over the unit square, some places unused: in turn of two surfaces, and
// of one that is flat, bent a little (photons have the full weight at some of their parts only), or
// folded.
PointBlocks make_blocks(size_t count, std::vector<Bounds>& bounds) {
  PointBlocks blocks(count);
  bounds.assign(count, Bounds{});
  Random random(1, 2);
  for (size_t b = 0; b < count; ++b) {
    PointBlock& block = blocks[b];
    std::memset(&block, 0, sizeof block);
    const Vec3 corner = random_place(random) * 0.9f;
    for (uint32_t i = 0; i < kBlockSize; ++i) {
      block.inverse_h2[i] = INFINITY;
      if (i % 11 == 10) continue;
      const Vec3 p = corner + random_place(random) * 0.1f;
      const float h = 0.02f + 0.08f * random.next();
      block.x[i] = p.x, block.y[i] = p.y, block.z[i] = p.z;
      const float bend = b % 4 == 2 ? 0.5f : b % 4 == 3 ? 2.0f : 0.0f;
      const Vec3 n = normalize({bend * (random.next() - 0.5f), bend * (random.next() - 0.5f), 1});
      block.nx[i] = n.x, block.ny[i] = n.y, block.nz[i] = n.z;
      block.key[i] = b % 4 == 0 && random.next() < 0.5f ? 7 : 8;
      block.inverse_h2[i] = 1 / (h * h);
      bounds[b].add(p - Vec3{h, h, h});
      bounds[b].add(p + Vec3{h, h, h});
    }
  }
  return blocks;
}

Photons make_photons(size_t count) {
  Photons photons(count);
  for (size_t i = 0; i < count; ++i) {
    Random random(i, 3);
    const Vec3 place = random_place(random);
    const bool upright = place.x < 0.5f;  // the rest so bent that not all have the full weight
    const Vec3 normal = upright ? Vec3{random.next() - 0.5f, random.next() - 0.5f, 2}
                                : Vec3{random.next() - 0.5f, 0.4f, random.next()};
    photons[i] = {place,
                  random.next() < 0.5f ? 7u : 8u,
                  encode_direction(normalize(normal)),
                  encode_direction(normalize(normal + Vec3{random.next(), random.next(), 0} * 3)),
                  {random.next(), 1, 2}};
  }
  return photons;
}

// Sums in double precision, photon by photon and point by point.
struct Sums {
  double r = 0, b = 0, count = 0, narrow = 0, way_x = 0, way_z = 0;  // ways: by the power's r and b
};
Sums sums_at(const PointBlock& block, uint32_t i, const Photons& photons) {
  Sums sums;
  for (const Photon& p : photons) {
    const double dx = double(p.position.x) - block.x[i], dy = double(p.position.y) - block.y[i],
                 dz = double(p.position.z) - block.z[i];
    const double kernel = 1 - (dx * dx + dy * dy + dz * dz) * block.inverse_h2[i];
    const Vec3 n = decode_direction(p.normal);
    const double facing = std::min(
        1.0,
        2.0 * (double(n.x) * block.nx[i] + double(n.y) * block.ny[i] + double(n.z) * block.nz[i]));
    if (kernel <= 0 || facing <= 0 || p.key != block.key[i]) continue;
    sums.r += kernel * facing * p.power.x;
    sums.b += kernel * facing * p.power.z;
    ++sums.count;
    const Vec3 way = way_over_cosine(decode_direction(p.from), n);
    sums.way_x += kernel * facing * p.power.x * way.x;
    sums.way_z += kernel * facing * p.power.z * way.z;
    sums.narrow += std::max(0.0, 2 * kernel - 1) * facing * luminance(p.power);  // 1 - 2 d^2/h^2
  }
  return sums;
}

// Two blocks of three are around bumps.
WaySums ways_of(size_t block_count) {
  WaySums ways;
  ways.reset(block_count);
  for (size_t b = 0; b < block_count; ++b)
    if (b % 3) ways.want(b);
  ways.set_up();
  return ways;
}

std::vector<std::string> kernels_of_this_machine() {
  std::vector<std::string> names;
  for (const char* name : {"generic", "sse42", "avx2", "avx512"}) {
    try {
      choose_kernel(name);
      names.push_back(name);
    } catch (const std::invalid_argument&) {}
  }
  return names;
}

}  // namespace

TEST_CASE("every kernel gives the sums of the definition") {
  const Photons photons = make_photons(3000);
  ThreadPool pool(2);
  for (const std::string& name : kernels_of_this_machine()) {
    CAPTURE(name);
    std::vector<Bounds> bounds;
    PointBlocks blocks = make_blocks(40, bounds);
    Splatter splatter(name);
    CHECK(splatter.kernel_name() == name);
    splatter.set_blocks(bounds);
    WaySums ways = ways_of(blocks.size());
    splatter.splat(photons, blocks, ways, pool, CancelFlag());
    double caught = 0;
    for (const PointBlock& block : blocks) {
      const size_t number = size_t(&block - blocks.data());
      const WayBlock* const along = ways.of(number);
      REQUIRE((along != nullptr) == (number % 3 > 0));
      for (uint32_t i = 0; i < kBlockSize; ++i) {
        const Sums expected = sums_at(block, i, photons);
        CHECK(block.r[i] == approx(expected.r).epsilon(1e-3));
        CHECK(block.b[i] == approx(expected.b).epsilon(1e-3));
        // One photon may lie on the rim, within rounding
        CHECK(std::abs(block.count[i] - expected.count) <= 1);
        CHECK(block.narrow[i] == approx(expected.narrow).epsilon(1e-3));
        caught += block.count[i];
        if (!along) continue;
        CHECK(along->r[0][i] == approx(expected.way_x).epsilon(1e-3).scale(0.1));
        CHECK(along->b[2][i] == approx(expected.way_z).epsilon(1e-3).scale(0.1));
        const Rgb added = ways.added(number, i, {1, 0, 0.5f});
        CHECK(added.x == approx(along->r[0][i] + 0.5f * along->r[2][i]).epsilon(1e-5));
      }
    }
    CHECK(caught > 1000);
  }
}

TEST_CASE("the sums are the same bit for bit for any number of threads") {
  const Photons photons = make_photons(20000);
  std::vector<PointBlocks> results;
  std::vector<WaySums> way_results;
  for (int threads : {1, 2, 5}) {
    std::vector<Bounds> bounds;
    results.push_back(make_blocks(100, bounds));
    ThreadPool pool(threads);
    Splatter splatter;
    splatter.set_blocks(bounds);
    way_results.push_back(ways_of(100));
    splatter.splat(photons, results.back(), way_results.back(), pool, CancelFlag());
    CHECK(std::memcmp(way_results.back().of(1), way_results[0].of(1), sizeof(WayBlock)) == 0);
    CHECK(std::memcmp(results.back().data(), results[0].data(),
                      results[0].size() * sizeof(PointBlock)) == 0);
  }
}

TEST_CASE("no photons, no blocks: nothing happens") {
  ThreadPool pool(1);
  Splatter splatter;
  std::vector<Bounds> bounds;
  PointBlocks none, blocks = make_blocks(1, bounds);
  splatter.set_blocks({});
  WaySums ways;
  splatter.splat(make_photons(10), none, ways, pool, CancelFlag());
  splatter.set_blocks(bounds);
  splatter.splat({}, blocks, ways, pool, CancelFlag());
  CHECK(splatter.pairs() == 0);
}

TEST_CASE("an unknown kernel is refused") {
  CHECK_THROWS_WITH_AS(choose_kernel("mmx"),
                       "the splatting kernel 'mmx' does not run on this machine",
                       std::invalid_argument);
}
