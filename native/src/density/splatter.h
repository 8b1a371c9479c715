// The CPU splatter: photons and blocks of points in, sums in the blocks out. Knows no camera.
#pragma once

#include <string>

#include "density/point_blocks.h"
#include "density/way_sums.h"
#include "photons/photon.h"
#include "util/large_pages.h"
#include "util/parallel.h"

namespace photon_splat {

// The fastest kernel this machine runs, or the one asked for: "avx512", "avx2", "sse42", "generic",
// "" = fastest. Throws std::invalid_argument for one that this machine or build does not have.
SplatKernel choose_kernel(const std::string& name, std::string* chosen = nullptr);

class Splatter {
 public:
  explicit Splatter(const std::string& kernel = "")
      : kernel_(choose_kernel(kernel, &kernel_name_)) {}

  // Makes the search tree over block bounds (grown by kernel radii). Call after the points changed.
  void set_blocks(const std::vector<Bounds>& bounds);

  // Adds photons to the sums of all blocks they may reach, and their ways to `ways` where it has
  // any. They are sorted along a space-filling curve first, and search together in groups of
  // neighbours; each block takes them in that order, so that the sums are the same for any number
  // of threads.
  void splat(const Photons& photons, PointBlocks& blocks, WaySums& ways, ThreadPool& pool,
             const CancelFlag& cancel);

  // The same for photons that are splatted on other points again and again: they are sorted when
  // there are more of them than the last time. For this splatter never any but these, and no more
  // than a million at once.
  void splat_kept(const Photons& photons, PointBlocks& blocks, WaySums& ways, ThreadPool& pool,
                  const CancelFlag& cancel);

  // Which photons each block may catch, for a splatter elsewhere: block b those of
  // order()[first()[b] .. first()[b + 1]), ascending.
  void find_pairs(const Photon* photons, size_t count, size_t block_count, ThreadPool& pool,
                  const CancelFlag& cancel);
  const std::vector<uint32_t>& first() const { return first_; }
  const std::vector<uint32_t>& order() const { return order_; }

  const std::string& kernel_name() const { return kernel_name_; }
  uint64_t pairs() const { return pairs_; }

 private:
  struct Pair {
    uint32_t block, index;  // of a photon or a group of them
  };
  // Four neighbours of one level: which of them hold a point is one vector comparison.
  struct alignas(16) Node {
    float lower_x[4], lower_y[4], lower_z[4], upper_x[4], upper_y[4], upper_z[4];
  };
  struct Parts {
    std::vector<SplatPart> parts;
    std::vector<Node> bounds;  // of them by fours
  };
  static Node make_node(const std::vector<Bounds>& bounds, size_t first);
  struct Query;
  void sort_photons(const Photon* photons, size_t count, const Bounds& within, ThreadPool& pool);
  void find_ways(const Photon* photons, size_t count, ThreadPool& pool);
  void splat_sorted(PointBlocks& blocks, WaySums& ways, ThreadPool& pool, const CancelFlag& cancel);
  void make_parts(const PointBlocks& blocks, ThreadPool& pool);
  void deal_pairs(size_t chunk_count, size_t block_count);
  void find_blocks(const Bounds& bounds, uint32_t index, std::vector<Pair>& out) const;

  std::string kernel_name_;
  SplatKernel kernel_;
  // Level 0 holds the blocks, four to a node; each further level holds the nodes of the one below
  std::vector<std::vector<Node>> levels_;
  Bounds bounds_;             // of all blocks
  std::vector<Parts> parts_;  // of the blocks, or none yet
  std::vector<std::vector<Pair>> chunk_pairs_;
  std::vector<uint32_t> first_, order_;
  LargeArray<uint64_t> curve_, curve_scratch_;  // place on the curve and index of each photon
  LargeArray<SplatGroup> groups_;
  LargeArray<WayGroup> way_groups_;  // of the same photons, where they are wanted
  std::vector<Bounds> group_bounds_;
  uint64_t pairs_ = 0;
  size_t kept_ = 0, kept_ways_ = 0;  // photons that splat_kept() has sorted, and found the ways of
};

}  // namespace photon_splat
