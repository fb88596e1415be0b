#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cfloat>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_group.h>

#include <darboux/error.h>
#include <darboux/mikktspace.h>
#include <darboux/vector.h>

namespace darboux {
namespace {

using Vector = Vec3<float>;
using Index = std::uint32_t;
constexpr Index none = ~Index{0};

// ---- the original's arithmetic: single precision, sums from left to right -----------------------------------------

bool not_zero(float x) {
  return std::fabs(x) > FLT_MIN;
}
bool not_zero(const Vector& a) {
  return not_zero(a.x) || not_zero(a.y) || not_zero(a.z);
}
float length_of(const Vector& a) {
  return std::sqrt(dot(a, a));
}
Vector normalised(const Vector& a) {
  return not_zero(a) ? 1.0F / length_of(a) * a : a;
}
Vector across(const Vector& n, const Vector& a) {
  return normalised(a - dot(n, a) * n);
}

// f(begin, end) over pieces of [0, n), by so many threads: each takes the next piece when it is done with one.
template <class F>
void in_pieces(std::size_t n, std::size_t threads, const F& f, std::size_t least = 4096) {
  const std::size_t pieces = threads <= 1 ? 1 : std::min(n / least + 1, 16 * threads);
  if (pieces == 1) return f(std::size_t{0}, n);
  std::atomic<std::size_t> taken = 0;
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::parallel_for(
      std::size_t{0}, std::min(threads, pieces),
      [&](std::size_t) {
        for (std::size_t k; (k = taken++) < pieces;) f(n * k / pieces, n * (k + 1) / pieces);
      },
      tbb::simple_partitioner{}, context);
}

// ---- the mesh -----------------------------------------------------------------------------------------------------

// What is known of a triangle that is not degenerate.
struct Derivatives {
  Vector s, t;  // unit directions in which u and v grow, unless `any`
  float s_length = 0, t_length = 0;
  bool preserves = false;  // orientation: the uvs wind as the triangle does
  bool any = false;        // joins groups of either orientation: its uvs have no area, or s or t no length
};

class Mikk {
 public:
  Mikk(const MikkMesh& mesh, const MikkOptions& options)
      : mesh_(mesh),
        threads_(options.threads == 0 ? static_cast<std::size_t>(tbb::info::default_concurrency())
                                      : static_cast<std::size_t>(options.threads)),
        cosine_(static_cast<float>(
            std::cos(static_cast<double>(options.angular_threshold * static_cast<float>(M_PI) / 180.0F)))) {
    weld();
    list_triangles();
    name_as_the_original();
    set_degenerate_apart();
    differentiate();
    list_corners();
    find_neighbours();
    if (!options.sort_all_edges && good_ > 0) find_last_neighbours();
    orient_any();
  }

  // put(corner, tangent) for the corners that the groups serve, once for those of triangles; copy(from, to) for those that
  // degenerate triangles take over.
  template <class Put, class Copy>
  void tangents(const Put& put, const Copy& copy) const;

 private:
  Index vertex(std::size_t corner) const {
    return mesh_.corners.empty() ? static_cast<Index>(corner) : mesh_.corners[corner];
  }
  static Vector vector(std::span<const float> x, std::size_t i) {
    return {x[3 * i], x[3 * i + 1], x[3 * i + 2]};
  }
  Vector position(Index v) const { return vector(mesh_.positions, v); }
  // `at` is 3 t + k for the k-th corner of the t-th triangle, in the order in which the original works on them.
  std::size_t corner(std::size_t at) const { return corner_.empty() ? at : corner_[at]; }
  Index welded(std::size_t at) const { return same_as_[vertex(corner(at))]; }
  // Whose values a corner has: those of the vertex it is welded to, whose zeros may have other signs.
  Index source(std::size_t at) const { return negative_zeros_ ? welded(at) : vertex(corner(at)); }
  std::size_t face(std::size_t triangle) const { return face_.empty() ? triangle : face_[triangle]; }
  static std::size_t next(std::size_t at) { return at % 3 == 2 ? at - 2 : at + 1; }
  static std::size_t previous(std::size_t at) { return at % 3 == 0 ? at + 2 : at - 1; }

  void weld();
  void list_triangles();
  void set_degenerate_apart();
  void differentiate();
  void list_corners();
  void find_neighbours();
  void orient_any();
  std::size_t listed(std::size_t entry) const { return cut_.empty() ? entry : cut_[entry]; }
  void name(const std::vector<std::uint8_t>* wanted, std::vector<Index>& names) const;
  void name_as_the_original();
  void find_last_neighbours();
  std::span<const Index> corners_at(Index v) const {
    return {at_vertex_.data() + begin_[v], at_vertex_.data() + begin_[v + 1]};
  }
  Index corner_at(Index v, Index triangle) const {
    const Index at = 3 * triangle;
    return welded(at) == v ? at : welded(at + 1) == v ? at + 1 : at + 2;
  }
  bool has_negative_zero(Index v) const;
  std::uint64_t hash(Index v) const;
  bool equal_vertices(Index a, Index b) const;

  struct Scratch;
  template <class Put>
  void serve(Index v, Scratch& scratch, const Put& put) const;
  MikkTangent evaluate(const Scratch& scratch, std::span<const Index> members) const;

  const MikkMesh& mesh_;
  std::size_t threads_;
  float cosine_;
  bool negative_zeros_ = false;
  std::vector<Index> same_as_;      // of each vertex: the one that stands for all equal to it
  std::vector<Index> corner_;       // of the triangles; empty: in order
  std::vector<Index> face_;         // of the triangles; empty: in order
  std::vector<Index> face_begin_;   // the first corner of each face; empty: all are triangles
  std::vector<Index> cut_;          // the corners of the triangles in the order of the faces; empty: in order
  std::size_t all_ = 0, good_ = 0;  // triangles; the degenerate ones come last
  std::vector<std::uint8_t>
      alone_;  // of each triangle: whether it is one of a quad of which one is degenerate
  std::vector<Derivatives> derivatives_;  // of the good triangles
  std::vector<Index> begin_, at_vertex_;  // of each welded vertex: its corners in good triangles, ascending
  std::vector<Index> neighbour_;          // of each good triangle: across the edges that begin at its corners
  std::vector<Index> label_;            // of corners at vertices of `any` triangles: the first of their group
  std::vector<std::uint8_t> labelled_;  // of vertices: whether their corners have labels
};

// ---- welding ------------------------------------------------------------------------------------------------------

std::uint64_t Mikk::hash(Index v) const {
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

bool Mikk::equal_vertices(Index a, Index b) const {
  const auto same = [&](std::span<const float> x, std::size_t n) {
    for (std::size_t k = 0; k < n; ++k)
      if (x[n * a + k] != x[n * b + k]) return false;
    return true;
  };
  return same(mesh_.positions, 3) && same(mesh_.normals, 3) && same(mesh_.uvs, 2);
}

bool Mikk::has_negative_zero(Index v) const {
  const auto any = [&](std::span<const float> x, std::size_t n) {
    for (std::size_t k = 0; k < n; ++k)
      if (std::bit_cast<std::uint32_t>(x[n * v + k]) == 0x80000000U) return true;
    return false;
  };
  return any(mesh_.positions, 3) || any(mesh_.normals, 3) || any(mesh_.uvs, 2);
}

// A hash table with one place for each value. Whichever thread comes first, the smallest index stays.
void Mikk::weld() {
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
void Mikk::list_triangles() {
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
void Mikk::set_degenerate_apart() {
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

void Mikk::differentiate() {
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

void Mikk::list_corners() {
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
void Mikk::find_neighbours() {
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

// ---- the original's last edges ------------------------------------------------------------------------------------

// The original names welded vertices by one of their corners, sorts the edges by the smaller name, the runs of equal ones by
// the greater, and the runs of equal edges by triangle; but it forgets the last run of each. So which of the last edges find
// each other depends on the order that its first sort leaves, and that on the names. This is followed here as far as it
// matters.

// Cells are slabs across the longest side of the mesh, in which the original looks for equal vertices.
struct Cells {
  static constexpr int count = 2048;
  int axis = 0;
  float low = 0, high = 0;
  std::size_t of(const Vector& p) const {
    const float place = count * ((component(p, axis) - low) / (high - low));
    return place >= 0 ? place < count ? static_cast<std::size_t>(place) : count - 1
                      : 0;  // 0 of a flat mesh too
  }
  static float component(const Vector& p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }
  static int longest(const Vector& d) { return d.y > d.x && d.y > d.z ? 1 : d.z > d.x ? 2 : 0; }
};

// Names of the vertices wanted, or of all, and of others: the first corner in the order in which halving a cell, again and
// again, leaves them.
void Mikk::name(const std::vector<std::uint8_t>* wanted, std::vector<Index>& names) const {
  const std::size_t entries = 3 * all_;
  if (entries == 0) return;
  Vector low = position(vertex(listed(0))), high = low;
  for (std::size_t e = 1; e < entries; ++e) {
    const Vector p = position(vertex(listed(e)));
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  Cells cells;
  cells.axis = Cells::longest(high - low);
  cells.low = Cells::component(low, cells.axis);
  cells.high = Cells::component(high, cells.axis);
  std::vector<std::uint8_t> looked_at(Cells::count, wanted == nullptr ? 1 : 0);
  for (std::size_t v = 0; wanted != nullptr && v < wanted->size(); ++v)
    if ((*wanted)[v] != 0) looked_at[cells.of(position(static_cast<Index>(v)))] = 1;
  std::vector<std::vector<Index>> members(Cells::count);
  for (std::size_t e = 0; e < entries; ++e)
    if (const std::size_t cell = cells.of(position(vertex(listed(e)))); looked_at[cell] != 0)
      members[cell].push_back(static_cast<Index>(e));
  struct Entry {
    Vector p;
    Index entry;
  };
  in_pieces(
      Cells::count, threads_,
      [&](std::size_t begin, std::size_t end) {
        std::vector<Entry> x;
        std::vector<std::pair<std::ptrdiff_t, std::ptrdiff_t>> parts;
        for (std::size_t cell = begin; cell < end; ++cell) {
          x.clear();
          for (const Index e : members[cell]) x.push_back({position(vertex(listed(e))), e});
          parts.assign(1, {0, static_cast<std::ptrdiff_t>(x.size()) - 1});
          while (!parts.empty()) {
            const auto [first, last] = parts.back();
            parts.pop_back();
            if (first > last) continue;
            Vector lowest = x[first].p, highest = lowest;
            for (std::ptrdiff_t i = first + 1; i <= last; ++i) {
              const Vector& p = x[i].p;
              lowest = {std::min(lowest.x, p.x), std::min(lowest.y, p.y), std::min(lowest.z, p.z)};
              highest = {std::max(highest.x, p.x), std::max(highest.y, p.y), std::max(highest.z, p.z)};
            }
            const int axis = Cells::longest(highest - lowest);
            const float a = Cells::component(lowest, axis), b = Cells::component(highest, axis);
            const float middle = 0.5F * (b + a);
            if (middle >= b || middle <= a) {  // all in one place, or next to each other
              for (std::ptrdiff_t i = first; i <= last; ++i) {
                const std::size_t c = listed(x[i].entry);
                Index& name = names[same_as_[vertex(c)]];
                if (name == none) name = static_cast<Index>(c);
              }
              continue;
            }
            const auto below = [&](std::ptrdiff_t i) { return Cells::component(x[i].p, axis) < middle; };
            std::ptrdiff_t left = first, right = last;
            while (left < right) {
              while (left < right && below(left)) ++left;
              while (left < right && !below(right)) --right;
              if (left < right) std::swap(x[left++], x[right--]);
            }
            if (left == right) below(right) ? ++left : --right;
            if (left < last + 1) parts.push_back({left, last});
            if (first <= right) parts.push_back({first, right});
          }
        }
      },
      16);
}

// Zeros of either sign are equal, so that the name decides whose signs a vertex has.
void Mikk::name_as_the_original() {
  if (!negative_zeros_) return;
  std::vector<Index> names(mesh_.vertex_count(), none);
  name(nullptr, names);
  for (Index& v : same_as_)
    if (names[v] != none) v = vertex(names[v]);
}

void Mikk::find_last_neighbours() {
  // The last run by the smaller name: bounds first, then names where these leave it open.
  std::vector<Index> first(mesh_.vertex_count(), none), last(mesh_.vertex_count(), 0);
  for (std::size_t e = 0; e < 3 * all_; ++e) {
    const std::size_t c = listed(e);
    const Index v = same_as_[vertex(c)];
    first[v] = std::min(first[v], static_cast<Index>(c));
    last[v] = std::max(last[v], static_cast<Index>(c));
  }
  const auto smaller = [&](const std::vector<Index>& names, std::size_t edge) {
    return std::min(names[welded(edge)], names[welded(next(edge))]);
  };
  Index bound = 0;
  for (std::size_t e = 0; e < 3 * good_; ++e) bound = std::max(bound, smaller(first, e));
  std::vector<Index> open;
  for (std::size_t e = 0; e < 3 * good_; ++e)
    if (smaller(last, e) >= bound) open.push_back(static_cast<Index>(e));
  std::vector<std::uint8_t> wanted(mesh_.vertex_count(), 0);
  bool ambiguous = false;
  for (const Index e : open)
    for (const Index v : {welded(e), welded(next(e))}) {
      wanted[v] = 1;
      ambiguous = ambiguous || first[v] != last[v];
    }
  std::vector<Index> names;
  if (ambiguous) {
    names.assign(mesh_.vertex_count(), none);
    name(&wanted, names);
  } else {
    names = first;
  }
  Index greatest = 0;
  for (const Index e : open) greatest = std::max(greatest, smaller(names, e));
  std::vector<Index> run;
  for (const Index e : open)
    if (smaller(names, e) == greatest) run.push_back(e);
  const auto other = [&](Index edge) { return std::max(names[welded(edge)], names[welded(next(edge))]); };
  // Two edges find each other in any order, and so does none.
  std::vector<Index> others;
  for (const Index e : run) others.push_back(other(e));
  std::sort(others.begin(), others.end());
  if (run.size() < 3 || std::adjacent_find(others.begin(), others.end()) == others.end()) return;
  if (ambiguous) name(nullptr, names);
  // The original's first sort, of which only what leads to the last run is followed.
  struct Edge {
    Index name, edge;
  };
  std::vector<Edge> edges(3 * good_);
  for (std::size_t e = 0; e < edges.size(); ++e) edges[e] = {smaller(names, e), static_cast<Index>(e)};
  struct Part {
    std::ptrdiff_t first, last;
    std::uint32_t seed;
  };
  std::vector<Part> parts{{0, static_cast<std::ptrdiff_t>(edges.size()) - 1, 39871946}};
  while (!parts.empty()) {
    auto [begin, end, seed] = parts.back();
    parts.pop_back();
    if (end - begin < 1) continue;
    if (end - begin == 1) {
      if (edges[begin].name > edges[end].name) std::swap(edges[begin], edges[end]);
      continue;
    }
    seed += std::rotl(seed, static_cast<int>(seed & 31U)) + 3;
    const Index pivot =
        edges[begin + static_cast<std::ptrdiff_t>(seed % static_cast<std::uint32_t>(end - begin + 1))].name;
    std::ptrdiff_t left = begin, right = end;
    do {
      while (edges[left].name < pivot) ++left;
      while (edges[right].name > pivot) --right;
      if (left <= right) std::swap(edges[left++], edges[right--]);
    } while (left <= right);
    if (pivot == greatest && begin < right) parts.push_back({begin, right, seed});
    if (left < end) parts.push_back({left, end, seed});
  }
  for (std::size_t i = 0; i < run.size(); ++i) run[i] = edges[edges.size() - run.size() + i].edge;
  const auto same = [&](std::size_t i, std::size_t j) { return other(run[i]) == other(run[j]); };
  for (std::size_t i = 0, j; i < run.size(); i = j) {
    for (j = i; j < run.size() && same(i, j);) ++j;
    if (j < run.size())
      std::sort(run.begin() + static_cast<std::ptrdiff_t>(i), run.begin() + static_cast<std::ptrdiff_t>(j));
  }
  for (const Index e : run) neighbour_[e] = none;
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (neighbour_[run[i]] != none) continue;
    for (std::size_t j = i + 1; j < run.size() && same(i, j); ++j)
      if (neighbour_[run[j]] == none && welded(run[j]) == welded(next(run[i]))) {
        neighbour_[run[i]] = run[j] / 3;
        neighbour_[run[j]] = run[i] / 3;
        break;
      }
  }
}

// The first group that comes to a triangle without uv area gives it its orientation; groups begin in the order of the corners.
// So those at the vertices of such triangles are formed one after the other.
void Mikk::orient_any() {
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

// ---- groups -------------------------------------------------------------------------------------------------------

struct Mikk::Scratch {
  std::vector<Index> group, reached, first, next, order, members;
  // Of the members of a group: what they add.
  std::vector<Index> at;
  std::vector<Vector> s, t;
  std::vector<float> angle;
};

// The average over some members, weighted by the angle between a triangle's edges as seen along the normal.
MikkTangent Mikk::evaluate(const Scratch& scratch, std::span<const Index> members) const {
  Vector s{0, 0, 0}, t{0, 0, 0};
  float s_length = 0, t_length = 0, sum = 0;
  for (const Index i : members) {
    const Derivatives& d = derivatives_[scratch.at[i] / 3];
    if (d.any) continue;
    const float angle = scratch.angle[i];
    s += angle * scratch.s[i];
    t += angle * scratch.t[i];
    s_length += angle * d.s_length;
    t_length += angle * d.t_length;
    sum += angle;
  }
  s = normalised(s);
  t = normalised(t);
  if (sum > 0) {
    s_length /= sum;
    t_length /= sum;
  }
  return {{s.x, s.y, s.z}, {t.x, t.y, t.z}, s_length, t_length, 1};
}

template <class Put>
void Mikk::serve(Index v, Scratch& x, const Put& put) const {
  const std::span<const Index> corners = corners_at(v);
  // Groups: corners joined by edges at v between triangles of one orientation; numbered by their first.
  x.group.assign(corners.size(), none);
  Index groups = 0;
  const bool labelled = !labelled_.empty() && labelled_[v] != 0;
  const auto place_of = [&](Index at) {
    return static_cast<std::size_t>(std::lower_bound(corners.begin(), corners.end(), at) - corners.begin());
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (labelled) {
      if (const Index label = label_[corners[i]]; label != none)
        x.group[i] = label == corners[i] ? groups++ : none - 1;
      continue;
    }
    if (x.group[i] != none) continue;
    const bool preserves = derivatives_[corners[i] / 3].preserves;
    x.group[i] = groups;
    x.reached.assign(1, corners[i]);
    while (!x.reached.empty()) {
      const Index at = x.reached.back();
      x.reached.pop_back();
      for (const Index t : {neighbour_[at], neighbour_[previous(at)]}) {
        if (t == none || derivatives_[t].preserves != preserves) continue;
        const Index there = corner_at(v, t);
        Index& group = x.group[place_of(there)];
        if (group != none) continue;
        group = groups;
        x.reached.push_back(there);
      }
    }
    ++groups;
  }
  if (labelled)
    for (std::size_t i = 0; i < corners.size(); ++i)
      if (x.group[i] == none - 1) x.group[i] = x.group[place_of(label_[corners[i]])];

  // The corners of each group, ascending.
  x.first.assign(groups, none);
  x.next.resize(corners.size());
  for (std::size_t i = corners.size(); i-- > 0;)
    if (x.group[i] != none) x.next[i] = std::exchange(x.first[x.group[i]], static_cast<Index>(i));

  for (Index g = 0; g < groups; ++g) {
    x.at.clear(), x.s.clear(), x.t.clear(), x.angle.clear(), x.order.clear();
    for (Index i = x.first[g]; i != none; i = x.next[i]) {
      const std::size_t at = corners[i];
      const Vector n = vector(mesh_.normals, source(at)), p = position(source(at));
      const Derivatives& d = derivatives_[at / 3];
      const Vector before = across(n, position(source(previous(at))) - p);
      const Vector after = across(n, position(source(next(at))) - p);
      const float cosine = std::min(1.0F, std::max(-1.0F, dot(before, after)));
      x.order.push_back(static_cast<Index>(x.at.size()));
      x.at.push_back(static_cast<Index>(at));
      x.s.push_back(across(n, d.s));
      x.t.push_back(across(n, d.t));
      x.angle.push_back(static_cast<float>(std::acos(static_cast<double>(cosine))));
    }
    const bool preserves = derivatives_[x.at[0] / 3].preserves;
    const auto write = [&](std::size_t i, MikkTangent tangent) {
      tangent.sign = preserves ? 1.0F : -1.0F;
      put(corner(x.at[i]), tangent);
    };
    const auto together = [&](std::size_t i, std::size_t j) {
      const std::size_t a = x.at[i] / 3, b = x.at[j] / 3;
      return derivatives_[a].any || derivatives_[b].any || face(a) == face(b) ||
             (dot(x.s[i], x.s[j]) > cosine_ && dot(x.t[i], x.t[j]) > cosine_);
    };
    // At the usual 180 degrees only opposite directions part: there are none where all are on one side.
    bool all = cosine_ <= -1;
    std::size_t first = none;
    for (std::size_t i = 0; all && i < x.at.size(); ++i) {
      if (derivatives_[x.at[i] / 3].any) continue;
      if (first == none) first = i;
      all = i == first || (dot(x.s[i], x.s[first]) > 0.1F && dot(x.t[i], x.t[first]) > 0.1F);
    }
    if (!all) {
      all = true;
      for (std::size_t i = 0; all && i < x.at.size(); ++i)
        for (std::size_t j = 0; all && j < i; ++j) all = together(i, j);
    }
    if (all) {
      const MikkTangent tangent = evaluate(x, x.order);
      for (std::size_t i = 0; i < x.at.size(); ++i) write(i, tangent);
    } else {
      for (std::size_t i = 0; i < x.at.size(); ++i) {
        x.members.clear();
        for (std::size_t j = 0; j < x.at.size(); ++j)
          if (together(i, j)) x.members.push_back(static_cast<Index>(j));
        write(i, evaluate(x, x.members));
      }
    }
  }
}

template <class Put, class Copy>
void Mikk::tangents(const Put& put, const Copy& copy) const {
  in_pieces(mesh_.vertex_count(), threads_, [&](std::size_t begin, std::size_t end) {
    Scratch scratch;
    for (std::size_t v = begin; v < end; ++v)
      if (begin_[v] != begin_[v + 1]) serve(static_cast<Index>(v), scratch, put);
  });
  // A degenerate triangle takes over what the first good corner at the vertex has.
  for (std::size_t at = 3 * good_; at < 3 * all_; ++at)
    if (alone_[at / 3] == 0)
      if (const auto corners = corners_at(welded(at)); !corners.empty()) copy(corner(corners[0]), corner(at));
  // The fourth corner of a quad, one of whose triangles is degenerate: from the corner in the same place.
  for (std::size_t t = 0; good_ < all_ && t < good_; ++t) {
    if (alone_[t] == 0) continue;
    const std::size_t begin = face_begin_[face(t)];
    const auto at = [&](std::size_t k) { return corner(3 * t + k); };
    for (std::size_t missing = begin; missing < begin + 4; ++missing) {
      if (missing == at(0) || missing == at(1) || missing == at(2)) continue;
      for (std::size_t k = 0; k < 3; ++k)
        if (position(vertex(at(k))) == position(vertex(missing))) {
          copy(at(k), missing);
          break;
        }
    }
  }
}

// ---- input --------------------------------------------------------------------------------------------------------

void check(const MikkMesh& mesh, const MikkOptions& options) {
  const std::size_t n = mesh.positions.size() / 3;
  const auto refuse = [](const std::string& why) { throw MeshError("mesh", why); };
  if (mesh.positions.size() % 3 != 0)
    refuse("has " + std::to_string(mesh.positions.size()) +
           " numbers of positions, permitted are three a vertex");
  if (mesh.normals.size() != 3 * n)
    refuse("has " + std::to_string(mesh.normals.size()) +
           " numbers of normals, permitted are three for each of its " + std::to_string(n) + " vertices");
  if (mesh.uvs.size() != 2 * n)
    refuse("has " + std::to_string(mesh.uvs.size()) + " numbers of uvs, permitted are two for each of its " +
           std::to_string(n) + " vertices");
  const std::size_t corners = mesh.corner_count();
  if (corners >= none / 3)
    refuse("has " + std::to_string(corners) + " corners, permitted are up to " +
           std::to_string(none / 3 - 1));
  for (std::size_t c = 0; c < mesh.corners.size(); ++c)
    if (mesh.corners[c] >= n)
      refuse("corner " + std::to_string(c) + " is vertex " + std::to_string(mesh.corners[c]) +
             ", permitted are 0 to " + std::to_string(n) + " - 1");
  std::size_t sum = 0;
  for (std::size_t f = 0; f < mesh.face_sizes.size(); ++f) {
    if (mesh.face_sizes[f] != 3 && mesh.face_sizes[f] != 4)
      refuse("face " + std::to_string(f) + " has " + std::to_string(mesh.face_sizes[f]) +
             " corners, permitted are 3 and 4");
    sum += mesh.face_sizes[f];
  }
  if (mesh.face_sizes.empty() ? corners % 3 != 0 : sum != corners)
    refuse("has " + std::to_string(corners) + " corners, permitted are those of its faces, " +
           (mesh.face_sizes.empty() ? "three each" : std::to_string(sum)));
  const auto check_finite = [&](std::span<const float> x, std::size_t components, const char* name) {
    float zero = 0;
    for (const float value : x) zero += value * 0;
    if (zero == 0) return;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (!std::isfinite(x[i]))
        refuse(std::string(name) + " of vertex " + std::to_string(i / components) + " is " +
               std::to_string(x[i]) + ", permitted are finite numbers");
  };
  check_finite(mesh.positions, 3, "position");
  check_finite(mesh.normals, 3, "normal");
  check_finite(mesh.uvs, 2, "uv");
  if (options.threads < 0)
    throw ParameterError("threads",
                         std::to_string(options.threads) + " threads, permitted is 0 (all) or more");
  if (!(options.angular_threshold >= 0 && options.angular_threshold <= 180))
    throw ParameterError("angular threshold",
                         std::to_string(options.angular_threshold) + " degrees, permitted are 0 to 180");
}

bool has_quads(const MikkMesh& mesh) {
  return std::any_of(mesh.face_sizes.begin(), mesh.face_sizes.end(), [](auto n) { return n == 4; });
}

// The average of what two triangles of a quad give to a corner.
MikkTangent average(const MikkTangent& a, const MikkTangent& b) {
  const auto same = [](const auto& x, const auto& y) {
    return std::equal(std::begin(x), std::end(x), std::begin(y));
  };
  if (a.t_length == b.t_length && a.b_length == b.b_length && same(a.t, b.t) && same(a.b, b.b)) {
    MikkTangent both = a;
    both.sign = b.sign;
    return both;
  }
  const auto mean = [](const auto& x, const auto& y) {
    return normalised(Vector{x[0], x[1], x[2]} + Vector{y[0], y[1], y[2]});
  };
  const Vector t = mean(a.t, b.t), bt = mean(a.b, b.b);
  return {{t.x, t.y, t.z},
          {bt.x, bt.y, bt.z},
          0.5F * (a.t_length + b.t_length),
          0.5F * (a.b_length + b.b_length),
          b.sign};
}

}  // namespace

std::vector<MikkTangent> mikktspace(const MikkMesh& mesh, const MikkOptions& options) {
  check(mesh, options);
  std::vector<MikkTangent> result(mesh.corner_count());
  std::vector<std::uint8_t> written(has_quads(mesh) ? result.size() : 0);
  Mikk(mesh, options)
      .tangents(
          [&](std::size_t corner, const MikkTangent& tangent) {
            result[corner] = !written.empty() && std::exchange(written[corner], 1) != 0
                                 ? average(result[corner], tangent)
                                 : tangent;
          },
          [&](std::size_t from, std::size_t to) { result[to] = result[from]; });
  return result;
}

void mikktspace(const MikkMesh& mesh, std::span<float> tangent4, const MikkOptions& options) {
  check(mesh, options);
  if (tangent4.size() != 4 * mesh.corner_count())
    throw ParameterError("tangent4", std::to_string(tangent4.size()) +
                                         " numbers, permitted are four for each of the " +
                                         std::to_string(mesh.corner_count()) + " corners");
  const auto put = [&](std::size_t corner, const MikkTangent& x) {
    float* to = &tangent4[4 * corner];
    to[0] = x.t[0], to[1] = x.t[1], to[2] = x.t[2], to[3] = x.sign;
  };
  if (has_quads(mesh)) {
    const std::vector<MikkTangent> all = mikktspace(mesh, options);
    for (std::size_t c = 0; c < all.size(); ++c) put(c, all[c]);
    return;
  }
  for (std::size_t c = 0; c < mesh.corner_count(); ++c) put(c, MikkTangent{});
  Mikk(mesh, options).tangents(put, [&](std::size_t from, std::size_t to) {
    std::copy_n(&tangent4[4 * from], 4, &tangent4[4 * to]);
  });
}

}  // namespace darboux
