// Shadow linking: light that passes things which do not block it, for camera paths and photons;
// light groups.
#include <doctest/doctest.h>

#include "render/renderer.h"
#include "support/approx.h"
#include "support/passes.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

constexpr int size = 24;
constexpr uint64_t photons = 20000;

enum class Thing { kNone, kGrey, kMirror, kGlass };

// A room [-1, 1]^2 x [0, 2] of albedo 1/2, lit by a lamp under its ceiling, with a ball in the
// middle that does not block the lamp's light, or does.
void fill_room(Renderer& renderer, Thing thing, float radius, bool blocking, bool lit = true) {
  Material grey;
  grey.front.albedo = grey.back.albedo = {0.5f, 0.5f, 0.5f};
  renderer.scene.materials = {grey, grey};
  if (thing == Thing::kMirror || thing == Thing::kGlass) {
    ProgramWriter w;
    const ProgramWriter::Values values{{"weight", w.constant({1})},
                                       {"color", w.constant({0.9f, 0.9f, 0.9f})},
                                       {"ior", w.constant({1.5f})}};
    w.emit(thing == Thing::kMirror ? nodes::Op::Glossy : nodes::Op::Glass, values);
    w.emit(nodes::Op::End, {});
    check_program(renderer.scene, w.program());
    w.program().features = kProgramSharp;
    renderer.scene.programs = {w.program()};
    renderer.scene.materials[1].program = 0;
  }
  renderer.scene.meshes.push_back(padded(make_cube()));
  renderer.scene.meshes.push_back(padded(make_sphere(16, 32)));
  renderer.scene.add_instance(0, {2, 0, 0, -1, 0, 2, 0, -1, 0, 0, 2, 0}, {0});
  if (thing != Thing::kNone) {
    renderer.scene.add_instance(1, {0.4, 0, 0, 0, 0, 0.4, 0, 0, 0, 0, 0.4, 0.8}, {1});
    renderer.scene.instances.back().group = 2;
  }
  LampSettings lamp;
  lamp.kind = LampKind::kArea;
  lamp.to_world = Affine{{1, 0, 0, 0.1f, 0, 1, 0, 0, 0, 0, 1, 1.95f}};
  lamp.size_x = lamp.size_y = radius;
  lamp.strength = {10, 9, 8};
  if (!blocking) lamp.blockers = 1;
  if (!lit) lamp.lit_groups = 1;
  renderer.lamps = {lamp};
  CameraSettings& camera = renderer.camera_settings;  // from above, beside the ball
  camera.to_world = Affine{{1, 0, 0, -0.8f, 0, 1, 0, 0, 0, 0, 1, 1.9f}};
  camera.width = camera.height = camera.region_width = camera.region_height = size;
  renderer.options.photons_per_pass = photons;
  renderer.build();
}

Rgb mean_light(Renderer& renderer, uint32_t passes, bool reference) {
  render_passes(renderer, passes, reference);
  Rgb sum{};
  for (const Pixel& p : renderer.film().unpacked().pixels) sum += p.combined() * p.share();
  return sum / float(renderer.film().unpacked().pixels.size());
}

// Whether both films show the same surface at a pixel and two pixels around it.
bool alike_around(const Film& a, const Film& b, size_t i) {
  const int x = int(i) % size, y = int(i) / size;
  for (int v = std::max(0, y - 2); v <= std::min(size - 1, y + 2); ++v)
    for (int u = std::max(0, x - 2); u <= std::min(size - 1, x + 2); ++u)
      if (std::abs(a.pixels[v * size + u].depth - b.pixels[v * size + u].depth) > 1e-5f)
        return false;
  return true;
}

}  // namespace

TEST_CASE(
    "a thing that neither blocks a lamp nor is lit by it changes no direct light on what is seen beside it") {
  Renderer without(2), with(2), blocked(2);
  fill_room(without, Thing::kNone, 0.2f, true);
  fill_room(with, Thing::kGrey, 0.2f, false, false);
  fill_room(blocked, Thing::kGrey, 0.2f, true, false);
  for (Renderer* r : {&without, &with, &blocked}) r->trace_reference(0);
  int beside = 0, darker = 0;
  for (size_t i = 0; i < without.film().unpacked().pixels.size(); ++i) {
    const Pixel &a = without.film().unpacked().pixels[i], &b = with.film().unpacked().pixels[i],
                &c = blocked.film().unpacked().pixels[i];
    if (!alike_around(without.film().unpacked(), with.film().unpacked(), i)) continue;
    ++beside;
    CHECK(luminance(b.diffuse_direct) == approx(luminance(a.diffuse_direct)).epsilon(1e-5));
    darker += luminance(c.diffuse_direct) < 0.9f * luminance(a.diffuse_direct);
  }
  CHECK(beside > size * size / 4);
  CHECK(darker > size / 3);
}

TEST_CASE(
    "photons and paths agree on light that passes a thing and lights it all the same, and on caustics of such a thing") {
  for (const Thing thing : {Thing::kGrey, Thing::kMirror, Thing::kGlass})
    for (const bool lit : {true, false}) {
      if (thing == Thing::kGlass && !lit) continue;
      CAPTURE(int(thing));
      CAPTURE(lit);
      Renderer traced(2), splatted(2), blocked(2);
      fill_room(traced, thing, 0.9f, false, lit);
      fill_room(splatted, thing, 0.9f, false, lit);
      fill_room(blocked, thing, 0.9f, true, lit);
      const Rgb reference = mean_light(traced, 128, true), found = mean_light(splatted, 8, false);
      CHECK(splatted.map_count() == (thing == Thing::kGrey ? 1 : 2));
      for (int k = 0; k < 3; ++k) CHECK((&found.x)[k] == approx((&reference.x)[k]).epsilon(0.01));
      CHECK(luminance(mean_light(blocked, 4, false)) < 0.97f * luminance(reference));
    }
}

TEST_CASE(
    "a shining surface behind things that do not block it is found by light samples and by rays, alone and together") {
  // The floor under a large plate that shines through a ball: mean of light samples and rays,
  // whatever the balance.
  const auto fill = [](Renderer& renderer, bool ball) {
    Material grey, glow;
    grey.front.albedo = grey.back.albedo = {0.5f, 0.5f, 0.5f};
    glow.front.albedo = glow.back.albedo = {0, 0, 0};
    glow.front.emission = glow.back.emission = {1, 1, 1};
    renderer.scene.materials = {grey, glow};
    renderer.scene.meshes.push_back(padded(make_grid(1)));
    renderer.scene.meshes.push_back(padded(make_sphere(8, 16)));
    renderer.scene.add_instance(0, {8, 0, 0, -4, 0, 8, 0, -4, 0, 0, 1, 0}, {0});
    renderer.scene.add_instance(0, {1, 0, 0, -0.5, 0, 1, 0, -0.5, 0, 0, 1, 0.5}, {1});
    renderer.scene.instances.back().blockers = 1;
    renderer.scene.instances.back().lit_groups = 1;
    if (ball) {
      renderer.scene.add_instance(1, {0.05, 0, 0, 0, 0, 0.05, 0, 0, 0, 0, 0.05, 0.2}, {0});
      renderer.scene.instances.back().group = 2;
    }
    renderer.camera_settings.to_world = Affine{{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.45f}};
    renderer.camera_settings.width = renderer.camera_settings.height = size;
    renderer.camera_settings.region_width = renderer.camera_settings.region_height = size;
    renderer.options.max_bounces = 0;
    renderer.build();
  };
  Renderer without(2), with(2);
  fill(without, false);
  fill(with, true);
  double sum[2] = {};
  for (Renderer* r : {&without, &with})
    for (uint32_t pass = 0; pass < 64; ++pass) r->trace_reference(pass);
  for (size_t i = 0; i < without.film().unpacked().pixels.size(); ++i) {
    const Pixel &a = without.film().unpacked().pixels[i], &b = with.film().unpacked().pixels[i];
    if (!alike_around(without.film().unpacked(), with.film().unpacked(), i)) continue;
    sum[0] += luminance(a.diffuse_direct) * a.share();
    sum[1] += luminance(b.diffuse_direct) * b.share();
  }
  CHECK(sum[1] == approx(sum[0]).epsilon(0.005));
  CHECK(sum[0] > 0);
}

TEST_CASE(
    "what light groups and the rest bring is the picture, and each is what its lamp brings alone") {
  const auto fill = [](Renderer& renderer, int groups, std::vector<float> strengths) {
    Material grey;
    grey.front.albedo = grey.back.albedo = {0.5f, 0.5f, 0.5f};
    renderer.scene.materials = {grey};
    renderer.scene.meshes.push_back(padded(make_cube()));
    renderer.scene.add_instance(0, {2, 0, 0, -1, 0, 2, 0, -1, 0, 0, 2, 0}, {0});
    renderer.scene.light_groups = groups;
    for (size_t i = 0; i < strengths.size(); ++i) {
      LampSettings lamp;
      lamp.to_world = Affine{{1, 0, 0, 0.5f * float(i) - 0.5f, 0, 1, 0, 0.3f, 0, 0, 1, 1.5f}};
      lamp.strength = Rgb{1, 1, 1} * strengths[i];
      lamp.light_group = static_cast<int16_t>(int(i) < groups ? i : kNoLightGroup);
      renderer.lamps.push_back(lamp);
    }
    renderer.camera_settings.to_world = Affine{{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1.9f}};
    renderer.camera_settings.width = renderer.camera_settings.height = size;
    renderer.camera_settings.region_width = renderer.camera_settings.region_height = size;
    renderer.options.photons_per_pass = photons;
    renderer.options.adaptive_radius = renderer.options.adaptive_samples = false;
    renderer.build();
  };
  for (const bool reference : {false, true}) {
    CAPTURE(reference);
    Renderer all(2), plain(2), first(2), second(2);
    fill(all, 2, {10, 20, 5});
    fill(plain, 0, {10, 20, 5});
    fill(first, 0, {10, 0, 0});
    fill(second, 0, {0, 20, 0});
    const Rgb sum = mean_light(all, 8, reference), same = mean_light(plain, 8, reference);
    CHECK(luminance(sum) == approx(luminance(same)).epsilon(1e-5));
    CHECK(plain.film().unpacked().by_group.empty());
    const Film& film = all.film().unpacked();
    Rgb parts[2] = {};
    for (size_t i = 0; i < film.pixels.size(); ++i)
      for (int g = 0; g < 2; ++g)
        parts[g] += film.by_group[2 * i + g] * film.pixels[i].share() / float(film.pixels.size());
    CHECK(luminance(parts[0]) == approx(luminance(mean_light(first, 8, reference))).epsilon(0.03));
    CHECK(luminance(parts[1]) == approx(luminance(mean_light(second, 8, reference))).epsilon(0.03));
    CHECK(luminance(parts[0] + parts[1]) == approx(luminance(sum) * 30 / 35).epsilon(0.05));
  }
  Renderer wrong(1);
  wrong.scene.light_groups = 1;
  wrong.scene.world_light_group = 1;
  CHECK_THROWS_AS(wrong.build(), std::invalid_argument);
}
