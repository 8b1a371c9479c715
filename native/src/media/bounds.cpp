// Bounds of the extinction of media that change from place to place, by looks at their programs.
#include "media/media.h"
#include "shading/ops.h"

namespace photon_splat {
namespace {

constexpr int kFewestCells = 12, kMostCells = 32;  // along each side of a grid
constexpr int kMostBlocks = 64;                    // the same around volume grids
constexpr int kLooks = 2;                          // in a cell, along each axis
constexpr float kMargin = 1.25f;                   // bounds above what has been seen in a cell
constexpr float kLeastOfMost = 0.01f;              // bounds of empty cells, of the largest one
constexpr float kEmittedTracks = 8;                // least collisions across a medium that shines

// Whether volume grids alone decide what a program says: nothing else changes from place to place
// or from object to object.
bool asks_grids_alone(const Program& program) {
  using enum nodes::Op;
  for (size_t at = 0; at < program.code.size(); at += nodes::kWords[program.code[at]]) {
    const auto op = static_cast<nodes::Op>(program.code[at]);
    const bool computes = op <= Wavelength || op == VectorRotate || op == Mapping ||
                          op == TransformPoint || op == GridValue || op == Together ||
                          (op >= NoiseTexture && op <= IesTexture);
    if (!computes && op != Emission && op < VolumeAbsorption) return false;
  }
  return true;
}

bool asks_cubic(const Program& program) {
  for (size_t at = 0; at < program.code.size(); at += nodes::kWords[program.code[at]])
    if (static_cast<nodes::Op>(program.code[at]) == nodes::Op::GridValue &&
        program.code[at + 6] == static_cast<uint32_t>(nodes::GridInterpolation::CUBIC))
      return true;
  return false;
}

// A place in a cell, of look number `look`: they are spread over it.
Vec3 look_in_cell(int look, Random& random) {
  const Vec3 in{static_cast<float>(look % kLooks), static_cast<float>(look / kLooks % kLooks),
                static_cast<float>(look / kLooks / kLooks)};
  return (in + Vec3{random.next(), random.next(), random.next()}) * (1.0f / kLooks);
}

Vec3 as_vec(const VolumeGrid::Index& i) {
  return {static_cast<float>(i[0]), static_cast<float>(i[1]), static_cast<float>(i[2])};
}

// The box around another box's corners, moved.
template <class Move>
Bounds moved_box(const Vec3& lower, const Vec3& upper, Move&& move) {
  Bounds out;
  for (int k = 0; k < 8; ++k)
    out.add(move(
        Vec3{k & 1 ? upper.x : lower.x, k & 2 ? upper.y : lower.y, k & 4 ? upper.z : lower.z}));
  return out;
}

// The grid of most bricks, in whose coordinates bounds are kept.
const VolumeGrid& main_grid(const Mesh& mesh) {
  const VolumeGrid* best = nullptr;
  double most = -1;
  for (const MeshGrid& own : mesh.grids) {
    const Vec3 size = as_vec(own.grid->upper()) - as_vec(own.grid->lower());
    const double count = static_cast<double>(size.x) * size.y * size.z;
    if (count > most) {
      best = own.grid.get();
      most = count;
    }
  }
  return *best;
}

}  // namespace

void Media::bound(Region& region, ThreadPool& pool, const CancelFlag& cancel) {
  Region plain = region;
  plain.density = 1;
  const bool has_grids = region.instance != ShadingPoint::kNoInstance &&
                         !scene_.meshes[scene_.instances[region.instance].mesh].grids.empty();
  if (!has_grids) {
    region.grid = std::make_shared<const Grid>(look_around(plain, pool, cancel));
    return;
  }
  const bool alone = asks_grids_alone(scene_.programs[region.program]);
  const uint32_t mesh = scene_.instances[region.instance].mesh;
  for (const Shared& known : shared_)
    if (alone && known.mesh == mesh && known.program == region.program) region.grid = known.grid;
  if (region.grid) return;
  region.grid = std::make_shared<const Grid>(look_at_grids(plain, alone, pool, cancel));
  if (alone) shared_.push_back({mesh, region.program, region.grid});
}

// Looks at the extinction all over the region's object (or the whole scene).
Media::Grid Media::look_around(const Region& region, ThreadPool& pool,
                               const CancelFlag& cancel) const {
  Grid grid;
  if (region.instance == ShadingPoint::kNoInstance) {
    grid.bounds = scene_.bounds();
  } else {
    const Instance& instance = scene_.instances[region.instance];
    for (const Vec3& p : scene_.meshes[instance.mesh].positions)
      grid.bounds.add(instance.shared ? instance.to_world.point(p) : p);
  }
  if (grid.bounds.empty()) grid.bounds.add(Vec3{});
  const Vec3 extent = grid.bounds.upper - grid.bounds.lower;
  const float longest = std::max(max_component(extent), 1e-12f);
  for (int a = 0; a < 3; ++a)
    grid.size[a] = std::clamp(static_cast<int>(std::ceil(extent[a] / longest * kMostCells)),
                              kFewestCells, kMostCells);
  const int nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
  std::vector<float> seen(static_cast<size_t>(nx) * ny * nz);
  const Vec3 cell = grid.cell();
  const float shines = kEmittedTracks / std::max(length(extent), 1e-12f);
  pool.for_each(static_cast<size_t>(nz), cancel, [&](size_t z, int) {
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        float& most = seen[(z * ny + y) * nx + x];
        Random random((z * ny + y) * nx + x, 0x6d656469u);
        for (int look = 0; look < kLooks * kLooks * kLooks; ++look) {
          const Vec3 at = look_in_cell(look, random) +
                          Vec3{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
          const MediumPoint found = run(region, grid.bounds.lower + at * cell, {0, 0, 1}, {});
          most = std::max(most, max_component(found.extinction()));
          if (!is_black(found.emission)) most = std::max(most, shines);
        }
      }
  });
  grid.outside = grid.spread(seen) * kMargin;
  return grid;
}

// Looks at the voxels of largest and smallest value around each cell, as what lies between voxels
// lies between their values. Where there are no voxels grids hold nothing.
Media::Grid Media::look_at_grids(const Region& region, bool alone, ThreadPool& pool,
                                 const CancelFlag& cancel) const {
  constexpr int kSide = VolumeGrid::kSide;
  const Instance& instance = scene_.instances[region.instance];
  const Mesh& mesh = scene_.meshes[instance.mesh];
  const VolumeGrid& main = main_grid(mesh);
  const float reach = asks_cubic(scene_.programs[region.program]) ? 2.0f : 1.0f;  // voxels
  Affine to_world;
  for (size_t i = 0; i < 12; ++i) to_world.m[i] = static_cast<float>(instance.exact[i]);

  Grid grid;
  grid.from_object = main.to_index();
  Bounds all;
  for (const MeshGrid& own : mesh.grids)
    all.add(moved_box(as_vec(own.grid->lower()), as_vec(own.grid->upper()), [&](const Vec3& p) {
      return main.to_index().point(own.grid->to_object().point(p));
    }));
  // Whole bricks of the main grid, and one more around them
  const Vec3 first = as_vec(main.lower());
  float lower[3], upper[3];
  for (int a = 0; a < 3; ++a) {
    const float before = std::ceil((first[a] - all.lower[a]) / kSide - 1e-3f) + 1,
                after = std::ceil((all.upper[a] - first[a]) / kSide - 1e-3f) + 1;
    const float each =
        std::max(std::ceil((before + after) / kMostBlocks), 1.0f);  // bricks of a cell
    grid.size[a] = static_cast<int>(std::ceil((before + after) / each));
    lower[a] = first[a] - before * kSide;
    upper[a] = lower[a] + static_cast<float>(grid.size[a]) * each * kSide;
  }
  grid.bounds = {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
  grid.closed.emplace();
  const Affine& to_object = scene_.world_to_object[region.instance];
  for (const Vec3& p : mesh.positions)
    grid.closed->add(main.to_index().point(instance.shared ? p : to_object.point(p)));
  const Vec3 cell = grid.cell();

  const float extent = length(main.to_object().vector(grid.bounds.upper - grid.bounds.lower));
  const float shines = kEmittedTracks / std::max(extent, 1e-12f);
  const auto look = [&](const Vec3& in_object) {
    const MediumPoint found = run(region, to_world.point(in_object), {0, 0, 1}, {});
    const float most = max_component(found.extinction());
    return is_black(found.emission) ? most : std::max(most, shines);
  };
  // Far from all voxels
  const float empty = alone ? look(main.to_object().point(grid.bounds.upper * 2.0f +
                                                          (grid.bounds.upper - grid.bounds.lower)))
                            : 0.0f;
  const int nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
  std::vector<float> seen(static_cast<size_t>(nx) * ny * nz);
  std::vector<uint8_t> holds(seen.size());
  pool.for_each(static_cast<size_t>(nz), cancel, [&](size_t z, int) {
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        const size_t at = (z * ny + y) * nx + x;
        const Vec3 corner =
            grid.bounds.lower +
            Vec3{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)} * cell;
        float& most = seen[at] = empty;
        for (const MeshGrid& own : mesh.grids) {
          const VolumeGrid& g = *own.grid;
          const Bounds box = moved_box(corner, corner + cell, [&](const Vec3& p) {
            return &g == &main ? p : g.to_index().point(main.to_object().point(p));
          });
          VolumeGrid::Index from, to;
          for (int a = 0; a < 3; ++a) {
            const auto whole = [](float v) { return static_cast<int>(std::clamp(v, -1e9f, 1e9f)); };
            from[static_cast<size_t>(a)] = whole(std::floor(box.lower[a] - reach + 1));
            to[static_cast<size_t>(a)] = whole(std::ceil(box.upper[a] + reach - 1));
          }
          const auto extremes = g.extremes(from, to);
          if (!extremes) continue;
          holds[at] = 1;
          most = std::max(most, look(g.to_object().point(as_vec(extremes->most))));
          most = std::max(most, look(g.to_object().point(as_vec(extremes->least))));
        }
        if (alone && !holds[at]) continue;
        Random random(at, 0x6d656469u);
        for (int k = 0; k < kLooks * kLooks * kLooks; ++k)
          most =
              std::max(most, look(main.to_object().point(corner + look_in_cell(k, random) * cell)));
      }
  });
  if (!alone) {
    grid.outside = grid.spread(seen) * kMargin;
    return grid;
  }
  const float largest = *std::max_element(seen.begin(), seen.end());
  grid.most.resize(seen.size());
  for (size_t i = 0; i < seen.size(); ++i)
    grid.most[i] = (holds[i] ? std::max(seen[i], kLeastOfMost * largest) : seen[i]) * kMargin;
  grid.outside = empty * kMargin;
  return grid;
}

// What a cell's neighbours hold it may hold as well. Returns the largest that was seen.
float Media::Grid::spread(const std::vector<float>& seen) {
  const int nx = size[0], ny = size[1], nz = size[2];
  most.assign(seen.size(), 0);
  float largest = 0;
  for (float s : seen) largest = std::max(largest, s);
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        float bound = kLeastOfMost * largest;
        for (int dz = -1; dz <= 1; ++dz)
          for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
              const int i = x + dx, j = y + dy, k = z + dz;
              if (i < 0 || j < 0 || k < 0 || i >= nx || j >= ny || k >= nz) continue;
              bound = std::max(bound, seen[(static_cast<size_t>(k) * ny + j) * nx + i]);
            }
        most[(static_cast<size_t>(z) * ny + y) * nx + x] = bound * kMargin;
      }
  return largest;
}

Vec3 Media::Grid::cell() const {
  const Vec3 extent = bounds.upper - bounds.lower;
  return {extent.x / static_cast<float>(size[0]), extent.y / static_cast<float>(size[1]),
          extent.z / static_cast<float>(size[2])};
}

}  // namespace photon_splat
