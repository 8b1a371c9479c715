#include "geometry/strands.h"

#include <stdexcept>

#include "math/sampling.h"

namespace photon_splat {
namespace {

// The far sides of points are not there, and a ray that leaves a strand does not meet it again, as
// in Cycles: what goes through it is its material's business.
void pass(const RTCFilterFunctionNArguments* arguments, bool point) {
  const Strands& strands = *static_cast<const Strands*>(arguments->geometryUserPtr);
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (!arguments->valid[i]) continue;
    RTCRayN* ray = arguments->ray;
    RTCHitN* hit = arguments->hit;
    if (point && RTCRayN_dir_x(ray, n, i) * RTCHitN_Ng_x(hit, n, i) +
                         RTCRayN_dir_y(ray, n, i) * RTCHitN_Ng_y(hit, n, i) +
                         RTCRayN_dir_z(ray, n, i) * RTCHitN_Ng_z(hit, n, i) >
                     0) {
      arguments->valid[i] = 0;
      continue;
    }
    const unsigned left = RTCRayN_id(ray, n, i);
    if (left == 0) continue;
    unsigned instance = RTCHitN_instID(hit, n, i, 0);
    if (instance == RTC_INVALID_GEOMETRY_ID) instance = RTCHitN_geomID(hit, n, i);
    if (left == Strands::mark(instance, strands.strand(RTCHitN_primID(hit, n, i))))
      arguments->valid[i] = 0;
  }
}
void pass_curve(const RTCFilterFunctionNArguments* arguments) { pass(arguments, false); }
void pass_point(const RTCFilterFunctionNArguments* arguments) { pass(arguments, true); }

RTCGeometryType type_of(StrandShape shape) {
  switch (shape) {
    case StrandShape::kRibbon: return RTC_GEOMETRY_TYPE_FLAT_CATMULL_ROM_CURVE;
    case StrandShape::kThick: return RTC_GEOMETRY_TYPE_ROUND_CATMULL_ROM_CURVE;
    case StrandShape::kThickLinear: return RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE;
    case StrandShape::kPoint: break;
  }
  return RTC_GEOMETRY_TYPE_SPHERE_POINT;
}

StrandKey between(const StrandKey& a, const StrandKey& b, float share) {
  return {a.position * (1 - share) + b.position * share, a.radius * (1 - share) + b.radius * share};
}

}  // namespace

uint32_t Strands::mark(uint32_t instance, uint32_t strand) {
  return hash_combine(hash32(instance + 1), strand) | 1u;  // 0: none
}

Strands::Strands(StrandShape shape, uint32_t subdivisions, std::span<const StrandKey> keys,
                 std::vector<uint32_t> first)
    : shape_(shape),
      subdivisions_(subdivisions),
      key_count_(static_cast<uint32_t>(keys.size())),
      first_(std::move(first)) {
  if (keys.size() >= (1u << 30))
    throw std::invalid_argument("strands have more keys than the renderer can hold");
  for (const StrandKey& key : keys)
    if (!is_finite(key.position) || !(key.radius >= 0) || !std::isfinite(key.radius))
      throw std::invalid_argument("strands have a key that is not finite, or a radius below 0");
  if (!are_curves()) {
    if (!first_.empty()) throw std::invalid_argument("points are no curves");
    segments_ = key_count_;
  } else {
    if (first_.size() < 2 || first_.front() != 0 || first_.back() != key_count_)
      throw std::invalid_argument("curves do not fit their keys");
    curves_ = static_cast<uint32_t>(first_.size() - 1);
    for (uint32_t c = 0; c < curves_; ++c)
      if (first_[c + 1] < first_[c] + 2 || first_[c + 1] > key_count_)
        throw std::invalid_argument("a curve has fewer than two keys");
    segments_ = key_count_ - curves_;
    index_.resize(segments_);
    for (uint32_t c = 0; c < curves_; ++c)
      for (uint32_t k = first_[c]; k + 1 < first_[c + 1]; ++k) index_[k - c] = k + c * ends();
  }
  fill(keys, keys_);
}

void Strands::fill(std::span<const StrandKey> keys, LargeArray<StrandKey>& out) const {
  out.resize(keys.size() + size_t{ends()} * curves_);
  if (!ends()) {
    std::copy(keys.begin(), keys.end(), out.begin());
    return;
  }
  for (uint32_t c = 0; c < curves_; ++c) {
    const uint32_t begin = first_[c], end = first_[c + 1];
    for (uint32_t k = begin; k < end; ++k) out[place(k, c)] = keys[k];
    out[place(begin, c) - 1] = keys[begin];
    out[place(end, c)] = keys[end - 1];
  }
}

void Strands::set_motion(std::span<const StrandKey> steps, size_t count) {
  if (count < 3 || count % 2 == 0 || steps.size() != count * key_count_)
    throw std::invalid_argument("steps of strands do not fit their keys");
  for (const StrandKey& key : steps)
    if (!is_finite(key.position) || !(key.radius >= 0) || !std::isfinite(key.radius))
      throw std::invalid_argument("strands have a key that is not finite, or a radius below 0");
  moving_.resize(count);
  for (size_t i = 0; i < count; ++i)
    if (i != count / 2) fill(steps.subspan(i * key_count_, key_count_), moving_[i]);
}

const LargeArray<StrandKey>& Strands::step(size_t i) const {
  return i == moving_.size() / 2 ? keys_ : moving_[i];
}

StrandKey Strands::at(size_t place, float time) const {
  if (!moves()) return keys_[place];
  const auto [first, share] = motion_step(moving_.size(), time);
  return between(step(first)[place], step(first + 1)[place], share);
}

StrandKey Strands::key(uint32_t number, float time) const {
  if (!ends()) return at(number, time);
  const auto after = std::upper_bound(first_.begin(), first_.end(), number);
  return at(place(number, static_cast<uint32_t>(after - first_.begin() - 1)), time);
}

Vec3 Strands::tangent(uint32_t segment, float u, float time) const {
  if (!are_curves()) return {};
  const uint32_t first = index_[segment];
  if (!ends()) return at(first + 1, time).position - at(first, time).position;
  const Vec3 p0 = at(first, time).position, p1 = at(first + 1, time).position,
             p2 = at(first + 2, time).position, p3 = at(first + 3, time).position;
  // of a Catmull-Rom spline
  const Vec3 along = p0 * (-0.5f + u * (2 - 1.5f * u)) + p1 * (u * (4.5f * u - 5)) +
                     p2 * (0.5f + u * (4 - 4.5f * u)) + p3 * (u * (1.5f * u - 1));
  return length2(along) > 0 ? along : p2 - p1;
}

float Strands::radius(uint32_t segment, float u, float time) const {
  if (!are_curves()) return at(segment, time).radius;
  const size_t first = index_[segment] + (ends() ? 1 : 0);
  return between(at(first, time), at(first + 1, time), u).radius;
}

float Strands::length(uint32_t curve) const {
  float sum = 0;
  for (uint32_t k = first_[curve]; k + 1 < first_[curve + 1]; ++k)
    sum +=
        photon_splat::length(keys_[place(k + 1, curve)].position - keys_[place(k, curve)].position);
  return sum / scale_;
}

float Strands::length_to(uint32_t segment, float u) const {
  const uint32_t curve = strand(segment), last = first_key(segment);
  float sum = 0;
  for (uint32_t k = first_[curve]; k <= last; ++k) {
    const float step =
        photon_splat::length(keys_[place(k + 1, curve)].position - keys_[place(k, curve)].position);
    sum += k < last ? step : u * step;
  }
  return sum / scale_;
}

void Strands::transform(const std::array<double, 12>& m, float scale) {
  const auto change = [&](LargeArray<StrandKey>& keys) {
    for (StrandKey& key : keys) {
      const Vec3 p = key.position;
      const auto row = [&](int r) {
        return static_cast<float>(m[4 * r] * p.x + m[4 * r + 1] * p.y + m[4 * r + 2] * p.z +
                                  m[4 * r + 3]);
      };
      key = {{row(0), row(1), row(2)}, key.radius * scale};
    }
  };
  change(keys_);
  for (LargeArray<StrandKey>& keys : moving_) change(keys);
  scale_ *= scale;
}

Bounds Strands::bounds() const {
  Bounds all;
  const auto add = [&](const LargeArray<StrandKey>& keys) {
    for (const StrandKey& key : keys) {
      const Vec3 margin = Vec3{1, 1, 1} * key.radius;
      all.add(key.position - margin);
      all.add(key.position + margin);
    }
  };
  add(keys_);
  for (const LargeArray<StrandKey>& keys : moving_) add(keys);
  return all;
}

size_t Strands::memory() const {
  size_t keys = keys_.size();
  for (const LargeArray<StrandKey>& step : moving_) keys += step.size();
  return keys * sizeof(StrandKey) + (first_.size() + index_.size()) * sizeof(uint32_t);
}

RTCGeometry Strands::make_geometry(RTCDevice device) const {
  RTCGeometry geometry = rtcNewGeometry(device, type_of(shape_));
  const unsigned steps = moves() ? static_cast<unsigned>(moving_.size()) : 1;
  if (steps > 1) rtcSetGeometryTimeStepCount(geometry, steps);
  for (unsigned i = 0; i < steps; ++i) {
    const LargeArray<StrandKey>& keys = moves() ? step(i) : keys_;
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, i, RTC_FORMAT_FLOAT4, keys.data(),
                               0, sizeof(StrandKey), keys.size());
  }
  if (are_curves()) {
    rtcSetGeometryTessellationRate(geometry, static_cast<float>(subdivisions_ + 1));
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, index_.data(),
                               0, sizeof(uint32_t), index_.size());
  }
  rtcSetGeometryUserData(geometry, const_cast<Strands*>(this));
  const auto filter = are_curves() ? pass_curve : pass_point;
  rtcSetGeometryIntersectFilterFunction(geometry, filter);
  rtcSetGeometryOccludedFilterFunction(geometry, filter);
  rtcCommitGeometry(geometry);
  return geometry;
}

}  // namespace photon_splat
