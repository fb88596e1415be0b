#include "connectivity.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <utility>

namespace darboux::mikk {

// ---- welding ------------------------------------------------------------------------------------------------------

std::uint64_t Connectivity::hash(Index v) const {
  const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x + 0.0F)}; };
  const float *p = &mesh_.positions[3 * std::size_t{v}], *n = &mesh_.normals[3 * std::size_t{v}],
              *uv = &mesh_.uvs[2 * std::size_t{v}];
  std::uint64_t h = 0x9e3779b97f4a7c15;
  for (const std::uint64_t word : {bits(p[0]) | bits(p[1]) << 32, bits(p[2]) | bits(n[0]) << 32,
                                   bits(n[1]) | bits(n[2]) << 32, bits(uv[0]) | bits(uv[1]) << 32}) {
    h = (h ^ word) * 0xff51afd7ed558ccd;
    h ^= h >> 32;
  }
  return h;
}

bool Connectivity::equal_vertices(Index a, Index b) const {
  const auto same = [&](std::span<const float> x, std::size_t n) {
    for (std::size_t k = 0; k < n; ++k)
      if (x[n * a + k] != x[n * b + k]) return false;
    return true;
  };
  return same(mesh_.positions, 3) && same(mesh_.normals, 3) && same(mesh_.uvs, 2);
}

bool Connectivity::has_negative_zero(Index v) const {
  const auto any = [&](std::span<const float> x, std::size_t n) {
    for (std::size_t k = 0; k < n; ++k)
      if (std::bit_cast<std::uint32_t>(x[n * v + k]) == 0x80000000U) return true;
    return false;
  };
  return any(mesh_.positions, 3) || any(mesh_.normals, 3) || any(mesh_.uvs, 2);
}

// A hash table with one place for each value. Whichever thread comes first, the smallest index stays.
void Connectivity::weld() {
  const std::size_t n = mesh_.vertex_count(), room = std::bit_ceil(n + n / 2 + 1), mask = room - 1;
  same_as_.resize(n);
  const std::unique_ptr<std::atomic<Index>[]> table(new std::atomic<Index>[room]);
  in_pieces(room, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) table[i].store(none, std::memory_order_relaxed);
  });
  std::atomic<bool> negative_zeros = false;
  in_pieces(n, threads_, [&](std::size_t begin, std::size_t end) {
    constexpr std::size_t ahead = 16;
    std::array<std::size_t, ahead> places{};
    bool negative = false;
    for (std::size_t i = begin; i < end + ahead; ++i) {
      std::size_t& place = places[i % ahead];
      if (i >= begin + ahead) {
        const auto v = static_cast<Index>(i - ahead);
        for (std::size_t at = place;; at = (at + 1) & mask) {
          Index there = table[at].load(std::memory_order_relaxed);
          if (there == none && table[at].compare_exchange_strong(there, v, std::memory_order_relaxed))
            there = v;
          if (there != v && !equal_vertices(there, v)) continue;
          while (v < there && !table[at].compare_exchange_weak(there, v, std::memory_order_relaxed)) {
          }
          same_as_[v] = static_cast<Index>(at);
          break;
        }
      }
      if (i < end) {
        place = hash(static_cast<Index>(i)) & mask;
        __builtin_prefetch(&table[place]);
        negative = negative || has_negative_zero(static_cast<Index>(i));
      }
    }
    if (negative) negative_zeros = true;
  });
  in_pieces(n, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      same_as_[v] = table[same_as_[v]].load(std::memory_order_relaxed);
  });
  negative_zeros_ = negative_zeros;
}

// ---- triangles ----------------------------------------------------------------------------------------------------

// Quads are cut along the shorter diagonal, in the uvs, or where these are equal in space.
void Connectivity::list_triangles() {
  const bool quads =
      std::any_of(mesh_.face_sizes.begin(), mesh_.face_sizes.end(), [](auto n) { return n == 4; });
  all_ = mesh_.corner_count() / 3;
  if (!quads) return;
  std::size_t first = 0;
  for (std::size_t f = 0; f < mesh_.face_sizes.size(); first += mesh_.face_sizes[f++]) {
    const auto add = [&](std::initializer_list<int> corners) {
      for (const int k : corners) corner_.push_back(static_cast<Index>(first) + static_cast<Index>(k));
      face_.push_back(static_cast<Index>(f));
    };
    face_begin_.push_back(static_cast<Index>(first));
    if (mesh_.face_sizes[f] == 3) {
      add({0, 1, 2});
      continue;
    }
    const auto diagonal = [&](auto&& value, std::size_t a, std::size_t b) {
      const Vector d = value(vertex(first + b)) - value(vertex(first + a));
      return dot(d, d);
    };
    const auto uv = [&](Index v) {
      return Vector{mesh_.uvs[2 * std::size_t{v}], mesh_.uvs[2 * std::size_t{v} + 1], 1};
    };
    const auto p = [&](Index v) { return position(v); };
    const float uv02 = diagonal(uv, 0, 2), uv13 = diagonal(uv, 1, 3);
    const bool along02 = uv02 < uv13 ? true : uv13 < uv02 ? false : !(diagonal(p, 1, 3) < diagonal(p, 0, 2));
    if (along02) {
      add({0, 1, 2});
      add({0, 2, 3});
    } else {
      add({0, 1, 3});
      add({1, 2, 3});
    }
  }
  all_ = face_.size();
  cut_ = corner_;
}

// Degenerate are triangles with two corners in the same place. Each is exchanged with the next good one that was not, so that
// they come last: the order of the good ones is that of all sums.
void Connectivity::set_degenerate_apart() {
  std::vector<std::uint8_t> degenerate(all_);
  std::atomic<std::size_t> count = 0;
  in_pieces(all_, threads_, [&](std::size_t begin, std::size_t end) {
    std::size_t here = 0;
    for (std::size_t t = begin; t < end; ++t) {
      const Vector a = position(vertex(corner(3 * t))), b = position(vertex(corner(3 * t + 1))),
                   c = position(vertex(corner(3 * t + 2)));
      degenerate[t] = a == b || a == c || b == c;
      here += degenerate[t];
    }
    count += here;
  });
  good_ = all_ - count;
  if (count == 0) return;
  if (corner_.empty()) {
    corner_.resize(3 * all_);
    for (std::size_t i = 0; i < corner_.size(); ++i) corner_[i] = static_cast<Index>(i);
    face_.resize(all_);
    for (std::size_t t = 0; t < all_; ++t) face_[t] = static_cast<Index>(t);
  }
  alone_.assign(all_, 0);
  for (std::size_t t = 0; t + 1 < all_; ++t)
    if (face_[t] == face_[t + 1]) {
      alone_[t] = alone_[t + 1] = degenerate[t] != degenerate[t + 1];
      ++t;
    }
  std::size_t good = 1;
  for (std::size_t t = 0; t < good_; ++t) {
    if (!degenerate[t]) {
      good = std::max(good, t + 2);
      continue;
    }
    while (good < all_ && degenerate[good]) ++good;
    if (good == all_) break;
    for (std::size_t k = 0; k < 3; ++k) std::swap(corner_[3 * t + k], corner_[3 * good + k]);
    std::swap(face_[t], face_[good]);
    std::swap(alone_[t], alone_[good]);
    std::swap(degenerate[t], degenerate[good]);
    ++good;
  }
}

void Connectivity::differentiate() {
  derivatives_.resize(good_);
  const auto area2 = [&](std::size_t t) {
    std::array<const float*, 3> uv;
    for (std::size_t k = 0; k < 3; ++k) uv[k] = &mesh_.uvs[2 * std::size_t{source(3 * t + k)}];
    return (uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) - (uv[1][1] - uv[0][1]) * (uv[2][0] - uv[0][0]);
  };
  in_pieces(good_, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      std::array<Vector, 3> p;
      std::array<const float*, 3> uv;
      for (std::size_t k = 0; k < 3; ++k) {
        const Index v = source(3 * t + k);
        p[k] = position(v);
        uv[k] = &mesh_.uvs[2 * std::size_t{v}];
      }
      const float u1 = uv[1][0] - uv[0][0], v1 = uv[1][1] - uv[0][1];
      const float u2 = uv[2][0] - uv[0][0], v2 = uv[2][1] - uv[0][1];
      const Vector d1 = p[1] - p[0], d2 = p[2] - p[0];
      const float area = u1 * v2 - v1 * u2;
      Derivatives& d = derivatives_[t];
      d.s = v2 * d1 - v1 * d2;
      d.t = -u2 * d1 + u1 * d2;
      d.preserves = area > 0;
      d.any = true;
      if (!not_zero(area)) continue;
      const float s = length_of(d.s), t_ = length_of(d.t), sign = d.preserves ? 1.0F : -1.0F;
      if (not_zero(s)) d.s = sign / s * d.s;
      if (not_zero(t_)) d.t = sign / t_ * d.t;
      d.s_length = s / std::fabs(area);
      d.t_length = t_ / std::fabs(area);
      d.any = !not_zero(d.s_length) || !not_zero(d.t_length);
    }
  });
  // Both triangles of a quad have one orientation: that of the larger in the uvs.
  if (mesh_.face_sizes.empty()) return;
  for (std::size_t t = 0; t + 1 < good_; ++t)
    if (face(t) == face(t + 1)) {
      Derivatives &a = derivatives_[t], &b = derivatives_[t + 1];
      if (a.preserves != b.preserves) {
        if (b.any || std::fabs(area2(t)) >= std::fabs(area2(t + 1)))
          b.preserves = a.preserves;
        else
          a.preserves = b.preserves;
      }
      ++t;
    }
}

void Connectivity::list_corners() {
  const std::size_t n = mesh_.vertex_count();
  begin_.assign(n + 1, 0);
  for (std::size_t at = 0; at < 3 * good_; ++at) ++begin_[welded(at) + 1];
  for (std::size_t v = 0; v < n; ++v) begin_[v + 1] += begin_[v];
  at_vertex_.resize(3 * good_);
  for (std::size_t at = 0; at < 3 * good_; ++at) at_vertex_[begin_[welded(at)]++] = static_cast<Index>(at);
  for (std::size_t v = n; v > 0; --v) begin_[v] = begin_[v - 1];
  if (n > 0) begin_[0] = 0;
}

// Triangles are neighbours across an edge that they pass in opposite directions; of more than two each takes the first that
// is left, in the order of the triangles. An edge is looked at from its smaller vertex.
void Connectivity::find_neighbours() {
  neighbour_.assign(3 * good_, none);
  struct Edge {
    Index other, at;  // the corner where it begins in its triangle
    bool leaves;      // the vertex
  };
  in_pieces(mesh_.vertex_count(), threads_, [&](std::size_t begin, std::size_t end) {
    std::vector<Edge> edges;
    for (std::size_t v = begin; v < end; ++v) {
      edges.clear();
      for (const Index at : corners_at(static_cast<Index>(v))) {
        const auto after = static_cast<Index>(next(at)), before = static_cast<Index>(previous(at));
        if (const Index other = welded(after); other > v) edges.push_back({other, at, true});
        if (const Index other = welded(before); other > v) edges.push_back({other, before, false});
      }
      const auto by_triangle = [](const Edge& a, const Edge& b) {
        return a.other != b.other ? a.other < b.other : a.at / 3 < b.at / 3;
      };
      if (edges.size() < 24) {
        for (std::size_t i = 1; i < edges.size(); ++i)
          for (std::size_t j = i; j > 0 && by_triangle(edges[j], edges[j - 1]); --j)
            std::swap(edges[j], edges[j - 1]);
      } else {
        std::stable_sort(edges.begin(), edges.end(), by_triangle);
      }
      for (std::size_t first = 0, last; first < edges.size(); first = last) {
        for (last = first; last < edges.size() && edges[last].other == edges[first].other;) ++last;
        std::array<std::size_t, 2> ahead{first, first};  // of either direction, the first that may be left
        for (std::size_t i = first; i < last; ++i) {
          const Edge& a = edges[i];
          if (neighbour_[a.at] != none) continue;
          std::size_t& j = ahead[a.leaves ? 1 : 0];
          for (j = std::max(j, i + 1);
               j < last && (edges[j].leaves == a.leaves || neighbour_[edges[j].at] != none);)
            ++j;
          if (j == last) continue;
          neighbour_[a.at] = edges[j].at / 3;
          neighbour_[edges[j].at] = a.at / 3;
        }
      }
    }
  });
}

// The first group that comes to a triangle without uv area gives it its orientation; groups begin in the order of the corners.
// So those at the vertices of such triangles are formed one after the other.
void Connectivity::orient_any() {
  std::vector<Index> reached;
  for (std::size_t at = 0; at < 3 * good_; ++at)
    if (derivatives_[at / 3].any) {
      if (label_.empty()) {
        label_.assign(3 * good_, none);
        labelled_.assign(mesh_.vertex_count(), 0);
      }
      labelled_[welded(at)] = 1;
    }
  if (label_.empty()) return;
  for (std::size_t first = 0; first < 3 * good_; ++first) {
    const Index v = welded(first);
    if (labelled_[v] == 0 || label_[first] != none || derivatives_[first / 3].any) continue;
    const bool preserves = derivatives_[first / 3].preserves;
    const auto label = static_cast<Index>(first);
    label_[first] = label;
    reached.assign({static_cast<Index>(first)});
    while (!reached.empty()) {
      const Index at = reached.back();
      reached.pop_back();
      for (const Index t : {neighbour_[at], neighbour_[previous(at)]}) {
        if (t == none) continue;
        const Index there = corner_at(v, t);
        if (label_[there] != none) continue;
        Derivatives& d = derivatives_[t];
        if (d.any && label_[3 * t] == none && label_[3 * t + 1] == none && label_[3 * t + 2] == none)
          d.preserves = preserves;
        if (d.preserves != preserves) continue;
        label_[there] = label;
        reached.push_back(there);
      }
    }
  }
}

}  // namespace darboux::mikk
