// Voronoi patterns: a point in every cell of a grid at a hash of the cell (Worley 1996, "A cellular
// texture basis function"), distances to edges by Quilez ("Voronoi edges"), smooth minimum over
// cells; octaves of them.
#include "math/lanes.h"
#include "shading/frame.h"
#include "textures/hashes.h"
#include "textures/noise.h"

namespace photon_splat::nodes {
namespace {

struct Settings {
  float scale, detail, roughness, lacunarity, smoothness, exponent, randomness;
  VoronoiFeature feature;
  VoronoiMetric metric;
  bool normalize;
  float longest = 0;  // distance that normalisation divides by
};

struct Result {
  float distance = 0;
  Rgb color{};
  Point<4> position{};  // in one dimension: the fourth
};

template <int N>
float squared(const Point<N>& a, const Point<N>& b) {
  float sum = 0;
  for (int d = 0; d < N; ++d) sum += (a.c[d] - b.c[d]) * (a.c[d] - b.c[d]);
  return sum;
}

// Grows with the distance, cheaper than it.
template <int N>
float rank(const Point<N>& a, const Point<N>& b, const Settings& s) {
  if (s.metric == VoronoiMetric::EUCLIDEAN) return squared(a, b);
  float sum = 0, largest = 0, powers = 0;
  for (int d = 0; d < N; ++d) {
    const float along = std::abs(a.c[d] - b.c[d]);
    sum += along;
    largest = std::max(largest, along);
    if (s.metric == VoronoiMetric::MINKOWSKI) powers += std::pow(along, s.exponent);
  }
  return s.metric == VoronoiMetric::MANHATTAN   ? sum
         : s.metric == VoronoiMetric::CHEBYCHEV ? largest
                                                : powers;
}

template <int N>
float distance_between(const Point<N>& a, const Point<N>& b, const Settings& s) {
  if constexpr (N == 1) return std::abs(a.c[0] - b.c[0]);
  const float r = rank(a, b, s);
  if (s.metric == VoronoiMetric::EUCLIDEAN) return std::sqrt(r);
  return s.metric == VoronoiMetric::MINKOWSKI ? std::pow(r, 1 / s.exponent) : r;
}

// PCG in N words, in place, on signed integers as Cycles has it; the results in 0..2^31 - 1. Words
// may be lanes of words.
template <int N, class Word>
void pcg(Word* v) {
  for (int d = 0; d < N; ++d) v[d] = v[d] * 1664525u + 1013904223u;
  const auto stir = [v] {
    if constexpr (N == 2) {
      v[0] += v[1] * 1664525u;
      v[1] += v[0] * 1664525u;
    } else if constexpr (N == 3) {
      v[0] += v[1] * v[2];
      v[1] += v[2] * v[0];
      v[2] += v[0] * v[1];
    } else {
      v[0] += v[1] * v[3];
      v[1] += v[2] * v[0];
      v[2] += v[0] * v[1];
      v[3] += v[1] * v[2];
    }
  };
  stir();
  // A shift right that keeps the sign: what it brings in is all ones where the highest bit is set.
  for (int d = 0; d < N; ++d) v[d] = v[d] ^ (v[d] >> 16 | (v[d] >> 31) * 0xffff0000u);
  stir();
  for (int d = 0; d < N; ++d) v[d] = v[d] & 0x7fffffffu;
}

constexpr float kPcgUnit = 1.0f / 2147483647.0f;

// The grid around one place. Points are relative to its cell.
template <int N, CellHash H>
struct Cells {
  Point<N> cell{}, local{};
  int32_t whole[N] = {};
  float randomness;

  Cells(const Point<N>& p, float r) : randomness(r) {
    for (int d = 0; d < N; ++d) {
      cell.c[d] = std::floor(p.c[d]);
      local.c[d] = p.c[d] - cell.c[d];
      whole[d] = to_int(cell.c[d]);
    }
  }

  uint32_t key(const Point<N>& offset, int d) const {
    return static_cast<uint32_t>(whole[d]) +
           static_cast<uint32_t>(static_cast<int32_t>(offset.c[d]));
  }

  // The points of `count` cells in a row along the first coordinate, from `offset` on.
  void points(Point<N> offset, int count, Point<N>* out) const {
    for (int i = 0; i < count; i += 4) {
      const Floats step = Floats{0, 1, 2, 3} + static_cast<float>(i);
      Floats at[N], p[N];
      for (int d = 0; d < N; ++d) at[d] = Floats{} + offset.c[d];
      at[0] = at[0] + step;
      if constexpr (N > 1 && H == CellHash::PCG) {
        Words k[N];
        for (int d = 0; d < N; ++d) k[d] = Words{} + key(offset, d);
        k[0] = k[0] + Words{0, 1, 2, 3} + static_cast<uint32_t>(i);
        pcg<N>(k);
        for (int d = 0; d < N; ++d) p[d] = to_floats(bits_of<Signed>(k[d])) * kPcgUnit;
      } else {
        Words k[N];
        for (int d = 0; d < N; ++d) k[d] = bits_of<Words>(at[d] + cell.c[d]);
        lookup3_points(k, p);
      }
      for (int d = 0; d < N; ++d) p[d] = at[d] + p[d] * randomness;
      for (int l = 0; l < 4 && i + l < count; ++l)
        for (int d = 0; d < N; ++d) out[i + l].c[d] = p[d][l];
    }
  }
  Point<N> point(const Point<N>& offset) const {
    Point<N> out;
    points(offset, 1, &out);
    return out;
  }

  Rgb color(const Point<N>& offset) const {
    if constexpr (N > 1 && H == CellHash::PCG) {
      uint32_t k[4] = {};
      for (int d = 0; d < N; ++d) k[d] = key(offset, d);
      pcg<N == 4 ? 4 : 3>(k);
      return Rgb{static_cast<float>(k[0]), static_cast<float>(k[1]), static_cast<float>(k[2])} *
             kPcgUnit;
    } else {
      float k[N];
      for (int d = 0; d < N; ++d) k[d] = cell.c[d] + offset.c[d];
      if constexpr (N == 1) return random_color(k[0]);
      if constexpr (N == 2) return random_color(k[0], k[1]);
      if constexpr (N == 3) return random_color(k[0], k[1], k[2]);
      if constexpr (N == 4) return random_color(k[0], k[1], k[2], k[3]);
    }
  }

  Point<4> position(const Point<N>& p) const {
    Point<4> out{};
    for (int d = 0; d < N; ++d) out.c[N == 1 ? 3 : d] = p.c[d] + cell.c[d];
    return out;
  }

  // Calls visit(offset, point) for the cells up to kReach away, the first coordinate running
  // fastest.
  template <int kReach, class Visit>
  void around(Visit&& visit, Point<N> center = {}) const {
    constexpr int kRow = 2 * kReach + 1;
    Point<N> offset, row[kRow];
    for (int d = 0; d < N; ++d) offset.c[d] = center.c[d] - kReach;
    for (;;) {
      points(offset, kRow, row);
      for (int i = 0; i < kRow; ++i) {
        Point<N> here = offset;
        here.c[0] += static_cast<float>(i);
        visit(here, row[i]);
      }
      int d = 1;
      while (d < N && ++offset.c[d] > center.c[d] + kReach) offset.c[d] = center.c[d] - kReach, ++d;
      if (d >= N) return;
    }
  }

 private:
  static Floats unit(const Words& hash) { return to_floats(hash) * (1.0f / 4294967295.0f); }

  static void lookup3_points(const Words* k, Floats* p) {
    const Words one = Words{} + std::bit_cast<uint32_t>(1.0f),
                two = Words{} + std::bit_cast<uint32_t>(2.0f);
    if constexpr (N == 1) p[0] = unit(lookup3(k[0]));
    if constexpr (N == 2) {
      p[0] = unit(lookup3(k[0], k[1]));
      p[1] = unit(lookup3(k[0], k[1], one));
    }
    if constexpr (N == 3) {
      p[0] = unit(lookup3(k[0], k[1], k[2]));
      p[1] = unit(lookup3(k[0], k[1], k[2], one));
      p[2] = unit(lookup3(k[0], k[1], k[2], two));
    }
    if constexpr (N == 4) {
      p[0] = unit(lookup3(k[0], k[1], k[2], k[3]));
      p[1] = unit(lookup3(k[3], k[0], k[1], k[2]));
      p[2] = unit(lookup3(k[2], k[3], k[0], k[1]));
      p[3] = unit(lookup3(k[1], k[2], k[3], k[0]));
    }
  }
};

constexpr float kFar = 3.402823466e38f;

template <int N, CellHash H>
Result nearest(const Point<N>& p, const Settings& s) {
  const Cells<N, H> cells(p, s.randomness);
  float best = kFar;
  Point<N> target{}, at{};
  cells.template around<1>([&](const Point<N>& offset, const Point<N>& candidate) {
    const float r =
        N == 1 ? distance_between(candidate, cells.local, s) : rank(candidate, cells.local, s);
    if (r < best) {
      best = r;
      target = offset;
      at = candidate;
    }
  });
  return {distance_between(at, cells.local, s), cells.color(target), cells.position(at)};
}

template <int N, CellHash H>
Result second_nearest(const Point<N>& p, const Settings& s) {
  const Cells<N, H> cells(p, s.randomness);
  float best[2] = {kFar, kFar};
  Point<N> target[2] = {}, at[2] = {};
  cells.template around<1>([&](const Point<N>& offset, const Point<N>& candidate) {
    const float r = distance_between(candidate, cells.local, s);
    if (!(r < best[1])) return;
    const int place = r < best[0] ? 0 : 1;
    if (place == 0) {
      best[1] = best[0];
      target[1] = target[0];
      at[1] = at[0];
    }
    best[place] = r;
    target[place] = offset;
    at[place] = candidate;
  });
  return {best[1], cells.color(target[1]), cells.position(at[1])};
}

template <int N, CellHash H>
Result smooth_nearest(const Point<N>& p, const Settings& s) {
  const Cells<N, H> cells(p, s.randomness);
  Result sum;
  Point<N> at{};
  bool first = true;
  cells.template around<2>([&](const Point<N>& offset, const Point<N>& candidate) {
    const float r = distance_between(candidate, cells.local, s);
    float h = 1;
    if (!first) {
      h = clamp_unit(0.5f + 0.5f * (sum.distance - r) / s.smoothness);
      h = (3 - 2 * h) * h * h;
    }
    first = false;
    float correction = s.smoothness * h * (1 - h);
    sum.distance = mix(sum.distance, r, h) - correction;
    if (h == 0) return;
    correction /= 1 + 3 * s.smoothness;
    sum.color = mix(sum.color, cells.color(offset), h) - Rgb{correction, correction, correction};
    for (int d = 0; d < N; ++d) at.c[d] = mix(at.c[d], candidate.c[d], h) - correction;
  });
  sum.position = cells.position(at);
  return sum;
}

template <int N, CellHash H>
float to_edge(const Point<N>& p, const Settings& s) {
  const Cells<N, H> cells(p, s.randomness);
  if constexpr (N == 1) {
    const float middle = cells.point({{0}}).c[0], left = cells.point({{-1}}).c[0],
                right = cells.point({{1}}).c[0];
    return std::min(std::abs((middle + left) / 2 - cells.local.c[0]),
                    std::abs((middle + right) / 2 - cells.local.c[0]));
  }
  constexpr int kCells = N == 1 ? 3 : N == 2 ? 9 : N == 3 ? 27 : 81;
  Point<N> to[kCells], closest{};
  int n = 0;
  float best = kFar;
  cells.template around<1>([&](const Point<N>&, const Point<N>& candidate) {
    Point<N>& v = to[n++];
    v = candidate;
    float l2 = 0;
    for (int d = 0; d < N; ++d) {
      v.c[d] -= cells.local.c[d];
      l2 += v.c[d] * v.c[d];
    }
    if (l2 < best) {
      best = l2;
      closest = v;
    }
  });
  best = kFar;
  for (const Point<N>& v : to) {
    const float across = squared(v, closest);
    if (!(across > 0.0001f)) continue;
    float along = 0;
    for (int d = 0; d < N; ++d) along += (closest.c[d] + v.c[d]) / 2 * (v.c[d] - closest.c[d]);
    best = std::min(best, along / std::sqrt(across));
  }
  return best;
}

template <int N, CellHash H>
float sphere_radius(const Point<N>& p, const Settings& s) {
  const Cells<N, H> cells(p, s.randomness);
  float best = kFar;
  Point<N> closest{}, cell{};
  cells.template around<1>([&](const Point<N>& offset, const Point<N>& candidate) {
    const float l2 = squared(candidate, cells.local);
    if (l2 < best) {
      best = l2;
      closest = candidate;
      cell = offset;
    }
  });
  best = kFar;
  const auto other = [&](const Point<N>& offset, const Point<N>& candidate) {
    bool same = true;
    for (int d = 0; d < N; ++d) same &= offset.c[d] == cell.c[d];
    if (!same) best = std::min(best, squared(candidate, closest));
  };
  cells.template around<1>(other, cell);
  return std::sqrt(best) / 2;
}

template <int N>
Point<N> scaled(const Point<N>& p, float scale) {
  Point<N> out;
  for (int d = 0; d < N; ++d) out.c[d] = p.c[d] * scale;
  return out;
}

template <int N, CellHash H>
Result octaves(const Point<N>& p, const Settings& s) {
  const auto octave = [&](float scale) {
    const Point<N> q = scaled(p, scale);
    if (s.feature == VoronoiFeature::F2) return second_nearest<N, H>(q, s);
    return s.feature == VoronoiFeature::SMOOTH_F1 && s.smoothness != 0 ? smooth_nearest<N, H>(q, s)
                                                                       : nearest<N, H>(q, s);
  };
  Result sum;
  float amplitude = 1, total = 0, scale = 1;
  const bool single = s.detail == 0 || s.roughness == 0;
  const float rest = s.detail - std::floor(s.detail);
  for (int i = 0, n = to_int(std::ceil(s.detail)); i <= n; ++i) {
    const Result r = octave(scale);
    if (single) {
      total = 1;
      sum = r;
      break;
    }
    const float share = static_cast<float>(i) <= s.detail ? 1 : rest, shrink = 1 / scale;
    total += share * amplitude;
    sum.distance += share * amplitude * r.distance;
    sum.color += r.color * (share * amplitude);
    for (int d = 0; d < 4; ++d) {
      float& c = sum.position.c[d];
      const float next = mix(c, r.position.c[d] * shrink, amplitude);
      c = share == 1 ? next : mix(c, next, share);
    }
    scale *= s.lacunarity;
    amplitude *= s.roughness;
  }
  if (s.normalize) {
    sum.distance /= total * s.longest;
    sum.color = sum.color / total;
  }
  // By a factor, as in Cycles: White Noise of a position tells its last bit
  const float shrink = safe_divide(1, s.scale);
  for (float& c : sum.position.c) c *= shrink;
  return sum;
}

template <int N, CellHash H>
float edge_octaves(const Point<N>& p, const Settings& s) {
  float amplitude = 1, longest = s.longest, scale = 1, distance = 8;
  const bool single = s.detail == 0 || s.roughness == 0;
  const float rest = s.detail - std::floor(s.detail);
  for (int i = 0, n = to_int(std::ceil(s.detail)); i <= n; ++i) {
    const float r = to_edge<N, H>(scaled(p, scale), s);
    if (single) {
      distance = r;
      break;
    }
    const float longer = mix(longest, s.longest / scale, amplitude);
    const float nearer = mix(distance, std::min(distance, r / scale), amplitude);
    if (static_cast<float>(i) <= s.detail) {
      longest = longer;
      distance = nearer;
      scale *= s.lacunarity;
      amplitude *= s.roughness;
    } else if (rest != 0) {
      longest = mix(longest, longer, rest);
      distance = mix(distance, std::min(distance, nearer), rest);
    }
  }
  return s.normalize ? distance / longest : distance;
}

template <int N, CellHash H>
void voronoi_in(Frame& f, const uint32_t* w, const Point<N>& p, Settings s) {
  const float half = 0.5f + 0.5f * s.randomness;
  Result result;
  float radius = 0;
  if (s.feature == VoronoiFeature::DISTANCE_TO_EDGE) {
    s.longest = half;
    result.distance = edge_octaves<N, H>(p, s);
  } else if (s.feature == VoronoiFeature::N_SPHERE_RADIUS) {
    radius = sphere_radius<N, H>(p, s);
  } else {
    Point<N> corner;
    for (float& c : corner.c) c = half;
    s.longest =
        distance_between(corner, Point<N>{}, s) * (s.feature == VoronoiFeature::F2 ? 2.0f : 1.0f);
    result = octaves<N, H>(p, s);
  }
  f.set(w[0], result.distance);
  f.set(w[1], result.color);
  f.set(w[2], Vec3{result.position.c[0], result.position.c[1], result.position.c[2]});
  f.set(w[3], result.position.c[3]);
  f.set(w[4], radius);
}

template <int N>
void voronoi_in(Frame& f, const uint32_t* w, const Point<N>& p, const Settings& s) {
  if (f.mode<CellHash>(w[18]) == CellHash::PCG)
    voronoi_in<N, CellHash::PCG>(f, w, p, s);
  else
    voronoi_in<N, CellHash::LOOKUP3>(f, w, p, s);
}

float within(float x, float high) { return x >= 0 ? std::min(x, high) : 0; }

}  // namespace

void voronoi_texture(Frame& f, const uint32_t* w) {
  Settings s{f.number(w[7]),
             within(f.number(w[8]), 15),
             within(f.number(w[9]), 1),
             f.number(w[10]),
             within(f.number(w[11]) / 2, 0.5f),
             f.number(w[12]),
             within(f.number(w[13]), 1),
             f.mode<VoronoiFeature>(w[15]),
             f.mode<VoronoiMetric>(w[16]),
             f.on(w[17])};
  const Vec3 v = f.vector(w[5]) * s.scale;
  const float t = f.number(w[6]) * s.scale;
  switch (f.mode<Dimensions>(w[14])) {
    case Dimensions::D1: return voronoi_in<1>(f, w, {{t}}, s);
    case Dimensions::D2: return voronoi_in<2>(f, w, {{v.x, v.y}}, s);
    case Dimensions::D3: return voronoi_in<3>(f, w, {{v.x, v.y, v.z}}, s);
    case Dimensions::D4: return voronoi_in<4>(f, w, {{v.x, v.y, v.z, t}}, s);
  }
}

}  // namespace photon_splat::nodes
