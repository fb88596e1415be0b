// What each corner adds to the sums: four triangles at a time.
#include <algorithm>
#include <array>
#include <atomic>
#include <cfloat>
#include <cmath>
#include <cstddef>

#include "connectivity.h"

namespace darboux::mikk {
namespace {

constexpr std::size_t lanes = 4;
using Floats = float __attribute__((vector_size(4 * lanes)));
using Mask = std::int32_t __attribute__((vector_size(4 * lanes)));

struct Vectors {
  Floats x, y, z;
};
inline Vectors operator-(const Vectors& a, const Vectors& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vectors operator*(const Floats& a, const Vectors& b) {
  return {a * b.x, a * b.y, a * b.z};
}
inline Floats dot(const Vectors& a, const Vectors& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Floats square_root(Floats a) {
  for (std::size_t i = 0; i < lanes; ++i) a[i] = std::sqrt(a[i]);
  return a;
}
Floats magnitude(const Floats& a) {
  return a < 0 ? -a : a;
}
Mask not_zero(const Floats& a) {
  return magnitude(a) > FLT_MIN;
}
Vectors select(const Mask& where, const Vectors& a, const Vectors& b) {
  return {where ? a.x : b.x, where ? a.y : b.y, where ? a.z : b.z};
}
inline Vectors normalised(const Vectors& a) {
  const Mask some = not_zero(a.x) | not_zero(a.y) | not_zero(a.z);
  return select(some, 1.0F / square_root(dot(a, a)) * a, a);
}
[[gnu::always_inline]] inline Vectors across(const Vectors& n, const Vectors& a) {
  return normalised(a - dot(n, a) * n);
}
Vector lane(const Vectors& a, std::size_t i) {
  return {a.x[i], a.y[i], a.z[i]};
}

// The power of two that brings x to [1, 2), or as near as float has one.
Floats to_one(const Floats& x) {
  return reinterpret_cast<Floats>(0x7f000000 - (reinterpret_cast<Mask>(x) & 0x7f800000));
}
Floats greater(const Floats& a, const Floats& b) {
  return a < b ? b : a;
}
Floats greatest_of(const Vectors& a) {
  return greater(greater(magnitude(a.x), magnitude(a.y)), magnitude(a.z));
}

// Triangles side by side: corners k of positions, normals, uvs.
struct Triangles {
  std::array<Vectors, 3> p, n;
  std::array<Floats, 3> u, v;
};

struct Found {
  std::array<Vectors, 3> s, t;
  std::array<Floats, 3> cosine;  // of the angle
  Mask preserves, any;
  Floats s_length, t_length;
  Floats edge_scale, uv_scale;  // lengths are to be multiplied by uv_scale / edge_scale
};

// With `scaled` edges and differences of uvs are brought to about 1, triangle by triangle.
template <bool scaled>
inline Found find(const Triangles& x) {
  Found found;
  Floats u1 = x.u[1] - x.u[0], v1 = x.v[1] - x.v[0], u2 = x.u[2] - x.u[0], v2 = x.v[2] - x.v[0];
  Vectors d1 = x.p[1] - x.p[0], d2 = x.p[2] - x.p[0], d12 = x.p[2] - x.p[1];
  const Floats one = Floats{} + 1.0F;
  found.edge_scale = found.uv_scale = one;
  if constexpr (scaled) {
    found.edge_scale = to_one(greater(greatest_of(d1), greatest_of(d2)));
    found.uv_scale = to_one(greater(greatest_of({u1, v1, u2}), magnitude(v2)));
    d1 = found.edge_scale * d1, d2 = found.edge_scale * d2, d12 = found.edge_scale * d12;
    u1 = found.uv_scale * u1, v1 = found.uv_scale * v1, u2 = found.uv_scale * u2, v2 = found.uv_scale * v2;
  }
  const Floats area = u1 * v2 - v1 * u2;
  const Vectors raw_s = v2 * d1 - v1 * d2, raw_t = u1 * d2 - u2 * d1;
  const Floats s_size = square_root(dot(raw_s, raw_s)), t_size = square_root(dot(raw_t, raw_t));
  found.preserves = area > 0;
  const Mask has_area = not_zero(area);
  const Floats sign = found.preserves ? one : -one;
  const Vectors s = select(not_zero(s_size), sign / s_size * raw_s, raw_s);
  const Vectors t = select(not_zero(t_size), sign / t_size * raw_t, raw_t);
  found.s_length = has_area ? s_size / magnitude(area) : Floats{};
  found.t_length = has_area ? t_size / magnitude(area) : Floats{};
  found.any = ~(not_zero(found.s_length) & not_zero(found.t_length));
  const std::array<Vectors, 3> from_before{d2, -one * d1, -one * d12}, to_after{d1, d12, -one * d2};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vectors& n = x.n[k];
    found.s[k] = across(n, s);
    found.t[k] = across(n, t);
    const Vectors before = across(n, from_before[k]), after = across(n, to_after[k]);
    const Floats raw = dot(before, after), above = -one < raw ? raw : -one;
    found.cosine[k] = above < one ? above : one;
  }
  return found;
}

}  // namespace

void Connectivity::differentiate(bool lengths) {
  part_ = scratch_.as<Part>(3 * good_);
  orientation_ = Buffer<Orientation>(good_);
  if (lengths) lengths_ = Buffer<Lengths>(good_);
  const Floats quarter = Floats{} + 0.25F;  // so that differences do not overflow
  std::atomic<bool> any = false;
  parallel_ranges(good_, threads_, [&](std::size_t begin, std::size_t end) {
    bool any_here = false;
    for (std::size_t first = begin; first < end; first += lanes) {
      Triangles x;
      const std::size_t count = std::min(lanes, end - first);
      for (std::size_t i = 0; i < lanes; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t from = source(3 * (first + std::min(i, count - 1)) + k);
          const float *p = &mesh_.positions[3 * from], *n = &mesh_.normals[3 * from],
                      *uv = &mesh_.uvs[2 * from];
          x.p[k].x[i] = p[0], x.p[k].y[i] = p[1], x.p[k].z[i] = p[2];
          x.n[k].x[i] = n[0], x.n[k].y[i] = n[1], x.n[k].z[i] = n[2];
          x.u[k][i] = uv[0], x.v[k][i] = uv[1];
        }
      if (range_.shrink_positions)
        for (Vectors& p : x.p) p = quarter * p;
      if (range_.shrink_uvs)
        for (std::size_t k = 0; k < 3; ++k) x.u[k] = quarter * x.u[k], x.v[k] = quarter * x.v[k];
      const Found found = range_.scale ? find<true>(x) : find<false>(x);
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t triangle = first + i;
        for (std::size_t k = 0; k < 3; ++k)
          part_[3 * triangle + k] = {lane(found.s[k], i), lane(found.t[k], i),
                                     static_cast<float>(std::acos(static_cast<double>(found.cosine[k][i])))};
        orientation_[triangle].preserves = found.preserves[i] != 0;
        orientation_[triangle].any = found.any[i] != 0;
        any_here = any_here || found.any[i] != 0;
        if (lengths) {
          const double unit = (range_.shrink_positions ? 4.0 : 1.0) / (range_.shrink_uvs ? 4.0 : 1.0) *
                              double{found.uv_scale[i]} / double{found.edge_scale[i]};
          lengths_[triangle] = {static_cast<float>(unit * double{found.s_length[i]}),
                                static_cast<float>(unit * double{found.t_length[i]})};
        }
      }
    }
    if (any_here) any = true;
  });
  any_ = any;
  // Both triangles of a quad have one orientation: that of the larger in the uvs.
  if (mesh_.face_sizes.empty()) return;
  const auto area2 = [&](std::size_t t) {
    std::array<const float*, 3> uv;
    for (std::size_t k = 0; k < 3; ++k) uv[k] = &mesh_.uvs[2 * std::size_t{source(3 * t + k)}];
    return (uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) - (uv[1][1] - uv[0][1]) * (uv[2][0] - uv[0][0]);
  };
  for (std::size_t t = 0; t + 1 < good_; ++t)
    if (face(t) == face(t + 1)) {
      Orientation &a = orientation_[t], &b = orientation_[t + 1];
      if (a.preserves != b.preserves) {
        if (b.any != 0 || std::fabs(area2(t)) >= std::fabs(area2(t + 1)))
          b.preserves = a.preserves;
        else
          a.preserves = b.preserves;
      }
      ++t;
    }
}

}  // namespace darboux::mikk
