#include <algorithm>
#include <atomic>
#include <bit>

#include "dicing/pieces.h"

namespace photon_splat {
namespace {

constexpr uint32_t kNone = ~0u;
constexpr size_t kPart = 1 << 14;  // triangles or vertices that a thread takes at once

using Halves = std::array<uint32_t, 3>;  // vertices in the middle of the edge after each corner

struct Cut {
  uint32_t triangle;
  Halves halves;  // kNone: that edge stays whole
};

// The middles of edges, by their ends: a list for each lower end.
class Middles {
 public:
  explicit Middles(size_t vertices) : first_(vertices, kNone) {}

  // Index of the vertex in the middle, which comes after those that there were.
  uint32_t of(uint32_t a, uint32_t b) {
    const auto [low, high] = std::minmax(a, b);
    uint32_t last = kNone;
    for (uint32_t e = first_[low]; e != kNone; e = edges_[e].next) {
      if (edges_[e].high == high) return index(e);
      last = e;
    }
    const uint32_t added = static_cast<uint32_t>(edges_.size());
    (last == kNone ? first_[low] : edges_[last].next) = added;
    edges_.push_back({low, high, kNone});
    return index(added);
  }

  void add_to(LargeArray<Place>& positions, ThreadPool& pool) const {
    const size_t before = first_.size();
    positions.resize(before + edges_.size());
    pool.for_parts(edges_.size(), kPart, CancelFlag{}, [&](size_t begin, size_t end) {
      for (size_t e = begin; e < end; ++e)
        positions[before + e] = (positions[edges_[e].low] + positions[edges_[e].high]) * 0.5;
    });
  }

 private:
  struct Edge {
    uint32_t low, high, next;
  };
  uint32_t index(uint32_t edge) const { return static_cast<uint32_t>(first_.size()) + edge; }

  LargeArray<uint32_t> first_;
  LargeArray<Edge> edges_;
};

// Writes the parts of a triangle, so many as halved edges and one more.
void write_parts(const Pieces& from, const Cut& cut, Pieces& to, size_t at) {
  const Halves& halves = cut.halves;
  const auto whole = [&](int k) { return halves[k] == kNone; };
  const int cuts = !whole(0) + !whole(1) + !whole(2);
  // The first corner is turned to where the pattern begins: the halved edge, or the one after the
  // whole one.
  int first = 0;
  while (cuts == 1 && whole(first)) ++first;
  if (cuts == 2) first = whole(0) ? 1 : whole(1) ? 2 : 0;
  uint32_t vertex[6];  // corners, and the middles after them
  Vec2 place[6];
  for (int k = 0; k < 3; ++k) {
    const int corner = (first + k) % 3;
    vertex[k] = from.triangles[cut.triangle][corner];
    vertex[3 + k] = halves[corner];
    place[k] = from.places[cut.triangle][corner];
    const Vec2& next = from.places[cut.triangle][(corner + 1) % 3];
    place[3 + k] = {0.5f * (place[k].x + next.x), 0.5f * (place[k].y + next.y)};
  }
  const auto write = [&](int a, int b, int c) {
    to.triangles[at] = {vertex[a], vertex[b], vertex[c]};
    to.places[at] = {place[a], place[b], place[c]};
    to.source[at++] = from.source[cut.triangle];
  };
  if (cuts == 1) {
    write(0, 3, 2);
    write(3, 1, 2);
  } else if (cuts == 3) {
    write(0, 3, 5);
    write(3, 1, 4);
    write(5, 4, 2);
    write(3, 4, 5);
  } else {
    write(3, 1, 4);
    // The four-sided rest is cut along its shorter diagonal.
    const auto between = [&](int a, int b) {
      return length(from.positions[vertex[a]] - from.positions[vertex[b]]);
    };
    const bool straight = between(0, 4) <= between(3, 2);
    write(0, 3, straight ? 4 : 2);
    write(straight ? 0 : 3, 4, 2);
  }
}

template <class T>
void copy(const LargeArray<T>& from, const LargeArray<uint32_t>& chosen, size_t done,
          LargeArray<T>& to) {
  std::copy_n(from.begin(), done, to.begin());
  for (const uint32_t t : chosen) to[done++] = from[t];
}

// One round; bits of `is_long`: edges after the corners of each triangle from `done` on. Those that
// stay whole come first in the end; returns how many they are.
size_t halve_once(Pieces& pieces, const LargeArray<uint8_t>& is_long, size_t done,
                  ThreadPool& pool) {
  LargeArray<uint32_t> whole;
  LargeArray<Cut> cuts[3];  // of one edge, of two, of three
  {
    Middles middles(pieces.positions.size());
    for (size_t i = 0; i < is_long.size(); ++i) {
      const uint32_t t = static_cast<uint32_t>(done + i);
      if (!is_long[i]) {
        whole.push_back(t);
        continue;
      }
      Cut cut{t, {kNone, kNone, kNone}};
      const Triangle& corners = pieces.triangles[t];
      for (int k = 0; k < 3; ++k)
        if (is_long[i] >> k & 1) cut.halves[k] = middles.of(corners[k], corners[(k + 1) % 3]);
      cuts[std::popcount(is_long[i]) - 1].push_back(cut);
    }
    middles.add_to(pieces.positions, pool);
  }
  Pieces made;
  const size_t kept = done + whole.size();
  const size_t count = kept + 2 * cuts[0].size() + 3 * cuts[1].size() + 4 * cuts[2].size();
  made.triangles.resize(count);
  made.source.resize(count);
  made.places.resize(count);
  copy(pieces.triangles, whole, done, made.triangles);
  copy(pieces.source, whole, done, made.source);
  copy(pieces.places, whole, done, made.places);
  size_t first = kept;
  for (size_t parts = 2; parts <= 4; ++parts) {
    const LargeArray<Cut>& chosen = cuts[parts - 2];
    pool.for_parts(chosen.size(), kPart, CancelFlag{}, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) write_parts(pieces, chosen[i], made, first + parts * i);
    });
    first += parts * chosen.size();
  }
  made.positions = std::move(pieces.positions);
  pieces = std::move(made);
  return kept;
}

// Lengths of the edges of the triangles after `done`; visit(triangle - done, corner, length).
template <class Visit>
void measure(const Pieces& pieces, const WantedEdges& wanted, const LargeArray<double>& sizes,
             size_t done, ThreadPool& pool, Visit&& visit) {
  const size_t count = pieces.triangles.size() - done;
  pool.for_parts(count, kPart, CancelFlag{}, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (unsigned k = 0; k < 3; ++k) {
        const Triangle& t = pieces.triangles[done + i];
        const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
        visit(i, k,
              wanted.length_of(pieces.positions[low], pieces.positions[high], sizes[low],
                               sizes[high]));
      }
  });
}

}  // namespace

bool Pieces::halve(const WantedEdges& wanted, unsigned rounds, size_t limit, ThreadPool& pool,
                   const std::function<void()>& go_on) {
  LargeArray<double> sizes;
  size_t done = 0;
  for (; rounds; --rounds) {
    go_on();
    const size_t known = sizes.size();
    sizes.resize(positions.size());
    pool.for_parts(sizes.size() - known, kPart, CancelFlag{}, [&](size_t begin, size_t end) {
      for (size_t v = known + begin; v < known + end; ++v) sizes[v] = wanted.size_at(positions[v]);
    });
    LargeArray<uint8_t> is_long(triangles.size() - done, 0);
    double bound = kHalvedAbove;
    const auto find_long = [&] {
      std::fill(is_long.begin(), is_long.end(), uint8_t{0});
      measure(*this, wanted, sizes, done, pool, [&](size_t i, unsigned k, double found) {
        is_long[i] |= static_cast<uint8_t>((found > bound) << k);
      });
      size_t count = 0;
      for (const uint8_t bits : is_long) count += static_cast<size_t>(std::popcount(bits));
      return count;
    };
    size_t count = find_long();
    // An edge makes one triangle more on each of its sides.
    const size_t room = limit > triangles.size() ? limit - triangles.size() : 0;
    const bool complete = count <= room;
    if (!complete) {
      if (!room) return false;
      std::vector<double> lengths(3 * is_long.size());
      measure(*this, wanted, sizes, done, pool, [&](size_t i, unsigned k, double found) {
        lengths[3 * i + k] = found > 0 ? found : 0;  // no NaN
      });
      const auto longest = lengths.end() - static_cast<std::ptrdiff_t>(room);
      std::nth_element(lengths.begin(), longest, lengths.end());
      bound = std::max(bound, *longest);
      count = find_long();
    }
    if (!count) return complete;
    done = halve_once(*this, is_long, done, pool);
    if (!complete) return false;
  }
  return true;
}

LargeArray<uint32_t> Pieces::sort_by_use() {
  LargeArray<uint32_t> number(positions.size(), kNone), first;
  LargeArray<Place> sorted;
  first.reserve(positions.size());
  sorted.reserve(positions.size());
  for (size_t t = 0; t < triangles.size(); ++t)
    for (unsigned k = 0; k < 3; ++k) {
      uint32_t& vertex = triangles[t][k];
      uint32_t& renamed = number[vertex];
      if (renamed == kNone) {
        renamed = static_cast<uint32_t>(sorted.size());
        sorted.push_back(positions[vertex]);
        first.push_back(static_cast<uint32_t>(3 * t + k));
      }
      vertex = renamed;
    }
  positions = std::move(sorted);
  return first;
}

}  // namespace photon_splat
