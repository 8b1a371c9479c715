#include "support/bsdf_cases.h"

#include <cstdio>

namespace photon_splat {

namespace {

std::string two_digits(float x) {
  char text[16];
  std::snprintf(text, sizeof text, " %.2f", double(x));
  return text;
}

}  // namespace

std::vector<BsdfCase> bsdf_cases() {
  using D = Distribution;
  std::vector<BsdfCase> cases;
  const auto add = [&](std::string name, std::function<void(Bsdf&)> fill, bool reciprocal,
                       double furnace = -1) {
    cases.push_back({std::move(name), std::move(fill), reciprocal, furnace});
  };
  add("lambert", [](Bsdf& b) { b.add_diffuse({1, 0.5f, 0.25f}, kUp, 0); }, true);
  add("white lambert", [](Bsdf& b) { b.add_diffuse(kWhite, kUp, 0); }, true, 1);
  for (float r : {0.2f, 0.6f, 1.0f}) {
    const std::string at = two_digits(r);
    add("white oren-nayar" + at, [=](Bsdf& b) { b.add_diffuse(kWhite, kUp, r); }, true, 1);
    add(
        "coloured oren-nayar" + at, [=](Bsdf& b) { b.add_diffuse({0.9f, 0.5f, 0.1f}, kUp, r); },
        true);
    add("sheen" + at, [=](Bsdf& b) { b.add_sheen(kWhite, kUp, r, false); }, false);
    add("velvet" + at, [=](Bsdf& b) { b.add_sheen(kWhite, kUp, r, true); }, true);
  }
  add("translucent", [](Bsdf& b) { b.add_translucent(kGrey, kUp); }, true, 0.8);
  for (float r : {0.25f, 0.5f, 1.0f}) {
    const std::string at = two_digits(r);
    add("ggx" + at, [=](Bsdf& b) { b.add_glossy(kWhite, kUp, D::kGgx, r, 0, 0, {}); }, true);
    add(
        "multi-ggx" + at, [=](Bsdf& b) { b.add_glossy(kWhite, kUp, D::kMultiGgx, r, 0, 0, {}); },
        false, 1);
    add(
        "beckmann" + at, [=](Bsdf& b) { b.add_glossy(kWhite, kUp, D::kBeckmann, r, 0, 0, {}); },
        true);
    add(
        "ashikhmin-shirley" + at,
        [=](Bsdf& b) { b.add_glossy(kWhite, kUp, D::kAshikhminShirley, r, 0, 0, {}); }, true);
    add(
        "anisotropic ashikhmin-shirley" + at,
        [=](Bsdf& b) { b.add_glossy(kGrey, kUp, D::kAshikhminShirley, r, 0.5f, 0.1f, {1, 0, 0}); },
        true);
    add(
        "anisotropic" + at,
        [=](Bsdf& b) { b.add_glossy(kGrey, kUp, D::kGgx, r, 0.6f, 0.15f, {1, 0, 0}); }, true);
    add(
        "anisotropic across" + at,
        [=](Bsdf& b) { b.add_glossy(kGrey, kUp, D::kMultiGgx, r, -0.4f, 0, {0, 1, 0}); }, false);
    add(
        "glass" + at, [=](Bsdf& b) { b.add_glass(kWhite, kUp, D::kGgx, r, 1.5f, 0, 1.33f); },
        false);
    add(
        "white glass" + at,
        [=](Bsdf& b) { b.add_glass(kWhite, kUp, D::kMultiGgx, r, 1.5f, 0, 1.33f); }, false, 1);
    add(
        "beckmann glass" + at,
        [=](Bsdf& b) { b.add_glass({0.9f, 0.7f, 0.5f}, kUp, D::kBeckmann, r, 1.3f, 0, 1.33f); },
        false);
    add(
        "thin glass" + at, [=](Bsdf& b) { b.add_glass(kWhite, kUp, D::kGgx, r, 1.5f, 420, 1.8f); },
        false);
    add(
        "inside out glass" + at,
        [=](Bsdf& b) { b.add_glass(kWhite, kUp, D::kMultiGgx, r, 0.7f, 0, 1.33f); }, false);
    add(
        "refraction" + at, [=](Bsdf& b) { b.add_refraction(kWhite, kUp, D::kGgx, r, 1.5f); },
        false);
    add(
        "gold" + at,
        [=](Bsdf& b) {
          b.add_metallic(kWhite, kUp, D::kMultiGgx, r, 0, 0, {}, false, {1, 0.8f, 0.3f},
                         {1, 1, 0.9f}, 0, 1.33f);
        },
        false);
    add(
        "copper" + at,
        [=](Bsdf& b) {
          b.add_metallic(kWhite, kUp, D::kGgx, r, 0.3f, 0, {1, 0, 0}, true, {0.24f, 0.92f, 1.1f},
                         {3.6f, 2.6f, 2.6f}, 0, 1.33f);
        },
        true);
    add(
        "plastic" + at,
        [=](Bsdf& b) {
          b.add_principled(kWhite, principled_inputs([=](auto& in) { in.roughness = r; }));
        },
        false);
    add(
        "everything" + at,
        [=](Bsdf& b) {
          b.add_principled(kWhite, principled_inputs([=](auto& in) {
                             in.roughness = r, in.metallic = 0.3f, in.transmission_weight = 0.4f,
                             in.coat_weight = 0.5f, in.coat_tint = {0.9f, 0.5f, 0.3f};
                             in.sheen_weight = 0.5f, in.anisotropic = 0.5f,
                             in.diffuse_roughness = 0.5f, in.alpha = 0.9f, in.coat_roughness = 0.2f;
                           }));
        },
        false);
    add(
        "pane" + at,
        [=](Bsdf& b) {
          b.add_principled(kWhite, principled_inputs([=](auto& in) {
                             in.roughness = r, in.transmission_weight = 1, in.thin_wall = true;
                             in.base_color = {0.9f, 0.6f, 0.3f}, in.specular_tint = kWhite;
                           }));
        },
        false);
    add(
        "white pane" + at,
        [=](Bsdf& b) {
          b.add_principled(kWhite, principled_inputs([=](auto& in) {
                             in.roughness = r, in.transmission_weight = 1, in.thin_wall = true;
                             in.base_color = in.specular_tint = kWhite;
                           }));
        },
        false, 1);
    add(
        "wall with a film" + at,
        [=](Bsdf& b) {
          b.add_principled(kWhite, principled_inputs([=](auto& in) {
                             in.roughness = r, in.transmission_weight = 0.6f, in.thin_wall = true;
                             in.thin_film_thickness = 400, in.subsurface_weight = 0.5f;
                             in.subsurface.anisotropy = 0.4f;
                           }));
        },
        false);
    add(
        "white metal" + at,
        [=](Bsdf& b) {
          b.add_principled(kWhite, principled_inputs([=](auto& in) {
                             in.roughness = r, in.metallic = 1, in.base_color = kWhite;
                           }));
        },
        false, 1);
  }
  add("toon", [](Bsdf& b) { b.add_toon(kGrey, kUp, false, 0.5f, 0.2f); }, false);
  add("glossy toon", [](Bsdf& b) { b.add_toon(kGrey, kUp, true, 0.3f, 0.1f); }, false);
  add(
      "mixture",
      [](Bsdf& b) {
        b.add_diffuse({0.3f, 0.2f, 0.1f}, kUp, 0);
        b.add_glossy({0.2f, 0.2f, 0.2f}, kUp, D::kGgx, 0.4f, 0, 0, {});
        b.add_translucent({0.1f, 0.3f, 0.1f}, kUp);
        b.add_transparent({0.1f, 0.1f, 0.1f});
      },
      true);
  return cases;
}

}  // namespace photon_splat
