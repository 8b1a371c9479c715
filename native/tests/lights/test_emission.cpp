#include "lights/emission/photon_emitter.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <string>

#include "support/meshes.h"

using namespace photon_splat;

namespace {

struct Estimate {
  double mean = 0, error = 0;
};

// Power of the photons of `draw` that pass through a sphere, W, mean over RGB.
template <class Draw>
std::vector<Estimate> flux_through(const std::vector<EmissionTargets::Sphere>& spheres,
                                   uint64_t count, Draw&& draw) {
  std::vector<double> sum(spheres.size() + 1), squares(spheres.size() + 1);
  for (uint64_t i = 0; i < count; ++i) {
    const PhotonStart start = draw(i);
    const double power = average(start.power);
    REQUIRE(std::isfinite(power));
    REQUIRE(length(start.direction) == approx(1).epsilon(1e-4));
    for (size_t s = 0; s <= spheres.size(); ++s) {  // the last one: all photons
      if (s < spheres.size()) {
        const Vec3 to = spheres[s].center - start.origin;
        const float along = dot(to, start.direction), r2 = spheres[s].radius * spheres[s].radius;
        if (length2(to) - along * along > r2 || (along < 0 && length2(to) > r2)) continue;
      }
      sum[s] += power;
      squares[s] += power * power;
    }
  }
  std::vector<Estimate> out;
  for (size_t s = 0; s < sum.size(); ++s) {
    const double n = static_cast<double>(count), mean = sum[s] / n;
    out.push_back({mean, std::sqrt(std::max(squares[s] / n - mean * mean, 0.0) / n)});
  }
  return out;
}

class Mean {
 public:
  void add(double value) { ++count_, sum_ += value, squares_ += value * value; }
  double mean() const { return sum_ / count_; }
  double error() const {
    return std::sqrt(std::max(squares_ / count_ - mean() * mean(), 0.0) / count_);
  }

 private:
  double count_ = 0, sum_ = 0, squares_ = 0;
};

// Of the mean fluence rate in the ball what a photon brings: its power times its way there, over
// the volume. u: place on that way where its lamp is asked whether light gets there.
double light_in(const EmissionTargets::Sphere& ball, const PhotonStart& photon, float u) {
  const Vec3 to = ball.center - photon.origin;
  const float along = dot(to, photon.direction),
              half2 = sqr(ball.radius) - length2(to - photon.direction * along);
  if (!(half2 > 0)) return 0;
  const float half = std::sqrt(half2), from = std::max(along - half, 0.0f),
              way = along + half - from;
  if (!(way > 0) || !photon.accepts(from + way * u)) return 0;
  return double(average(photon.power)) * double(way) / (4 * M_PI / 3 * std::pow(ball.radius, 3));
}

LampSettings lamp_of(LampKind kind, Vec3 place = {0.5f, 0.5f, 3}) {
  LampSettings s;
  s.kind = kind;
  s.strength = {10, 20, 5};
  s.to_world.m = {1, 0, 0, place.x, 0, 1, 0, place.y, 0, 0, 1, place.z};
  return s;
}

struct Named {
  std::string name;
  std::vector<LampSettings> lamps;
  float world = 0;
  bool mesh = false;
};

std::vector<Named> lights_of_every_kind() {
  std::vector<Named> all;
  auto s = lamp_of(LampKind::kPoint);
  all.push_back({"point", {s}});
  s.radius = 0.6f;
  all.push_back({"soft point", {s}});
  s.soft_falloff = false;
  all.push_back({"spherical point", {s}});
  s.radius = 1.2f;
  s.to_world.m[11] = 1;
  all.push_back({"spherical point with things inside", {s}});
  s = lamp_of(LampKind::kSpot);
  s.spot_size = 1.2f;
  s.spot_blend = 0.4f;
  all.push_back({"spot", {s}});
  s.to_world.m[0] = 1.7f;
  s.to_world.m[10] = 0.8f;
  s.radius = 0.3f;
  all.push_back({"scaled soft spot", {s}});
  s.soft_falloff = false;
  s.radius = 1.5f;
  s.to_world.m[11] = 1;
  all.push_back({"spherical spot with things inside", {s}});
  s = lamp_of(LampKind::kSun);
  all.push_back({"sharp sun", {s}});
  s.angle = 0.3f;
  all.push_back({"wide sun", {s}});
  s = lamp_of(LampKind::kArea);
  all.push_back({"area", {s}});
  s.ellipse = true;
  all.push_back({"elliptic area", {s}});
  s.spread = 1.0f;
  all.push_back({"elliptic area of narrow spread", {s}});
  all.push_back({"world", {}, 0.7f});
  all.push_back({"mesh", {}, 0, true});
  all.push_back(
      {"several",
       {lamp_of(LampKind::kPoint, {2, 1, 2}), lamp_of(LampKind::kArea), lamp_of(LampKind::kSun)},
       0.3f,
       true});
  return all;
}

void fill_for(Scene& scene, const Named& lights) {
  scene.world = {lights.world, lights.world, lights.world};
  scene.materials.resize(2);
  if (lights.mesh) {
    scene.materials[1].front.emission = {3, 2, 1};
    scene.materials[1].back.emission = {0.5f, 0.5f, 0.5f};
  }
  scene.meshes.push_back(padded(make_cube()));
  scene.meshes.push_back(padded(make_grid(2, 1)));
  scene.add_instance(0, identity, {0});
  scene.add_instance(1, {1, 0, 0, 1.5, 0, 1, 0, 0, 0, 0, 1, 1.5}, {1});
  scene.build(CancelFlag());
}

}  // namespace

TEST_CASE(
    "aimed emission brings the flux that natural emission brings, to its targets and elsewhere") {
  constexpr uint64_t count = 1 << 16;
  const std::vector<EmissionTargets::Sphere> targets{{{0.4f, 0.6f, 0.9f}, 0.05f, 50},
                                                     {{0.9f, 0.2f, 0.3f}, 0.4f, 1}};
  std::vector<EmissionTargets::Sphere> probes = targets;
  probes.push_back({{-0.2f, 0.9f, 0.5f}, 0.5f});
  for (const Named& lights : lights_of_every_kind()) {
    CAPTURE(lights.name);
    Scene scene(1);
    fill_for(scene, lights);
    const Lights all(scene, lights.lamps);
    const EmissionTargets aimed = PhotonEmitter(all).aim_at(targets);
    const auto natural = flux_through(probes, 8 * count, [&](uint64_t i) {
      return PhotonEmitter(all).emit(PhotonEmitter(all).primary(i, 1, nullptr));
    });
    const auto towards = flux_through(
        probes, count, [&](uint64_t i) { return PhotonEmitter(all).emit_towards(aimed, i, 2); });
    for (size_t s = 0; s < natural.size(); ++s) {
      CAPTURE(s);
      CAPTURE(natural[s].mean);
      CAPTURE(towards[s].mean);
      const double error = std::hypot(natural[s].error, towards[s].error);
      CHECK(std::abs(natural[s].mean - towards[s].mean) < 4 * error + 1e-3 * natural[s].mean);
    }
    // What it is for: per photon, what reaches the small target is known far better.
    const double gain =
        natural[0].error * std::sqrt(8.0) / natural[0].mean / (towards[0].error / towards[0].mean);
    CAPTURE(gain);
    CHECK(gain > 2);
  }
}

TEST_CASE(
    "photons, light samples and rays find the same light in a ball, from lights of every kind") {
  constexpr uint32_t count = 1 << 15;
  const std::vector<EmissionTargets::Sphere> balls{
      {{0.4f, 0.6f, 0.9f}, 0.3f}, {{0.1f, 0.5f, 2.2f}, 0.25f}, {{0.9f, 0.2f, -0.5f}, 0.6f}};
  for (const EmissionTargets::Sphere& ball : balls)
    for (const Named& lights : lights_of_every_kind()) {
      if (lights.world > 0) continue;  // of one colour: it has no samples
      // Suns' photons go to where things are.
      if (ball.center.z > 2 && lights.name.find(" sun") != std::string::npos) continue;
      CAPTURE(lights.name);
      CAPTURE(ball.center.z);
      Scene scene(1);
      fill_for(scene, lights);
      const Lights all(scene, lights.lamps);
      Mean photons, samples, rays;
      uint32_t sampled = 0, met = 0;
      for (uint32_t i = 0; i < count; ++i) {
        photons.add(light_in(ball,
                             PhotonEmitter(all).emit(PhotonEmitter(all).primary(i, 1, nullptr)),
                             sobol_2d(i, 5, 9).x));
        const Vec3 inside = sample_sphere(sobol_2d(i, 2, 7)) * std::cbrt(sobol_2d(i, 3, 7).x);
        const Receiver at{ball.center + inside * ball.radius, {}, true};
        const auto light = [&](const Vec3& way) {
          return all.lamps_met(at, way, 0, INFINITY, INFINITY);
        };
        const auto s = all.sample(at, sobol_2d(i, 3, 7).y, sobol_2d(i, 4, 7));
        samples.add(s ? double(average(s->weight)) : 0);
        if (lights.lamps.empty()) continue;  // rays find a shining mesh as they find any other
        rays.add(double(average(light(sample_sphere(sobol_2d(i, 6, 7))))) * 4 * M_PI);
        if (!s || !(s->pdf > 0)) continue;
        const Rgb radiance = light(s->direction);
        ++sampled;
        if (is_black(radiance)) continue;  // rounding at a lamp's edge
        ++met;
        CHECK(average(radiance) == approx(double(average(s->weight * s->pdf))).epsilon(0.01));
      }
      CAPTURE(photons.mean());
      CAPTURE(samples.mean());
      const auto agree = [&](const Mean& other) {
        return std::abs(other.mean() - samples.mean()) <=
               4 * std::hypot(other.error(), samples.error()) + 1e-3 * samples.mean();
      };
      CHECK(agree(photons));
      if (sampled) CHECK(agree(rays));
      CHECK(met >= 0.97 * sampled);
    }
}

TEST_CASE(
    "emission focused on what is seen brings the same flux everywhere, and far more photons there") {
  constexpr uint64_t count = 1 << 16;
  const Vec3 seen{0.4f, 0.6f, 0.9f};
  const std::vector<EmissionTargets::Sphere> probes{{seen, 0.01f},
                                                    {{0.43f, 0.6f, 0.88f}, 0.02f},
                                                    {{0.9f, 0.2f, 0.3f}, 0.3f},
                                                    {{-0.2f, 0.9f, 0.5f}, 0.4f}};
  for (const Named& lights : lights_of_every_kind()) {
    if (lights.name != "world" && lights.name.find(" sun") == std::string::npos) continue;
    CAPTURE(lights.name);
    Scene scene(1);
    fill_for(scene, lights);
    Lights all(scene, lights.lamps);
    const std::vector<EmissionTargets::Sphere> targets{{{0.9f, 0.2f, 0.3f}, 0.2f, 1},
                                                       {seen, 0.02f, 1}};
    const auto wide = flux_through(probes, 32 * count, [&](uint64_t i) {
      return PhotonEmitter(all).emit(PhotonEmitter(all).primary(i, 1, nullptr));
    });
    all.focus(seen, 0.01f);
    const auto focused = flux_through(probes, 4 * count, [&](uint64_t i) {
      return PhotonEmitter(all).emit(PhotonEmitter(all).primary(i, 2, nullptr));
    });
    const EmissionTargets aimed = PhotonEmitter(all).aim_at(targets);
    const auto towards = flux_through(probes, 4 * count, [&](uint64_t i) {
      return PhotonEmitter(all).emit_towards(aimed, i, 4);
    });
    for (size_t s = 0; s < probes.size(); ++s) {
      CAPTURE(s);
      for (const auto& [a, b] :
           {std::pair(wide[s], focused[s]), std::pair(focused[s], towards[s])}) {
        CAPTURE(a.mean);
        CAPTURE(b.mean);
        CHECK(std::abs(a.mean - b.mean) < 4 * std::hypot(a.error, b.error) + 1e-3 * b.mean);
      }
    }
    const double gain = wide[0].error * std::sqrt(8.0) / focused[0].error;
    CAPTURE(gain);
    CHECK(gain > 4);
  }
}

TEST_CASE(
    "paths that start together start as they do one by one, where the upper half of their number changes as well") {
  Scene scene(1);
  Named lights{"area", {lamp_of(LampKind::kArea)}};
  fill_for(scene, lights);
  const Lights all(scene, lights.lamps);
  for (const uint64_t first : {uint64_t{7}, (uint64_t{3} << 32) - 21, uint64_t{1} << 32}) {
    EmissionPrimary together[SobolPair::kMost];
    PhotonEmitter(all).primaries(first, SobolPair::kMost, 3, nullptr, together);
    for (uint32_t i = 0; i < SobolPair::kMost; ++i) {
      const uint64_t index = first + i;
      const uint32_t key = hash_combine(3, static_cast<uint32_t>(index >> 32));
      const Vec2 place = sobol_2d(static_cast<uint32_t>(index), 1, key),
                 way = sobol_2d(static_cast<uint32_t>(index), 2, key);
      CHECK(together[i].place.x == place.x);
      CHECK(together[i].place.y == place.y);
      CHECK(together[i].way.x == way.x);
      CHECK(together[i].way.y == way.y);
      CHECK(together[i].emitter == 0);
    }
  }
}

TEST_CASE(
    "photons that are started together start as they do one by one, bit for bit, from lights of every kind") {
  for (const Named& lights : lights_of_every_kind()) {
    CAPTURE(lights.name);
    Scene scene(1);
    fill_for(scene, lights);
    const Lights all(scene, lights.lamps);
    for (const uint32_t count : {SobolPair::kMost, 5u}) {
      EmissionPrimary primaries[SobolPair::kMost];
      PhotonStart together[SobolPair::kMost];
      PhotonEmitter(all).primaries(11, count, 3, nullptr, primaries);
      PhotonEmitter(all).emit(primaries, count, together);
      for (uint32_t i = 0; i < count; ++i) {
        const PhotonStart one = PhotonEmitter(all).emit(primaries[i]);
        const auto same = [](const Vec3& a, const Vec3& b) {
          return a.x == b.x && a.y == b.y && a.z == b.z;
        };
        CHECK(same(one.origin, together[i].origin));
        CHECK(same(one.direction, together[i].direction));
        CHECK(same(one.power, together[i].power));
        CHECK(one.plain() == together[i].plain());
        CHECK(one.first_hit_to == together[i].first_hit_to);
        CHECK(one.light_group == together[i].light_group);
      }
    }
  }
}

TEST_CASE(
    "targets that nothing can reach, of no size or of no weight leave natural emission alone") {
  Scene scene(1);
  Named lights{"area", {lamp_of(LampKind::kArea)}};
  fill_for(scene, lights);
  const Lights all(scene, lights.lamps);
  const EmissionTargets aimed = PhotonEmitter(all).aim_at(
      {{{0, 0, 9}, 0.1f, 1}, {{0, 0, 0}, 0, 1}, {{0, 0, 0}, 1, 0}, {{0, 0, 0}, NAN, 1}});
  for (uint64_t i = 0; i < 64; ++i) {
    const PhotonStart a = PhotonEmitter(all).emit(PhotonEmitter(all).primary(i, 3, nullptr)),
                      b = PhotonEmitter(all).emit_towards(aimed, i, 3);
    CHECK(b.aim == -1);
    CHECK(length(a.origin - b.origin) < 1e-6f);
    CHECK(length(a.direction - b.direction) < 1e-6f);
    CHECK(length(a.power - b.power) < 1e-3f * length(a.power));
  }
}

TEST_CASE("what was learnt sends photons to the targets of use, and changes no expectation") {
  Scene scene(1);
  Named lights{"point", {lamp_of(LampKind::kPoint)}};
  fill_for(scene, lights);
  const Lights all(scene, lights.lamps);
  const std::vector<EmissionTargets::Sphere> targets{{{0, 0, 0.5f}, 0.1f}, {{1, 1, 0.5f}, 0.1f}};
  EmissionTargets aimed = PhotonEmitter(all).aim_at(targets);
  const auto count_of = [&](const EmissionTargets& a) {
    int first = 0;
    for (uint64_t i = 0; i < 4096; ++i) first += PhotonEmitter(all).emit_towards(a, i, 5).aim == 0;
    return first;
  };
  const int before = count_of(aimed);
  for (uint64_t i = 0; i < 4096; ++i) {
    const PhotonStart start = PhotonEmitter(all).emit_towards(aimed, i, 5);
    PhotonEmitter(all).learn(aimed, i, 5, start.aim == 0 ? 1 : 0);
  }
  aimed.finish();
  const int after = count_of(aimed);
  CHECK(before == approx(4096 * 7 / 16).epsilon(0.02));
  CHECK(after > before * 1.6);
  CHECK(after < 4096 * 7 / 8);
  const auto natural = flux_through(targets, 1 << 18, [&](uint64_t i) {
    return PhotonEmitter(all).emit(PhotonEmitter(all).primary(i, 1, nullptr));
  });
  const auto towards = flux_through(
      targets, 1 << 16, [&](uint64_t i) { return PhotonEmitter(all).emit_towards(aimed, i, 2); });
  for (size_t s = 0; s < natural.size(); ++s)
    CHECK(std::abs(natural[s].mean - towards[s].mean) <
          4 * std::hypot(natural[s].error, towards[s].error));
}

TEST_CASE("the world's photons come from where they were of use, and no expectation changes") {
  Scene scene(1);
  Named lights{"world", {}};
  lights.world = 1;
  fill_for(scene, lights);
  const Lights all(scene, lights.lamps);
  const PhotonEmitter emitter(all);
  const std::vector<EmissionTargets::Sphere> targets{{{0, 0, 0.5f}, 0.1f}};
  EmissionTargets aimed = emitter.aim_at(targets);
  const auto from_window = [](const PhotonStart& p) { return p.direction.y > 0.8f; };  // a tenth
  const auto share = [&](uint32_t seed) {
    int found = 0;
    for (uint64_t i = 0; i < 8192; ++i) found += from_window(emitter.emit_towards(aimed, i, seed));
    return found / 8192.0;
  };
  CHECK(share(5) == approx(0.1).epsilon(0.05));
  for (uint64_t i = 0; i < 65536; ++i)
    emitter.learn(aimed, i, 5, from_window(emitter.emit_towards(aimed, i, 5)));
  aimed.finish();
  CHECK(share(6) > 0.5);
  CHECK(share(6) < 0.95);
  const auto natural = flux_through(
      targets, 1 << 18, [&](uint64_t i) { return emitter.emit(emitter.primary(i, 1, nullptr)); });
  const auto towards =
      flux_through(targets, 1 << 16, [&](uint64_t i) { return emitter.emit_towards(aimed, i, 2); });
  for (size_t s = 0; s < natural.size(); ++s)
    CHECK(std::abs(natural[s].mean - towards[s].mean) <
          4 * std::hypot(natural[s].error, towards[s].error));
}

TEST_CASE(
    "photons of a lamp of soft falloff bring the light of its disc, however small it is beside the distance") {
  // On a sphere of radius d around the lamp, each place sees a disc of radius r: irradiance I /
  // (d^2 + r^2).
  constexpr double d = 20;
  for (const double ratio : {1e-6, 1e-5, 5e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0})
    for (const bool aimed : {false, true}) {
      CAPTURE(ratio);
      CAPTURE(aimed);
      Scene scene(1);
      fill_for(scene, {"", {}});
      LampSettings lamp = lamp_of(LampKind::kPoint, {7, -3, 11});
      lamp.radius = static_cast<float>(ratio * d);
      const Lights lights(scene, {lamp});
      const EmissionTargets targets = PhotonEmitter(lights).aim_at({{{0.4f, 0.6f, 0.9f}, 0.5f, 1}});
      constexpr uint64_t count = 1 << 16;
      double sum = 0;
      for (uint64_t i = 0; i < count; ++i) {
        const PhotonStart start =
            aimed ? PhotonEmitter(lights).emit_towards(targets, i, 1)
                  : PhotonEmitter(lights).emit(PhotonEmitter(lights).primary(i, 1, nullptr));
        const double since = std::sqrt(d * d - double(start.soft_miss2));
        if (start.accepts(static_cast<float>(since) + start.soft_nearest))
          sum += average(start.power) / count;
      }
      const double expected = average(lamp.strength) / (1 + ratio * ratio);
      CHECK(sum == approx(expected).epsilon(aimed ? 0.05 : 0.003));
    }
}

TEST_CASE("a small lamp is met by the rays that its light samples come from") {
  Scene scene(1);
  fill_for(scene, {"", {}});
  for (const float radius : {1e-4f, 1e-3f, 1e-2f, 1.0f})
    for (const bool soft : {false, true}) {
      CAPTURE(radius);
      CAPTURE(soft);
      LampSettings lamp = lamp_of(LampKind::kPoint, {7, -3, 11});
      lamp.radius = radius;
      lamp.soft_falloff = soft;
      const Lights lights(scene, {lamp});
      const Receiver from{{-3, 2, -5}, {}, true};
      int met = 0;
      constexpr int count = 400;
      for (int i = 0; i < count; ++i) {
        const auto light = lights.sample(from, 0.5f, sobol_2d(static_cast<uint32_t>(i), 0, 1));
        REQUIRE(light.has_value());
        met += !is_black(lights.lamps_met(from, light->direction, 0, INFINITY, INFINITY));
      }
      CHECK(met > count * 0.97);
    }
}

TEST_CASE("flattened lamps shine where an axis that they do not need is lost") {
  Scene scene(1);
  fill_for(scene, {"", {}});
  const auto power = [&](LampKind kind, Vec3 scale) {
    LampSettings lamp = lamp_of(kind);
    lamp.to_world.m[0] = scale.x, lamp.to_world.m[5] = scale.y, lamp.to_world.m[10] = scale.z;
    return Lights(scene, {lamp}).total_power();
  };
  for (const Vec3 scale : {Vec3{0, 1, 1}, Vec3{1, 1, 0}, Vec3{0, 0, 0}})
    CHECK(power(LampKind::kPoint, scale) == power(LampKind::kPoint, {1, 1, 1}));
  for (const Vec3 scale : {Vec3{0, 1, 1}, Vec3{1, 0, 1}, Vec3{0, 0, -1}})
    CHECK(power(LampKind::kSun, scale) == power(LampKind::kSun, {1, 1, 1}));
  CHECK(power(LampKind::kSun, {1, 1, 0}) == 0);
  for (const LampKind kind : {LampKind::kSpot, LampKind::kArea}) CHECK(power(kind, {0, 1, 1}) == 0);
}
