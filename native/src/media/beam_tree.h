// Beams of light in media, found along camera rays. Each ray sees those that pass it closer than a
// radius, blurred in the one direction that is across both: the kernel is one-dimensional ("beam x
// beam, 1D blur" of Jarosz et al. 2011; Progressive Photon Beams, 2011). Nothing here knows a
// camera.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <vector>

#include "photons/photon_beam.h"
#include "util/large_pages.h"
#include "util/parallel.h"

namespace photon_splat {

class Media;

// Part of a beam on which light fades by one law: power * e^(-extinction t).
struct alignas(64) BeamPiece {
  Vec3 origin, direction;  // of the beam
  float near = 0, far = 0;
  Rgb power;
  Rgb extinction;       // 1/m
  uint16_t begin, end;  // normals of the surfaces where it begins and ends, encoded
  uint16_t stack;       // of media, as BeamTree::stack_of() says
  int16_t light_group;

  // Where the beam goes on as another piece, or begins within a medium: no such surface
  static constexpr uint16_t kGoesOn = PhotonBeam::kInside;
};

// Where a ray meets a beam.
struct BeamCrossing {
  const BeamPiece& piece;
  float distance;  // along the ray
  float along;     // along the beam
  // Kernel over the sine between the two, 1/m; likewise of one of 1/sqrt(2) the radius
  float kernel, narrow_kernel;
  // From the ray's point to the beam's, in radii
  Vec3 apart;
  float radius;  // m
};

// An octree, finer where more beams of a pilot pass, whose cells have the radius that their density
// asks for.
class BeamTree {
 public:
  struct Settings {
    Vec3 middle;
    float reach = 1;            // half an edge of the whole, m
    double beams_per_disc = 1;  // wanted from one pass through a disc of the radius
    double more_beams = 1;      // of a pass than of the pilot
    uint32_t looks = 16;        // about so many beams a ray looks at in a cell, at the most
    // Fewer where those are enough for this variance of the light that it sees there, (W/m^2/sr)^2
    double variance = 0;
    // What a metre of a beam sends out into directions, root mean square of all, W/(m sr)
    std::function<double(const PhotonBeam&)> strength;
    // Width of what is seen as one at a place, m: cells and radii are no finer
    std::function<float(const Vec3&)> footprint;
  };
  // Forgets what there was. The pilot's beams choose cells and radii.
  void learn(std::span<const PhotonBeam> pilot, const Settings& settings);
  bool learnt() const { return !cells_.empty(); }

  // The beams of a pass, with all radii times `factor`, instead of those before.
  void fill(std::span<const PhotonBeam> beams, const Media& media, uint64_t seed, float factor,
            ThreadPool& pool, const CancelFlag& cancel);
  void clear();

  size_t cell_count() const { return cells_.size(); }
  std::span<const BeamPiece> pieces() const { return pieces_; }
  // Number of a stack of media, whatever its order; -1: no beam is in such a one.
  int stack_of(const MediumStack& stack) const;

  // Calls see(const BeamCrossing&) for what a ray in these media meets, or for some of it with
  // kernels that stand for the rest.
  template <class See>
  void each(int stack, const Vec3& origin, const Vec3& direction, float near, float far,
            Random& random, See&& see) const;

 private:
  struct Cell {
    int32_t first_child = -1;  // of eight in a row
    float radius = 0;          // of those below the largest
    uint32_t looks = 1;
    uint32_t first = 0, count = 0;  // of refs_
  };
  // A ray looks at one in so many beams of a cell: at those of a group, which lie side by side.
  uint32_t steps(const Cell& cell) const { return std::max(1u, cell.count / cell.looks); }
  static std::pair<uint32_t, uint32_t> group(const Cell& cell, uint32_t steps, uint32_t i) {
    const uint32_t each = cell.count / steps, longer = cell.count % steps,
                   first = cell.first + i * each + std::min(i, longer);
    return {first, first + each + (i < longer)};
  }
  struct Box {
    Vec3 lower;
    float edge;
    Box child(int i) const;
  };
  // A beam's line in Plücker's coordinates about the middle, for a first look at it.
  struct alignas(32) Line {
    Vec3 direction, moment;
    int stack;
  };
  static constexpr uint32_t kFetched = 16;
  using StackKey = std::array<uint16_t, MediumStack::kMost + 1>;
  static StackKey key_of(const MediumStack& stack);
  void grow(uint32_t cell, const Box& box, int depth, double parent_density,
            std::vector<uint32_t>& ids, std::span<const PhotonBeam> pilot);
  void split(const PhotonBeam& beam, uint16_t stack, const Media& media, Random& random,
             std::vector<BeamPiece>& out) const;
  void find_cells(uint32_t cell, const Box& box, const BeamPiece& piece, const Vec3& inverse,
                  uint32_t id, std::vector<std::pair<uint32_t, uint32_t>>& out) const;
  bool cross(const Vec3& origin, const Vec3& direction, const BeamPiece& piece, float radius,
             float* distance, float* along, float* between, float* sine) const;

  Settings settings_;
  Box root_{{}, 1};
  std::vector<Cell> cells_;
  float factor_ = 1;
  std::vector<BeamPiece> pieces_;
  std::vector<Line> lines_;     // of the pieces
  std::vector<uint32_t> refs_;  // of each cell, pieces
  std::map<StackKey, uint16_t> stacks_;
};

namespace beams {

// 1 over each component, large where that is 0.
inline Vec3 inverse(const Vec3& d) {
  const auto one = [](float x) {
    return 1 / (std::abs(x) > 1e-20f ? x : std::copysign(1e-20f, x));
  };
  return {one(d.x), one(d.y), one(d.z)};
}
struct Range {
  float near, far;
};
// The part of a ray within a box, by the inverse of its direction.
inline Range within(const Vec3& origin, const Vec3& inverse, const Vec3& lower, const Vec3& upper,
                    float near, float far) {
  const Vec3 s = (lower - origin) * inverse, t = (upper - origin) * inverse, a = min(s, t),
             b = max(s, t);
  return {std::max({near, a.x, a.y, a.z}), std::min({far, b.x, b.y, b.z})};
}

}  // namespace beams

template <class See>
void BeamTree::each(int stack, const Vec3& origin, const Vec3& direction, float near, float far,
                    Random& random, See&& see) const {
  if (stack < 0 || refs_.empty()) return;
  const Vec3 extent{root_.edge, root_.edge, root_.edge}, inverse = beams::inverse(direction);
  const auto [begin, end] =
      beams::within(origin, inverse, root_.lower, root_.lower + extent, near, far);
  const float least = 1e-6f * root_.edge;
  const Vec3 moment = photon_splat::cross(origin - settings_.middle, direction);
  for (float t = begin; t < end;) {
    const Vec3 p = origin + direction * t;
    uint32_t cell = 0;
    Box box = root_;
    while (cells_[cell].first_child >= 0) {
      const float half = 0.5f * box.edge;
      int i = 0;
      for (int a = 0; a < 3; ++a) {
        const float middle = box.lower[a] + half;
        i |= (direction[a] < 0 ? p[a] > middle : p[a] >= middle) << a;
      }
      box = box.child(i);
      cell = static_cast<uint32_t>(cells_[cell].first_child + i);
    }
    const Vec3 edges{box.edge, box.edge, box.edge};
    const float out = beams::within(origin, inverse, box.lower, box.lower + edges, begin, end).far;
    const float next = std::max({out, t + least, std::nextafter(t, INFINITY)});
    const Cell& leaf = cells_[cell];
    const float radius = leaf.radius * factor_, most = 1.01f * radius * radius;
    // Of many beams only some are looked at, chosen at random; each stands for as many
    const uint32_t step = steps(leaf);
    const auto [first, past] = group(
        leaf, step, step > 1 ? static_cast<uint32_t>(random.next() * static_cast<float>(step)) : 0);
    for (uint32_t r = first; r < past;) {
      // Beams of a cell lie anywhere in memory: several are fetched at once
      uint32_t ids[kFetched], looked_at = 0, close = 0;
      for (; r < past && looked_at < kFetched; ++r) prefetch(&lines_[ids[looked_at++] = refs_[r]]);
      for (uint32_t i = 0; i < looked_at; ++i) {
        const Line& line = lines_[ids[i]];
        const float d = dot(direction, line.moment) + dot(moment, line.direction),
                    cosine = dot(direction, line.direction);
        if (line.stack != stack || d * d > most * (1.0001f - cosine * cosine)) continue;
        prefetch(&pieces_[ids[close++] = ids[i]]);
      }
      for (uint32_t i = 0; i < close; ++i) {
        const BeamPiece& piece = pieces_[ids[i]];
        float distance, along, between, sine;
        if (!cross(origin, direction, piece, radius, &distance, &along, &between, &sine)) continue;
        if (!(distance >= t && distance < next && distance < end)) continue;
        // Epanechnikov's
        const float x2 = between * between / (radius * radius),
                    scale = 0.75f * static_cast<float>(step) / (radius * sine);
        if (!(x2 < 1)) continue;
        see(BeamCrossing{
            piece, distance, along, scale * (1 - x2),
            x2 < 0.5f ? scale * 1.41421356f * (1 - 2 * x2) : 0,
            photon_splat::cross(direction, piece.direction) * (between / (radius * sine)), radius});
      }
    }
    t = next;
  }
}

}  // namespace photon_splat
