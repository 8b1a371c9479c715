#include "media/beam_tree.h"

#include "media/media.h"

namespace photon_splat {
namespace {

constexpr size_t kFewBeams = 48;  // of the pilot in a cell that is not divided
constexpr int kDeepest = 20;
constexpr float kFinestCell = 4, kFinestRadius = 0.5f;  // in footprints
constexpr size_t kMostCells = 1 << 20;
constexpr size_t kKnown = 8;         // beams that tell a density
constexpr float kWidest = 0.5f;      // radius, in edges of a cell
constexpr float kUnknown = 0.25f;    // density where fewer are, of that around it
constexpr float kFaint = 0.01f;      // beams of which less is left end by chance
constexpr float kLeastSine = 1e-4f;  // between a ray and a beam, else they are parallel
constexpr size_t kBeamsAtOnce = 1024;

Vec3 end_of(const PhotonBeam& beam, float reach) {
  return beam.origin + beam.direction * std::min(beam.length, 4 * reach);
}

}  // namespace

BeamTree::Box BeamTree::Box::child(int i) const {
  const float half = 0.5f * edge;
  return {lower + Vec3{i & 1 ? half : 0, i & 2 ? half : 0, i & 4 ? half : 0}, half};
}

void BeamTree::clear() {
  cells_.clear();
  pieces_.clear();
  lines_.clear();
  refs_.clear();
  stacks_.clear();
}

void BeamTree::learn(std::span<const PhotonBeam> pilot, const Settings& settings) {
  clear();
  settings_ = settings;
  const float reach = settings.reach;
  root_ = {settings.middle - Vec3{reach, reach, reach}, 2 * reach};
  std::vector<uint32_t> ids(pilot.size());
  for (uint32_t i = 0; i < ids.size(); ++i) ids[i] = i;
  cells_.emplace_back();
  grow(0, root_, 0, 0, ids, pilot);
}

void BeamTree::grow(uint32_t cell, const Box& box, int depth, double parent_density,
                    std::vector<uint32_t>& ids, std::span<const PhotonBeam> pilot) {
  const Vec3 upper = box.lower + Vec3{box.edge, box.edge, box.edge};
  double way = 0, sent = 0;  // of all beams in the cell, and what they send out on it
  size_t kept = 0;
  for (const uint32_t id : ids) {
    const PhotonBeam& beam = pilot[id];
    const beams::Range in = beams::within(beam.origin, beams::inverse(beam.direction), box.lower,
                                          upper, 0, beam.length);
    if (!(in.far > in.near)) continue;
    const double own_way = double(in.far - in.near);
    way += own_way;
    if (settings_.variance > 0) sent += own_way * settings_.strength(beam);
    ids[kept++] = id;
  }
  ids.resize(kept);
  const double own = way / (double(box.edge) * double(box.edge) * double(box.edge));
  const double density = kept >= kKnown ? own : std::max(own, double(kUnknown) * parent_density);
  const float half = 0.5f * box.edge,
              footprint = settings_.footprint(box.lower + Vec3{half, half, half});
  if (kept > kFewBeams && depth < kDeepest && cells_.size() + 8 <= kMostCells &&
      half >= kFinestCell * footprint) {
    const int32_t first = static_cast<int32_t>(cells_.size());
    cells_[cell].first_child = first;
    cells_.resize(cells_.size() + 8);
    float largest = 0;
    for (int i = 0; i < 8; ++i) {
      std::vector<uint32_t> below = ids;
      grow(static_cast<uint32_t>(first + i), box.child(i), depth + 1, density, below, pilot);
      largest = std::max(largest, cells_[first + i].radius);
    }
    cells_[cell].radius = largest;
    return;
  }
  // A ray that goes through sees about that much, and looks at so many tell it within as much
  const double light = sent / (double(box.edge) * double(box.edge));
  cells_[cell].looks = settings_.looks;
  if (settings_.variance > 0)
    cells_[cell].looks = static_cast<uint32_t>(
        std::clamp<double>(light * light / settings_.variance, 1, settings_.looks));
  const double area = settings_.beams_per_disc / (density * settings_.more_beams);
  const float radius = static_cast<float>(std::sqrt(area / double(kPi)));
  cells_[cell].radius =  // infinite where there is nothing
      std::min(std::max(radius, kFinestRadius * footprint), kWidest * box.edge);
}

BeamTree::StackKey BeamTree::key_of(const MediumStack& stack) {
  StackKey key{};
  size_t n = 0;
  for (const uint16_t region : stack) key[n++] = static_cast<uint16_t>(region + 1);
  std::sort(key.begin(), key.begin() + n);
  return key;
}

int BeamTree::stack_of(const MediumStack& stack) const {
  const auto it = stacks_.find(key_of(stack));
  return it == stacks_.end() ? -1 : it->second;
}

// Pieces on which the beam fades by one law each. What is faint of it is broken off by chance: the
// rest of it is as strong as there.
void BeamTree::split(const PhotonBeam& beam, uint16_t stack, const Media& media, Random& random,
                     std::vector<BeamPiece>& out) const {
  const float far = std::min(beam.length, length(end_of(beam, settings_.reach) - beam.origin));
  RayInfo ray;
  ray.kind = RayInfo::kShadow;
  ray.time = beam.time;
  const Fading fading = media.fading(beam.media, beam.origin, beam.direction, 0, far, ray, random);
  const float least = std::min({fading.extinction.x, fading.extinction.y, fading.extinction.z});
  const float faint = least > 0 ? -std::log(kFaint) / least : INFINITY;
  const float end = far > faint ? faint - std::log(1 - random.next()) / least : INFINITY;
  for (size_t i = 0; i < fading.steps.size(); ++i) {
    const float from = fading.steps[i].from,
                to = std::min(i + 1 < fading.steps.size() ? fading.steps[i + 1].from : far, end);
    const Rgb power = beam.power * fading.steps[i].left;
    if (!(max_abs(power) > 0)) break;
    const auto add = [&](float a, float b, const Rgb& own, const Rgb& extinction) {
      if (!(b > a)) return;
      out.push_back({beam.origin, beam.direction, a, b, own, extinction,
                     a <= 0 ? beam.begin : BeamPiece::kGoesOn,
                     b >= beam.length ? beam.end : BeamPiece::kGoesOn, stack, beam.light_group});
    };
    add(from, std::min(to, faint), power, fading.extinction);
    if (to > faint)
      add(std::max(from, faint), to, power * kFaint, fading.extinction - Rgb{least, least, least});
  }
}

void BeamTree::find_cells(uint32_t cell, const Box& box, const BeamPiece& piece,
                          const Vec3& inverse, uint32_t id,
                          std::vector<std::pair<uint32_t, uint32_t>>& out) const {
  const Cell& own = cells_[cell];
  if (own.first_child < 0) {
    out.emplace_back(cell, id);
    return;
  }
  // Its eight children share the planes between them
  const float r = own.radius * factor_, half = 0.5f * box.edge;
  const auto slab = [&](float from, float to) {
    const Vec3 s = (box.lower + Vec3{from, from, from} - piece.origin) * inverse,
               t = (box.lower + Vec3{to, to, to} - piece.origin) * inverse;
    return std::pair(min(s, t), max(s, t));
  };
  const auto low = slab(-r, half + r), high = slab(half - r, box.edge + r);
  for (int i = 0; i < 8; ++i) {
    const auto &x = i & 1 ? high : low, &y = i & 2 ? high : low, &z = i & 4 ? high : low;
    const float near = std::max({piece.near - r, x.first.x, y.first.y, z.first.z}),
                far = std::min({piece.far + r, x.second.x, y.second.y, z.second.z});
    if (near <= far)
      find_cells(static_cast<uint32_t>(own.first_child + i), box.child(i), piece, inverse, id, out);
  }
}

void BeamTree::fill(std::span<const PhotonBeam> beams, const Media& media, uint64_t seed,
                    float factor, ThreadPool& pool, const CancelFlag& cancel) {
  factor_ = factor;
  pieces_.clear();
  refs_.clear();
  stacks_.clear();
  std::vector<uint16_t> stacks(beams.size());
  for (size_t i = 0; i < beams.size(); ++i)
    stacks[i] = stacks_.emplace(key_of(beams[i].media), static_cast<uint16_t>(stacks_.size()))
                    .first->second;
  const size_t parts = (beams.size() + kBeamsAtOnce - 1) / kBeamsAtOnce;
  struct Part {
    std::vector<BeamPiece> pieces;
    std::vector<std::pair<uint32_t, uint32_t>> refs;
  };
  std::vector<Part> found(parts);
  pool.for_each(parts, cancel, [&](size_t p, int) {
    Part& part = found[p];
    for (size_t i = p * kBeamsAtOnce; i < std::min(beams.size(), (p + 1) * kBeamsAtOnce); ++i) {
      Random random(i, static_cast<uint32_t>(hash64(seed)));
      split(beams[i], stacks[i], media, random, part.pieces);
    }
    for (uint32_t i = 0; i < part.pieces.size(); ++i)
      find_cells(0, root_, part.pieces[i], beams::inverse(part.pieces[i].direction), i, part.refs);
  });
  for (Cell& cell : cells_) cell.first = cell.count = 0;
  size_t all = 0;
  for (const Part& part : found) {
    all += part.refs.size();
    for (const auto& [cell, id] : part.refs) ++cells_[cell].count;
  }
  struct Next {  // place of a cell's next beam: a row has one of each group
    uint32_t steps, each, longer, at, i = 0, row = 0;
  };
  std::vector<Next> next;
  next.reserve(cells_.size());
  uint32_t sum = 0;
  for (Cell& cell : cells_) {
    cell.first = sum;
    sum += cell.count;
    const uint32_t of = steps(cell);
    next.push_back({of, cell.count / of, cell.count % of, cell.first});
  }
  refs_.resize(all);
  for (Part& part : found) {
    const uint32_t before = static_cast<uint32_t>(pieces_.size());
    for (const auto& [cell, id] : part.refs) {
      Next& to = next[cell];
      refs_[to.at] = before + id;
      to.at += to.each + (to.i < to.longer);
      if (++to.i < to.steps) continue;
      to.i = 0;
      to.at = cells_[cell].first + ++to.row;
    }
    pieces_.insert(pieces_.end(), part.pieces.begin(), part.pieces.end());
    part = {};
  }
  lines_.resize(pieces_.size());
  pool.for_parts(pieces_.size(), 1 << 12, cancel, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const BeamPiece& piece = pieces_[i];
      lines_[i] = {piece.direction,
                   photon_splat::cross(piece.origin - settings_.middle, piece.direction),
                   piece.stack};
    }
  });
}

// A beam ends where surfaces cut it. What counts is on which side of them the ray's point lies: the
// beam stands for others beside it, which are cut elsewhere.
bool BeamTree::cross(const Vec3& origin, const Vec3& direction, const BeamPiece& piece,
                     float radius, float* distance, float* along, float* between,
                     float* sine) const {
  const Vec3 apart = piece.origin - origin,
             across = photon_splat::cross(direction, piece.direction);
  const float s2 = length2(across), d = dot(apart, across);
  if (!(d * d < radius * radius * s2) || !(s2 > kLeastSine * kLeastSine)) return false;
  const float t = dot(photon_splat::cross(apart, piece.direction), across) / s2,
              b = dot(photon_splat::cross(apart, direction), across) / s2;
  if (!(b >= piece.near - radius && b <= piece.far + radius)) return false;
  const Vec3 x = direction * t - apart;                 // from the beam's origin
  const auto beyond = [&](uint16_t normal, float at) {  // the way past a surface there
    const Vec3 n = decode_direction(normal);
    const float way = dot(x - piece.direction * at, n);
    return dot(n, piece.direction) < 0 ? -way : way;
  };
  if (piece.begin == BeamPiece::kGoesOn ? b < piece.near : beyond(piece.begin, piece.near) < 0)
    return false;
  if (piece.end == BeamPiece::kGoesOn ? b >= piece.far : beyond(piece.end, piece.far) > 0)
    return false;
  *distance = t;
  *along = std::clamp(b, piece.near, piece.far);
  *sine = std::sqrt(s2);
  *between = d / *sine;
  return true;
}

}  // namespace photon_splat
