#include "integrators/data_passes.h"

#include "bsdf/bsdf.h"
#include "integrators/camera_path.h"

namespace photon_splat {
namespace {

constexpr int kMostLayers = 64;  // transparent ones before a ray is given up
constexpr float kFaint = 1e-4f;  // what is let through of a sample

// Coverage by id, of the samples of one pixel.
class Matte {
 public:
  void add(float id, float coverage) {
    if (!(coverage > 0)) return;
    for (auto& [known, sum] : found_)
      if (known == id) return void(sum += coverage);
    found_.emplace_back(id, coverage);
  }
  void put(float share, uint32_t levels, float* to) {
    std::stable_sort(found_.begin(), found_.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    for (size_t i = 0; i < std::min<size_t>(levels, found_.size()); ++i) {
      to[2 * i] = found_[i].first;
      to[2 * i + 1] = found_[i].second * share;
    }
    found_.clear();
  }

 private:
  std::vector<std::pair<float, float>> found_;
};

// What is gathered for one pixel.
struct Scratch {
  std::array<Matte, 3> mattes;
  std::array<double, 4> vector{};
  uint32_t vectors = 0;  // in that sum
};

struct Looker {
  Scene& scene;
  const Camera& camera;
  const DataLabels& labels;
  const DataSettings& settings;
  DataPasses& out;
  const std::optional<MotionVectors>& motion;

  void look_at_pixel(int x, int y, size_t index, Scratch& scratch) const {
    const PixelRays rays(scene, camera, x, y, settings.seed);
    const float share = 1.0f / static_cast<float>(settings.samples);
    float seen = 0;
    for (uint32_t sample = 0; sample < settings.samples; ++sample) {
      const float time = rays.time(sample);
      if (const auto ray = rays.ray(sample, time))
        seen += follow(*ray, time, index, sample, scratch);
    }
    out.mist[index] = 1 - seen * share;
    for (int i = 0; i < 3; ++i) {
      out.uv[3 * index + i] *= share;
    }
    for (int i = 0; i < 4; ++i) {
      for (auto& values : out.values) values[4 * index + i] *= share;
      if (scratch.vectors)
        out.vector[4 * index + i] = static_cast<float>(scratch.vector[i] / scratch.vectors);
    }
    scratch.vector = {};
    scratch.vectors = 0;
    for (int k = 0; k < 3 && settings.levels; ++k)
      scratch.mattes[k].put(share, settings.levels, &out.mattes[k][2 * settings.levels * index]);
  }

  // Through what lets light pass. Returns how much of it is not lost in mist.
  float follow(const CameraRay& ray, float time, size_t index, uint32_t sample,
               Scratch& scratch) const {
    float left = 1, clear = 0, near = ray.near;
    const Media* const media = scene.media();
    MediumStack around;
    if (media)
      around = media->seen(media->around(ray.origin + ray.direction * near, time),
                           ray_bit(RayInfo::kCamera));
    float unfogged = 1;  // as much as media let pass: what they take is mist, as in Cycles
    Random random(index * settings.samples + sample, settings.seed);
    // Share of the samples that get there with a path of Cycles, which passes a layer or is
    // scattered
    float reach = 1;
    bool solid = false, described = sample > 0;
    std::vector<float> registers;
    RayInfo info;
    info.from = near;
    info.time = time;
    Surface hit;
    for (int layer = 0; layer < kMostLayers && left > kFaint; ++layer) {
      const RayMask kinds = ray_bit(RayInfo::kCamera);
      if (!(layer ? scene.intersect_past(hit, ray.origin, ray.direction, ray.far, true, kinds, time)
                  : scene.intersect(ray.origin, ray.direction, near, ray.far, true, hit, kinds,
                                    time)))
        break;
      if (media)
        media->meet_touched(hit, ray.origin, ray.direction, ray_bit(RayInfo::kCamera), time);
      if (!around.empty())
        unfogged *=
            average(media->transmittance(media->seen(around, ray_bit(RayInfo::kCamera)), ray.origin,
                                         ray.direction, near, hit.distance, info, random));
      const float arrives = reach * unfogged;
      float through = 0, scattered = 1;
      info.length = hit.distance;
      info.footprint = camera.footprint_at(ray, hit.distance);
      if (!solid) add_values(hit, -ray.direction, info, reach, index, registers);
      const bool holdout = scene.instances[hit.instance].holdout;
      bool hole = holdout;
      if (scene.may_be_transparent(hit) || (hit.program && hit.program->holds_out)) {
        Bsdf bsdf(Transport::kRadiance, -ray.direction, hit.ng, hit.ns, hit.back);
        scene.shade(hit, -ray.direction, info, bsdf);
        through = std::clamp(average(bsdf.transparency()), 0.0f, 1.0f);
        scattered = bsdf.scatters() ? average(bsdf.albedo()) : 0;
        reach *= through > 0 ? through / (through + scattered) : 0;
        ++info.transparent_depth;
        hole = bsdf.holdout() >= 1 || (holdout && through == 0);
      }
      if (hole) {  // as if there was nothing, not even the world, as in Cycles
        solid = true;
        break;
      }
      const float stays = left * (1 - through);
      const bool opaque = 1 - through >= settings.alpha_threshold;
      // The first sample's path may end at what lets more through
      if (!described && (opaque || random.next() * (through + scattered) < scattered)) {
        described = true;
        describe(hit, index);
      }
      if (!solid && opaque) {
        solid = true;
        if (motion) add_vector(motion->at(hit), scratch);
        if (!scene.meshes[scene.instances[hit.instance].mesh].uv.empty()) {
          const Vec2 uv = scene.uv_at(hit.instance, hit.triangle, hit.u, hit.v);
          out.uv[3 * index] += uv.x * arrives;
          out.uv[3 * index + 1] += uv.y * arrives;
          out.uv[3 * index + 2] += arrives;
        }
      }
      clear += stays * unfogged * (1 - mist_at(hit.distance));
      if (settings.levels) {
        scratch.mattes[0].add(labels.object_id[hit.instance], stays);
        scratch.mattes[1].add(labels.asset_id[hit.instance], stays);
        scratch.mattes[2].add(labels.material_id[material_of(hit)], stays);
      }
      left -= stays;
      near = past(hit);
      if (media) media->cross(around, hit, gap_at(hit, ray.origin, ray.direction), time);
    }
    if (motion && !solid) add_vector(motion->beyond(ray.direction), scratch);
    return clear;
  }

  void add_values(const Surface& hit, const Vec3& wo, const RayInfo& info, float weight,
                  size_t index, std::vector<float>& registers) const {
    for (size_t k = 0; k < labels.programs.size(); ++k) {
      const int32_t program = labels.programs[k][material_of(hit)];
      if (program < 0) continue;
      const Vec3 value = scene.value_at(scene.programs[program], hit, wo, info, registers) * weight;
      if (!is_finite(value)) continue;
      float* const to = &out.values[k][4 * index];
      to[0] += value.x;
      to[1] += value.y;
      to[2] += value.z;
      to[3] += weight;
    }
  }

  static void add_vector(const std::array<float, 4>& vector, Scratch& scratch) {
    for (const float part : vector)
      if (!std::isfinite(part)) return;
    for (int i = 0; i < 4; ++i) scratch.vector[i] += vector[i];
    ++scratch.vectors;
  }

  void describe(const Surface& hit, size_t index) const {
    for (int i = 0; i < 3; ++i)
      out.position[3 * index + i] = static_cast<float>(hit.position[i] + scene.origin[i]);
    out.object_index[index] = static_cast<float>(labels.object_index[hit.instance]);
    out.material_index[index] = static_cast<float>(labels.material_index[material_of(hit)]);
  }

  size_t material_of(const Surface& hit) const {
    return static_cast<size_t>(&scene.material_of(hit.instance, hit.triangle) -
                               scene.materials.data());
  }

  float mist_at(float distance) const {
    const Mist& m = settings.mist;
    const float share = std::clamp((distance - m.start) / std::max(m.depth, 1e-6f), 0.0f, 1.0f);
    return std::pow(share, m.power);
  }
};

}  // namespace

DataPasses trace_data_passes(Scene& scene, const Camera& camera, const DataLabels& labels,
                             const DataSettings& settings, const CancelFlag& cancel) {
  const size_t instances = scene.instances.size(), materials = scene.materials.size();
  if (labels.object_index.size() != instances || labels.object_id.size() != instances ||
      labels.asset_id.size() != instances || labels.material_index.size() != materials ||
      labels.material_id.size() != materials)
    throw std::invalid_argument("each instance and each material must have its labels");
  for (const auto& programs : labels.programs) {
    if (programs.size() != materials)
      throw std::invalid_argument("each material must say what it gives each pass");
    for (const int32_t program : programs)
      if (program >= static_cast<int32_t>(scene.programs.size()))
        throw std::invalid_argument("a pass asks for a program that is not there");
  }
  if (labels.frames) labels.frames->check(scene);
  if (!settings.samples) throw std::invalid_argument("a pixel has one sample at the least");
  const int width = camera.settings().region_width, height = camera.settings().region_height;
  const size_t pixels = static_cast<size_t>(width) * height;
  DataPasses out;
  for (auto* three : {&out.position, &out.uv}) three->assign(3 * pixels, 0);
  for (auto* one : {&out.object_index, &out.material_index, &out.mist}) one->assign(pixels, 0);
  out.values.assign(labels.programs.size(), std::vector<float>(4 * pixels, 0.0f));
  out.vector.assign(4 * pixels, 0);
  for (auto& matte : out.mattes) matte.assign(2 * settings.levels * pixels, 0);
  std::optional<MotionVectors> motion;
  if (labels.frames) motion.emplace(scene, camera.settings(), *labels.frames);
  const Looker looker{scene, camera, labels, settings, out, motion};
  scene.pool().for_each(static_cast<size_t>(height), cancel, [&](size_t y, int) {
    Scratch scratch;
    for (int x = 0; x < width; ++x)
      looker.look_at_pixel(x, static_cast<int>(y), y * width + x, scratch);
  });
  return out;
}

}  // namespace photon_splat
