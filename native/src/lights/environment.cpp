#include "lights/environment.h"

#include "media/media.h"

namespace photon_splat {
namespace {

constexpr double kUniformShare = 0.02;  // of the table's samples: no direction is ever left out
constexpr int kMostColumns = 2048;

// Real spherical harmonics to the second degree.
void harmonics_at(const Vec3& d, float y[9]) {
  y[0] = 0.282095f;
  y[1] = 0.488603f * d.y;
  y[2] = 0.488603f * d.z;
  y[3] = 0.488603f * d.x;
  y[4] = 1.092548f * d.x * d.y;
  y[5] = 1.092548f * d.y * d.z;
  y[6] = 0.315392f * (3 * d.z * d.z - 1);
  y[7] = 1.092548f * d.x * d.z;
  y[8] = 0.546274f * (d.x * d.x - d.y * d.y);
}

Vec3 direction_at(float polar, float longitude) {
  const float sine = std::sin(polar);
  return {sine * std::cos(longitude), sine * std::sin(longitude), std::cos(polar)};
}

}  // namespace

Environment::Environment(Scene& scene)
    : scene_(scene),
      hidden_(scene.media() && scene.media()->stops_far_light()),
      straight_(scene.world_map.to_lookup.m == Affine{}.m) {
  if (hidden_) {
    measure({Rgb{}}, 1, 1);
    return;
  }
  find_kinds();
  add_discs();
  if (scene_.world_map.texture >= 0 || scene_.world_program >= 0)
    bake();
  else
    measure({scene_.world}, 1, 1);
}

Rgb Environment::map_radiance(const Vec3& d) const {
  if (scene_.world_program >= 0) return most_of_program(d, false);
  const WorldMap& map = scene_.world_map;
  if (map.texture < 0) return scene_.world;
  Vec3 v = d;
  if (!straight_) {
    v = map.to_lookup.vector(d) + map.to_lookup.column(3);
    const float len = length(v);
    if (!(len > 0)) return {};
    v = v / len;
  }
  const Rgb texel = scene_.textures[map.texture].lookup(map.mirror_ball ? mirror_ball_uv(v)
                                                                        : equirectangular_uv(v));
  return max(texel, Vec3{}) * scene_.world;
}

Rgb Environment::most_of_program(const Vec3& d, bool suns) const {
  Rgb most = run(d, kinds_[0], suns);
  for (size_t i = 1; i < kinds_.size(); ++i) most = max(most, run(d, kinds_[i], suns));
  return most;
}

// In a program suns are part of what is mixed: what they add there.
Rgb Environment::suns_of_program(const Vec3& d) const {
  return max(most_of_program(d, true) - most_of_program(d, false), Rgb{});
}

Rgb Environment::run(const Vec3& d, RayInfo ray, bool suns) const {
  ShadingPoint p;
  p.position = d;
  p.ng = p.ns = p.wo = -d;
  p.ray = ray;
  p.suns = suns;
  p.ray.length = std::numeric_limits<float>::max();
  ++p.ray.depth;  // the world is one step further, as in Cycles
  Bsdf bsdf(Transport::kRadiance, p.wo, p.ng, p.ns, false);
  run_program(scene_, scene_.programs[scene_.world_program], p, bsdf);
  return max(bsdf.emission(), Vec3{});
}

Rgb Environment::radiance(const Vec3& d, const RayInfo& ray) const {
  return asks_camera_ ? run(d, ray, true) : radiance(d);
}

Rgb Environment::share(const Vec3& d, const RayInfo& ray) const {
  const Rgb seen = run(d, ray, true), all = radiance(d);
  return {all.x > 0 ? seen.x / all.x : 0, all.y > 0 ? seen.y / all.y : 0,
          all.z > 0 ? seen.z / all.z : 0};
}

RayInfo Environment::photon_ray(bool diffuse, bool transmitted, bool delta) {
  return RayInfo{}.scattered(true, false, false).scattered(diffuse, transmitted, delta);
}

void Environment::find_kinds() {
  if (scene_.world_program < 0) return;
  const Program& program = scene_.programs[scene_.world_program];
  asks_camera_ = program.asks_ray;
  asks_depth_ = program.asks_depth;
  if (!program.asks_kind && !program.asks_depth) {
    kinds_.push_back(photon_ray(true, false, false));
    return;
  }
  const auto add_kinds = [&](const RayInfo& before) {
    for (const bool transmitted : {false, true}) {
      kinds_.push_back(before.scattered(true, transmitted, false));
      kinds_.push_back(before.scattered(false, transmitted, false));
      if (program.asks_singular) kinds_.push_back(before.scattered(false, transmitted, true));
    }
  };
  RayInfo before{};
  if (program.asks_depth) add_kinds(before);
  add_kinds(before = before.scattered(true, false, false));
  if (program.asks_depth) {
    RayInfo passed{};
    passed.transparent_depth = 1;
    add_kinds(passed);
    for (int bounce = 0; bounce < 4; ++bounce) before = before.scattered(true, false, false);
    add_kinds(before);
  }
}

void Environment::add_discs() {
  for (const SunDisc& sun : scene_.sun_discs) {
    Disc disc(sun);
    Rgb sum{};
    constexpr uint32_t kProbes = 1024;
    const Basis basis(disc.towards);
    const auto of_disc = [&](const Vec3& d) {
      return scene_.world_program < 0 ? disc.radiance(d) : suns_of_program(d);
    };
    for (uint32_t i = 0; i < kProbes; ++i)
      sum += of_disc(basis.to_world(sample_cone(sobol_2d(i, 0, 0), disc.one_minus_cos)));
    disc.mean = sum / static_cast<float>(kProbes);
    disc.flux = double(average(disc.mean)) * 2 * kPi * disc.one_minus_cos;
    if (disc.flux > 0 && std::isfinite(disc.flux)) discs_.push_back(disc);
  }
}

Rgb Environment::disc_radiance(const Vec3& d) const {
  Rgb sum{};
  for (const Disc& disc : discs_) {
    if (!disc.contains(d)) continue;
    if (scene_.world_program >= 0) return suns_of_program(d);  // all of them
    sum += disc.radiance(d);
  }
  return sum;
}

// Means over cells equal in longitude and polar angle; the radiance is looked at closely enough to
// see every texel. Between texels it is interpolated: cells half as wide follow the rim of a sun of
// a few texels, and their middle is their mean.
void Environment::bake() {
  int columns = 512, finest = 1024;
  if (scene_.world_program < 0) {
    const Texture& texture = scene_.textures[scene_.world_map.texture];
    columns = std::clamp(2 * texture.width, 64, kMostColumns);
    finest = std::clamp(std::max(texture.width, 2 * texture.height), columns, 16384);
  }
  const int rows = columns / 2;
  const int fine = std::max(scene_.world_program < 0 && finest == columns ? 1 : 2,
                            (finest + columns - 1) / columns);
  std::vector<Rgb> cells(static_cast<size_t>(columns) * rows);
  scene_.pool().for_each(rows, CancelFlag(), [&](size_t row, int) {
    for (int column = 0; column < columns; ++column) {
      Rgb sum{};
      for (int j = 0; j < fine; ++j)
        for (int i = 0; i < fine; ++i) {
          const float polar = (static_cast<float>(row) +
                               (static_cast<float>(j) + 0.5f) / static_cast<float>(fine)) *
                              kPi / static_cast<float>(rows);
          const float longitude = (static_cast<float>(column) +
                                   (static_cast<float>(i) + 0.5f) / static_cast<float>(fine)) *
                                  2 * kPi / static_cast<float>(columns);
          sum += map_radiance(direction_at(polar, longitude));
        }
      cells[row * columns + column] = sum / static_cast<float>(fine * fine);
    }
  });
  measure(cells, columns, rows);
}

// cells: those of the table to be, or one for all directions.
void Environment::measure(const std::vector<Rgb>& cells, int width, int height) {
  double sum[3] = {}, squares = 0, power = 0;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const Rgb& c = cells[static_cast<size_t>(row) * width + column];
      const double omega = DirectionTable::solid_angle(row, width, height),
                   mean = std::isfinite(average(c)) ? average(c) : 0;
      for (int i = 0; i < 3; ++i) sum[i] += std::isfinite(c[i]) ? c[i] * omega : 0;
      squares += mean * mean * omega;
      power += mean * omega;
      float y[9];
      const Vec3 d =
          direction_at((static_cast<float>(row) + 0.5f) * kPi / static_cast<float>(height),
                       (static_cast<float>(column) + 0.5f) * 2 * kPi / static_cast<float>(width));
      harmonics_at(d, y);
      for (int i = 0; i < (cells.size() > 1 ? 9 : 1); ++i)
        harmonics_[i] += static_cast<float>(mean * omega) * y[i];
    }
  double discs = 0;
  Rgb disc_mean{};
  for (const Disc& disc : discs_) {
    discs += disc.flux;
    float y[9];
    harmonics_at(disc.towards, y);
    for (int i = 0; i < 9; ++i) harmonics_[i] += static_cast<float>(disc.flux) * y[i];
    disc_mean += disc.mean * (0.5f * disc.one_minus_cos);
    disc_cdf_.push_back(static_cast<float>(discs));
  }
  mean_ = Rgb{static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])} /
              (4 * kPi) +
          disc_mean;
  if (discs > 0) {
    disc_share_ =
        static_cast<float>(std::clamp(discs / (discs + power), 0.05, power > 0 ? 0.95 : 1.0));
    for (float& c : disc_cdf_) c *= static_cast<float>(disc_share_ / discs);
  }
  // 1: the same from everywhere
  const double even = power > 0 ? power * power / (4 * kPi * squares) : 1;
  contrast_ = static_cast<float>((discs + power * (1 - even)) / std::max(discs + power, 1e-300));
  if (cells.size() == 1 || !(power > 0) || 1 - even < 1e-4) return;  // as good as constant
  std::vector<float> density(cells.size());
  for (size_t i = 0; i < cells.size(); ++i) {
    const double mean = std::isfinite(average(cells[i])) ? average(cells[i]) : 0;
    density[i] = static_cast<float>((1 - kUniformShare) * mean / power + kUniformShare / (4 * kPi));
  }
  table_ = DirectionTable(std::move(density), width, height);
}

Vec3 Environment::sample_discs(const Vec2& u) const {
  const size_t i = std::min<size_t>(
      std::upper_bound(disc_cdf_.begin(), disc_cdf_.end(), u.x) - disc_cdf_.begin(),
      discs_.size() - 1);
  const float low = i ? disc_cdf_[i - 1] : 0, share = std::max(disc_cdf_[i] - low, 1e-30f);
  return Basis(discs_[i].towards)
      .to_world(sample_cone({std::clamp((u.x - low) / share, 0.0f, kBelowOne), u.y},
                            discs_[i].one_minus_cos));
}

Environment::Sample Environment::sample(const Vec2& u) const {
  if (u.x < disc_share_) {
    const Vec3 direction = sample_discs(u);
    return known(direction, density(direction));
  }
  const auto s = table_.sample({std::min((u.x - disc_share_) / (1 - disc_share_), kBelowOne), u.y});
  return known(s.direction, density_in(s.cell, s.direction));
}

Environment::Sample Environment::sample_part(int part, const Vec2& u) const {
  if (part == kDiscs) {
    const Vec3 direction = sample_discs({u.x * disc_share_, u.y});
    return known(direction, density(direction));
  }
  const auto s = table_.sample_patch(part, u);
  return known(s.direction, density_in(s.cell, s.direction));
}

float Environment::disc_density(const Vec3& d) const {
  float sum = 0;
  for (size_t i = 0; i < discs_.size(); ++i)
    if (length2(d - discs_[i].towards) <= 2 * discs_[i].one_minus_cos * (1 + 1e-5f))
      sum += (disc_cdf_[i] - (i ? disc_cdf_[i - 1] : 0.0f)) / (2 * kPi * discs_[i].one_minus_cos);
  return sum;
}

// Ramamoorthi & Hanrahan 2001, "An efficient representation for irradiance environment maps".
float Environment::irradiance(const Vec3& n) const {
  // Integral of the radiance over all directions
  const float whole = harmonics_[0] * 2 * std::sqrt(kPi);
  if (!(length2(n) > 0)) return 0.5f * whole;
  float y[9];
  harmonics_at(n, y);
  float sum = kPi * harmonics_[0] * y[0];
  for (int i = 1; i < 4; ++i) sum += 2 * kPi / 3 * harmonics_[i] * y[i];
  for (int i = 4; i < 9; ++i) sum += kPi / 4 * harmonics_[i] * y[i];
  return std::max(sum, 0.02f * whole);
}

}  // namespace photon_splat
