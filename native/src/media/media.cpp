#include "media/media.h"

#include "shading/ops.h"

namespace photon_splat {
namespace {

constexpr size_t kMostRegions = 32767;
constexpr int kMostCrossings = 1024;      // surfaces that a look upwards goes through
constexpr float kMostCoefficient = 1e8f;  // 1/m: no light gets further than its rounding

// Whether a program computes nothing: closures of constants.
bool is_constant(const Program& program) {
  for (size_t at = 0; at < program.code.size(); at += nodes::kWords[program.code[at]]) {
    switch (static_cast<nodes::Op>(program.code[at])) {
      case nodes::Op::End:
      case nodes::Op::Emission:
      case nodes::Op::Jump:
      case nodes::Op::VolumeAbsorption:
      case nodes::Op::VolumeScatter:
      case nodes::Op::VolumeCoefficients:
      case nodes::Op::PrincipledVolume: break;
      default: return false;
    }
  }
  return true;
}

}  // namespace

std::unique_ptr<Media> Media::of(const Scene& scene, ThreadPool& pool, const CancelFlag& cancel) {
  bool any = scene.world_volume >= 0;
  for (const Material& material : scene.materials) any |= material.volume >= 0;
  if (!any) return nullptr;
  std::unique_ptr<Media> media(new Media(scene));
  if (scene.world_volume >= 0)
    media->world_ = media->add_region(ShadingPoint::kNoInstance, scene.world_volume, pool, cancel);
  media->of_slot_.assign(scene.slot_materials.size(), -1);
  media->clear_slot_.assign(scene.slot_materials.size(), 0);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    for (uint32_t slot = 0; slot < instance.slot_count; ++slot) {
      const size_t at = instance.first_material + slot;
      const Material& material = scene.materials[scene.slot_materials[at]];
      const int volume = material.volume;
      if (volume < 0) continue;
      media->clear_slot_[at] =
          material.program >= 0 && media->is_clear(scene.programs[material.program]);
      int16_t known = -1;  // slots of one object share what they have
      for (uint32_t before = 0; before < slot && known < 0; ++before) {
        const size_t other = instance.first_material + before;
        if (scene.materials[scene.slot_materials[other]].volume == volume)
          known = media->of_slot_[other];
      }
      media->of_slot_[at] =
          known >= 0 ? known : static_cast<int16_t>(media->add_region(i, volume, pool, cancel));
      media->in_meshes_ = true;
    }
  }
  if (media->in_meshes_) media->find_touching(pool, cancel);
  return media;
}

int Media::add_region(uint32_t instance, int program, ThreadPool& pool, const CancelFlag& cancel) {
  if (regions_.size() == kMostRegions)
    throw std::invalid_argument("the scene has more objects with volumes than 32767");
  Region region;
  region.instance = instance;
  region.program = program;
  if (instance != ShadingPoint::kNoInstance) {
    constexpr RayMask all = kScatteredRays | ray_bit(RayInfo::kCamera) | ray_bit(RayInfo::kShadow) |
                            ray_bit(RayInfo::kVolume);
    region.density = scene_.instances[instance].density;
    hides_ |= (scene_.instances[instance].seen_by & all) != all;
  }
  region.homogeneous = is_constant(scene_.programs[program]);
  if (region.homogeneous) {
    region.point = run(region, {}, {0, 0, 1}, {});
    emits_ |= !is_black(region.point.emission);
    scatters_ |= !is_black(region.point.scattering);
  } else {
    emits_ |= (scene_.programs[program].features & kProgramEmits) != 0;
    scatters_ = true;
    bound(region, pool, cancel);
  }
  if (instance != ShadingPoint::kNoInstance) {
    const RayMask seen_by = scene_.instances[instance].seen_by;
    hides_from_shadows_ |= !(seen_by & ray_bit(RayInfo::kShadow)) &&
                           seen_by & (kScatteredRays | ray_bit(RayInfo::kVolume)) &&
                           !(region.homogeneous && is_black(region.point.scattering));
  }
  regions_.push_back(std::move(region));
  return static_cast<int>(regions_.size() - 1);
}

size_t Media::slot_of(uint32_t instance, uint32_t triangle) const {
  const Instance& own = scene_.instances[instance];
  const Mesh& mesh = scene_.meshes[own.mesh];
  const uint32_t slot = mesh.slots.empty() ? 0 : mesh.slots[triangle];
  return own.first_material + std::min(slot, own.slot_count - 1);
}

int Media::region_of(uint32_t instance, uint32_t triangle) const {
  if (scene_.meshes[scene_.instances[instance].mesh].strands) return -1;
  return of_slot_[slot_of(instance, triangle)];
}

// At an edge rays may meet both triangles, in either order, or, by the tolerance that makes Embree
// watertight, one that ends just before it. In doubt a path is not let in, as it might never find
// the way out.
bool Media::goes_through(int region, const Surface& s, const Gap& gap, float time) const {
  Vec3 corner[3];
  scene_.corners(s.instance, s.triangle, time, corner);
  const Vec3 a = corner[1] - corner[0], b = corner[2] - corner[0];
  const float longest = std::max({length(a), length(b), length(b - a)}),
              inside = std::min({s.u, s.v, 1 - s.u - s.v});  // times an altitude: off the edge
  if (inside * length(photon_splat::cross(a, b)) >
      ray_epsilon(s.position, s.distance) * std::max(longest, 1e-20f))
    return true;
  const Crossings crossings =
      scene_.crossings(gap.origin, gap.direction, gap.near, gap.far, kAllRays, time);
  bool continues = false;
  for (const Crossings::Met& met : crossings) {
    if (region_of(met.instance, met.triangle) != region) continue;
    if (met.back != s.back) return false;
    continues |= met.triangle != s.triangle || met.instance != s.instance;
  }
  return s.back || continues || (s.u >= 0 && s.v >= 0 && s.u + s.v < 1);
}

MediumPoint Media::run(const Region& region, const Vec3& x, const Vec3& wo,
                       const RayInfo& ray) const {
  MediumPoint out;
  ShadingPoint point;
  point.position = x;
  point.ng = point.ns = point.wo = wo;
  point.instance = region.instance;
  point.ray = ray;
  point.medium = &out;
  Bsdf emission(Transport::kRadiance, wo, wo, wo, false);
  run_program(scene_, scene_.programs[region.program], point, emission);
  const auto bounded = [](Rgb& c) {
    for (float* v : {&c.x, &c.y, &c.z}) *v = *v > 0 ? std::min(*v, kMostCoefficient) : 0;
  };
  out.emission += max(emission.emission(), Rgb{});
  bounded(out.absorption);
  if (region.density != 1) out.scale(region.density);
  return out;
}

MediumStack Media::around(const Vec3& x, float time) const {
  MediumStack stack, entered;
  if (world_ >= 0) stack.enter(static_cast<uint16_t>(world_));
  if (!in_meshes_) return stack;
  const auto meet = [&](int region, bool back) {
    const uint16_t own = static_cast<uint16_t>(region);
    if (!back)
      entered.enter(own);
    else if (entered.holds(own))
      entered.leave(own);
    else
      stack.enter(own);
  };
  Surface s;
  float near = 0;
  for (int i = 0; i < kMostCrossings &&
                  scene_.intersect(x, {0, 0, 1}, near, INFINITY, false, s, kAllRays, time);
       ++i, near = past(s)) {
    const Gap gap = gap_at(s, x, {0, 0, 1});
    const int region = region_of(s.instance, s.triangle);
    if (region >= 0 && goes_through(region, s, gap, time)) meet(region, s.back);
    if (touching_)
      for (const Touching& other : touching(s, gap, time)) meet(other.region, other.back);
  }
  return stack;
}

MediumStack Media::visible_part(const MediumStack& stack, RayMask kinds) const {
  MediumStack kept;
  for (const uint16_t i : stack) {
    const uint32_t instance = regions_[i].instance;
    if (instance == ShadingPoint::kNoInstance || scene_.instances[instance].seen_by & kinds)
      kept.enter(i);
  }
  return kept;
}

int16_t Media::light_group_of(const MediumStack& stack) const {
  for (const uint16_t i : stack) {
    const Region& region = regions_[i];
    if (region.homogeneous ? is_black(region.point.emission)
                           : !(scene_.programs[region.program].features & kProgramEmits))
      continue;
    return region.instance == ShadingPoint::kNoInstance
               ? scene_.world_light_group
               : scene_.instances[region.instance].light_group;
  }
  return kNoLightGroup;
}

MediumStack Media::of_catchers(const MediumStack& stack) const {
  MediumStack kept;
  for (const uint16_t i : stack) {
    const uint32_t instance = regions_[i].instance;
    if (instance == ShadingPoint::kNoInstance || scene_.instances[instance].catcher) kept.enter(i);
  }
  return kept;
}

MediumPoint Media::at(const MediumStack& stack, const Vec3& x, const Vec3& wo,
                      const RayInfo& ray) const {
  MediumPoint sum;
  for (const uint16_t i : stack) {
    const Region& region = regions_[i];
    sum.add(region.homogeneous ? region.point : run(region, x, wo, ray));
  }
  return sum;
}

std::optional<MediumPoint> Media::homogeneous(const MediumStack& stack) const {
  MediumPoint sum;
  for (const uint16_t i : stack) {
    if (!regions_[i].homogeneous) return std::nullopt;
    sum.add(regions_[i].point);
  }
  return sum;
}

}  // namespace photon_splat
