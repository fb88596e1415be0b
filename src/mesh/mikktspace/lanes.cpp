// The contribution of each corner to the sums, in lanes. Compiled once per instruction set; DARBOUX_ISA names
// this one. Everything but the table has internal linkage.
#include "lanes.h"

#include <cfloat>
#include <cmath>
#include <cstring>
#include <utility>

namespace darboux::mikk {
namespace {

#if defined(__AVX512F__)
constexpr int lanes = 16;
#elif defined(__AVX2__)
constexpr int lanes = 8;
#else
constexpr int lanes = 4;
#endif
using Floats = float __attribute__((vector_size(4 * lanes)));
using Mask = std::int32_t __attribute__((vector_size(4 * lanes)));
using Half = float __attribute__((vector_size(2 * lanes)));
using Doubles = double __attribute__((vector_size(4 * lanes)));  // half as many
using Four = float __attribute__((vector_size(16)));
using Two = double __attribute__((vector_size(16)));
constexpr int blocks = lanes / 4;  // of four lanes
using All = std::make_integer_sequence<int, lanes>;
using Blocks = std::array<Four, blocks>;

#define DARBOUX_INLINE [[gnu::always_inline]] inline

// ---- four by four

template <int... k>
DARBOUX_INLINE Half half(const Floats& a, int upper, std::integer_sequence<int, k...>) {
  return upper != 0 ? __builtin_shufflevector(a, a, (k + lanes / 2)...) : __builtin_shufflevector(a, a, k...);
}
DARBOUX_INLINE Half half(const Floats& a, int upper) {
  return half(a, upper, std::make_integer_sequence<int, lanes / 2>{});
}
template <int... k>
DARBOUX_INLINE Floats joined(const Half& a, const Half& b, std::integer_sequence<int, k...>) {
  return __builtin_shufflevector(a, b, k...);
}
template <std::size_t count>
DARBOUX_INLINE auto joined(const std::array<Four, count>& x) {
  if constexpr (count == 1) {
    return x[0];
  } else if constexpr (count == 2) {
    return __builtin_shufflevector(x[0], x[1], 0, 1, 2, 3, 4, 5, 6, 7);
  } else {
    return __builtin_shufflevector(joined(std::array{x[0], x[1]}), joined(std::array{x[2], x[3]}), 0, 1, 2, 3,
                                   4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  }
}
template <int block>
DARBOUX_INLINE Four block_of(const Floats& a) {
  return __builtin_shufflevector(a, a, 4 * block, 4 * block + 1, 4 * block + 2, 4 * block + 3);
}

// In each block, lanes p0 ... p3: 0 to 3 are of a, 4 to 7 of b.
template <int p0, int p1, int p2, int p3, int... k>
DARBOUX_INLINE Floats mix(const Floats& a, const Floats& b, std::integer_sequence<int, k...>) {
  constexpr std::array<int, 4> from{p0, p1, p2, p3};
  return __builtin_shufflevector(
      a, b, (from[k % 4] < 4 ? k / 4 * 4 + from[k % 4] : lanes + k / 4 * 4 + from[k % 4] - 4)...);
}
template <int p0, int p1, int p2, int p3>
DARBOUX_INLINE Floats mix(const Floats& a, const Floats& b) {
  return mix<p0, p1, p2, p3>(a, b, All{});
}
struct Rows {
  Floats a, b, c, d;
};
// Transposes each block.
DARBOUX_INLINE Rows turned(const Rows& row) {
  const Floats a = mix<0, 4, 1, 5>(row.a, row.b), b = mix<0, 4, 1, 5>(row.c, row.d),
               c = mix<2, 6, 3, 7>(row.a, row.b), d = mix<2, 6, 3, 7>(row.c, row.d);
  return {mix<0, 1, 4, 5>(a, b), mix<2, 3, 6, 7>(a, b), mix<0, 1, 4, 5>(c, d), mix<2, 3, 6, 7>(c, d)};
}

// Loads from, or stores to, a byte of an object, across its members.
DARBOUX_INLINE Four load(const void* from, std::size_t byte = 0) {
  Four x;
  std::memcpy(&x, static_cast<const char*>(from) + byte, sizeof x);
  return x;
}
DARBOUX_INLINE void store(void* to, std::size_t byte, const Four& x) {
  std::memcpy(static_cast<char*>(to) + byte, &x, sizeof x);
}

// ---- the original's arithmetic

struct Vectors {
  Floats x, y, z;
};
DARBOUX_INLINE Vectors operator-(const Vectors& a, const Vectors& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
DARBOUX_INLINE Vectors operator*(const Floats& a, const Vectors& b) {
  return {a * b.x, a * b.y, a * b.z};
}
DARBOUX_INLINE Floats dot(const Vectors& a, const Vectors& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
DARBOUX_INLINE Floats square_root(const Floats& a) {
  Floats root;
  for (int i = 0; i < lanes; ++i) root[i] = std::sqrt(a[i]);
  return root;
}
DARBOUX_INLINE Floats magnitude(const Floats& a) {
  return reinterpret_cast<Floats>(reinterpret_cast<Mask>(a) & 0x7fffffff);
}
DARBOUX_INLINE Mask not_zero(const Floats& a) {
  return magnitude(a) > FLT_MIN;
}
DARBOUX_INLINE Vectors select(const Mask& where, const Vectors& a, const Vectors& b) {
  return {where ? a.x : b.x, where ? a.y : b.y, where ? a.z : b.z};
}
DARBOUX_INLINE Floats greater(const Floats& a, const Floats& b) {
  return a < b ? b : a;
}
DARBOUX_INLINE Floats greatest_of(const Vectors& a) {
  return greater(greater(magnitude(a.x), magnitude(a.y)), magnitude(a.z));
}
DARBOUX_INLINE Vectors normalised(const Vectors& a) {
  const Mask some = not_zero(a.x) | not_zero(a.y) | not_zero(a.z);
  return select(some, 1.0F / square_root(dot(a, a)) * a, a);
}
DARBOUX_INLINE Vectors across(const Vectors& n, const Vectors& a) {
  return normalised(a - dot(n, a) * n);
}
// The power of two that scales x to [1, 2), or the nearest that float has.
DARBOUX_INLINE Floats to_one(const Floats& x) {
  return reinterpret_cast<Floats>(0x7f000000 - (reinterpret_cast<Mask>(x) & 0x7f800000));
}

// ---- angles

// acos x in double as two bounds, the lower one rounded to float: from asin(√z)/√z as a polynomial on [0,
// 1/4], interpolated at Chebyshev nodes, within 2^-39.8.
DARBOUX_INLINE Half arc_cosines(const Half& cosine, Doubles& low, Doubles& high) {
  constexpr std::array<double, 9> p{0x1.0000000000e83p+0, 0x1.55555542fd475p-3,  0x1.33334261d9e87p-4,
                                    0x1.6db20cadb1f43p-5, 0x1.f288c804351cep-6,  0x1.6615a0ec8d425p-6,
                                    0x1.52d7c5f5c757bp-6, 0x1.f62a804832cc1p-10, 0x1.0dfd15eca3951p-5};
  constexpr double error = 0x1p-38, pi = 0x1.921fb54442d18p+1;
  const Doubles x = __builtin_convertvector(cosine, Doubles), zero{}, size = x < 0 ? -x : x;
  const auto near_one = size > 0.5;
  const Doubles z = near_one ? 0.5 - 0.5 * size : x * x;
  Doubles root;
  for (int i = 0; i < lanes / 2; ++i) root[i] = std::sqrt(z[i]);
  Doubles sum = zero + p[8];
#pragma GCC unroll 8
  for (int k = 7; k >= 0; --k) sum = sum * z + p[k];
  const Doubles arc = root * sum;  // asin
  const Doubles from_one = 2 * arc;
  const Doubles near = x < 0 ? pi - from_one : from_one, middle = x < 0 ? pi / 2 + arc : pi / 2 - arc;
  const Doubles angle = near_one ? near : middle;
  low = angle - error * angle;
  high = angle + error * angle;
  return __builtin_convertvector(low, Half);
}
// If both bounds round to one float, acos of the C library rounds to it too, as it errs by less than the
// bounds. Else, once in some thousands, the C library decides.
DARBOUX_INLINE Floats arc_cosines(const Floats& cosine, float (*exactly)(float)) {
  std::array<Half, 2> low, high;
  for (int k = 0; k < 2; ++k) {
    Doubles from, to;
    low[k] = arc_cosines(half(cosine, k), from, to);
    high[k] = __builtin_convertvector(to, Half);
  }
  Floats angle = joined(low[0], low[1], All{});
  const Mask unsure = angle != joined(high[0], high[1], All{});
  std::int32_t any = 0;
  for (int i = 0; i < lanes; ++i) any |= unsure[i];
  if (any != 0)
    for (int i = 0; i < lanes; ++i)
      if (unsure[i] != 0) angle[i] = exactly(cosine[i]);
  return angle;
}

void arc_cosines(const float* cosines, std::size_t count, float (*exactly)(float), float* angles) {
  for (std::size_t i = 0; i < count; i += lanes) {
    Floats x;
    std::memcpy(&x, cosines + i, sizeof x);
    x = arc_cosines(x, exactly);
    std::memcpy(angles + i, &x, sizeof x);
  }
}

// ---- triangles side by side

struct Corners {
  std::array<Vectors, 3> p, n;
  std::array<Floats, 3> u, v;
};

struct Found {
  Vectors s, t;
  std::array<Floats, 3> cosine;  // of the angles
  Mask preserves, any;
  Floats s_length, t_length;
  Floats edge_scale, uv_scale;  // lengths are to be multiplied by uv_scale / edge_scale
};

// If `scaled`, edges and differences of uvs are scaled to about 1, triangle by triangle.
template <bool scaled>
DARBOUX_INLINE Found find(const Corners& x) {
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
  found.s = select(not_zero(s_size), sign / s_size * raw_s, raw_s);
  found.t = select(not_zero(t_size), sign / t_size * raw_t, raw_t);
  found.s_length = has_area ? s_size / magnitude(area) : Floats{};
  found.t_length = has_area ? t_size / magnitude(area) : Floats{};
  found.any = ~(not_zero(found.s_length) & not_zero(found.t_length));
  const std::array<Vectors, 3> from_before{d2, -one * d1, -one * d12}, to_after{d1, d12, -one * d2};
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    const Vectors before = across(x.n[k], from_before[k]), after = across(x.n[k], to_after[k]);
    const Floats raw = dot(before, after), above = -one < raw ? raw : -one;
    found.cosine[k] = above < one ? above : one;
  }
  return found;
}

// Three numbers of a vertex and one of the next; for the last vertex, without reading beyond the end.
DARBOUX_INLINE Four three_of(const float* x, Index v, Index last) {
  const float* const at = x + 3 * std::size_t{v};
  return v < last ? load(at) : Four{at[0], at[1], at[2], 0};
}
DARBOUX_INLINE Two pairs_of(const float* x, Index a, Index b) {
  double first, second;
  std::memcpy(&first, x + 2 * std::size_t{a}, sizeof first);
  std::memcpy(&second, x + 2 * std::size_t{b}, sizeof second);
  return Two{first, second};
}

// The triangles from `first` on; the last one is repeated.
DARBOUX_INLINE Corners corners_of(const Triangles& x, std::size_t first) {
  Corners result;
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    std::array<Blocks, 4> p, n;
    std::array<Blocks, 2> uv;
#pragma GCC unroll 4
    for (int block = 0; block < blocks; ++block) {
      std::array<Index, 4> v;
#pragma GCC unroll 4
      for (int r = 0; r < 4; ++r) {
        const std::size_t triangle = first + static_cast<std::size_t>(4 * block + r);
        v[r] = x.vertices[3 * (triangle < x.count ? triangle : x.count - 1) + static_cast<std::size_t>(k)];
        p[r][block] = three_of(x.positions, v[r], x.last_vertex);
        n[r][block] = three_of(x.normals, v[r], x.last_vertex);
      }
      uv[0][block] = reinterpret_cast<Four>(pairs_of(x.uvs, v[0], v[1]));
      uv[1][block] = reinterpret_cast<Four>(pairs_of(x.uvs, v[2], v[3]));
    }
    const Rows places = turned({joined(p[0]), joined(p[1]), joined(p[2]), joined(p[3])}),
               normals = turned({joined(n[0]), joined(n[1]), joined(n[2]), joined(n[3])});
    result.p[k] = {places.a, places.b, places.c};
    result.n[k] = {normals.a, normals.b, normals.c};
    const Floats a = joined(uv[0]), b = joined(uv[1]);
    result.u[k] = mix<0, 2, 4, 6>(a, b);
    result.v[k] = mix<1, 3, 5, 7>(a, b);
  }
  return result;
}

template <int... block>
DARBOUX_INLINE std::array<Blocks, 4> blocks_of(const Rows& x, std::integer_sequence<int, block...>) {
  return {Blocks{block_of<block>(x.a)...}, Blocks{block_of<block>(x.b)...}, Blocks{block_of<block>(x.c)...},
          Blocks{block_of<block>(x.d)...}};
}
DARBOUX_INLINE std::array<Blocks, 4> blocks_of(const Rows& x) {
  return blocks_of(x, std::make_integer_sequence<int, blocks>{});
}

template <bool scaled>
bool differentiate_all(const Triangles& x) {
  const Floats quarter = Floats{} + 0.25F;  // so that differences do not overflow
  Mask any{};
  for (std::size_t first = 0; first < x.count; first += lanes) {
    Corners corners = corners_of(x, first);
    if (x.shrink_positions)
      for (Vectors& p : corners.p) p = quarter * p;
    if (x.shrink_uvs)
      for (int k = 0; k < 3; ++k)
        corners.u[k] = quarter * corners.u[k], corners.v[k] = quarter * corners.v[k];
    const Found found = find<scaled>(corners);
    any |= found.any;
    std::array<Floats, 3> angle;
    for (int k = 0; k < 3; ++k) angle[k] = arc_cosines(found.cosine[k], x.arc_cosine);
    const std::array<Blocks, 4> front = blocks_of(turned({found.s.x, found.s.y, found.s.z, found.t.x})),
                                back = blocks_of(turned({found.t.y, found.t.z, angle[0], angle[1]}));
    const std::size_t count = x.count - first < lanes ? x.count - first : lanes;
    for (std::size_t i = 0; i < count; ++i) {
      Directions& to = x.directions[first + i];
      store(&to, 0, front[i % 4][i / 4]);
      store(&to, sizeof(Four), back[i % 4][i / 4]);
      to.angle[2] = angle[2][i];
      x.orientation[first + i] = {found.preserves[i] != 0, found.any[i] != 0};
      if (x.lengths != nullptr) {
        const double unit = (x.shrink_positions ? 4.0 : 1.0) / (x.shrink_uvs ? 4.0 : 1.0) *
                            double{found.uv_scale[i]} / double{found.edge_scale[i]};
        x.lengths[first + i] = {static_cast<float>(unit * double{found.s_length[i]}),
                                static_cast<float>(unit * double{found.t_length[i]})};
      }
    }
  }
  std::int32_t some = 0;
  for (int i = 0; i < lanes; ++i) some |= any[i];
  return some != 0;
}
bool differentiate(const Triangles& x) {
  return x.scale ? differentiate_all<true>(x) : differentiate_all<false>(x);
}

// ---- corners at a vertex

// Alternates blocks of the directions s and t of four corners.
void find_parts(const Directions* directions, const Index* corners, std::size_t count, const float* normal,
                Part* parts) {
  const Floats zero{};
  const Vectors n{zero + normal[0], zero + normal[1], zero + normal[2]};
  constexpr int at_once = blocks > 1 ? blocks / 2 : 1;  // fours of corners
  for (std::size_t first = 0; first < count; first += 4 * at_once) {
    std::array<const Directions*, 4 * at_once> from;
    std::array<float, 4 * at_once> angle;
    for (std::size_t i = 0; i < 4 * at_once; ++i) {
      const Index at = corners[first + i < count ? first + i : count - 1];
      from[i] = directions + at / 3;
      angle[i] = from[i]->angle[at % 3];
    }
    for (int begin = 0; begin < 2 * at_once; begin += blocks) {  // of blocks
      std::array<Blocks, 4> x;
      Blocks angles;
#pragma GCC unroll 4
      for (int block = 0; block < blocks; ++block) {
        const auto four = static_cast<std::size_t>((begin + block) / 2 * 4);
        angles[block] = Four{angle[four], angle[four + 1], angle[four + 2], angle[four + 3]};
#pragma GCC unroll 4
        for (int r = 0; r < 4; ++r) {
          x[r][block] = load(from[four + static_cast<std::size_t>(r)],
                             (begin + block) % 2 == 0 ? offsetof(Directions, s) : offsetof(Directions, t));
        }
      }
      const Rows columns = turned({joined(x[0]), joined(x[1]), joined(x[2]), joined(x[3])});
      const Vectors part = across(n, {columns.a, columns.b, columns.c});
      const std::array<Blocks, 4> back = blocks_of(turned({part.x, part.y, part.z, joined(angles)}));
#pragma GCC unroll 4
      for (int block = 0; block < blocks; ++block)
#pragma GCC unroll 4
        for (int r = 0; r < 4; ++r) {
          Part& to = parts[first + static_cast<std::size_t>((begin + block) / 2 * 4 + r)];
          store(&to, (begin + block) % 2 == 0 ? offsetof(Part, s) : offsetof(Part, t), back[r][block]);
        }
    }
  }
}

void link(Ring* rings, std::size_t count) {
  constexpr std::size_t width = lanes;
  const Mask nobody = Mask{} - 1;
  for (Ring* ring = rings; ring != rings + count; ++ring)
    for (std::size_t begin = 0; begin < ring->count; begin += width) {
      Mask next, previous, after = nobody, before = nobody;
      std::memcpy(&next, &ring->next[begin], sizeof next);
      std::memcpy(&previous, &ring->previous[begin], sizeof previous);
      for (std::size_t i = 0; i < ring->count; ++i) {
        const Mask place = Mask{} + static_cast<std::int32_t>(i);
        after = next == Mask{} + static_cast<std::int32_t>(ring->previous[i]) ? place : after;
        before = previous == Mask{} + static_cast<std::int32_t>(ring->next[i]) ? place : before;
      }
      std::memcpy(&ring->after[begin], &after, sizeof after);
      std::memcpy(&ring->before[begin], &before, sizeof before);
    }
}

// Groups side by side, one corner of each at a time.
Vectors normals_of(const Groups& x, std::size_t first) {
  std::array<Blocks, 4> rows;
#pragma GCC unroll 16
  for (std::size_t i = 0; i < lanes; ++i)
    rows[i % 4][i / 4] =
        three_of(x.normals, x.groups[first + i < x.count ? first + i : x.count - 1].vertex, x.last_vertex);
  const Rows turned_rows = turned({joined(rows[0]), joined(rows[1]), joined(rows[2]), joined(rows[3])});
  return {turned_rows.a, turned_rows.b, turned_rows.c};
}
struct Parts {
  Vectors s, t;
  Floats angle;
};
// The parts of corner `place` of each group, or of its last corner.
DARBOUX_INLINE Parts parts_of(const Groups& x, std::size_t first, std::size_t place, const Vectors& n) {
  std::array<Blocks, 4> front, back;
  Blocks angles;
#pragma GCC unroll 16
  for (std::size_t i = 0; i < lanes; ++i) {
    const Group& group = x.groups[first + i < x.count ? first + i : x.count - 1];
    const Index at = group.corners[place < group.count ? place : group.count - 1];
    const Directions& from = x.directions[at / 3];
    front[i % 4][i / 4] = load(&from);
    back[i % 4][i / 4] = load(&from, sizeof(Four));
    angles[i / 4][i % 4] = from.angle[at % 3];
  }
  const Rows a = turned({joined(front[0]), joined(front[1]), joined(front[2]), joined(front[3])}),
             b = turned({joined(back[0]), joined(back[1]), joined(back[2]), joined(back[3])});
  return {across(n, {a.a, a.b, a.c}), across(n, {a.d, b.a, b.b}), joined(angles)};
}
void average(const Groups& x, Average* averages) {
  const Floats zero{}, one = zero + 1.0F;
  for (std::size_t first = 0; first < x.count; first += lanes) {
    const std::size_t count = x.count - first < lanes ? x.count - first : lanes;
    std::size_t most = 0;
    Mask counts{};
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t corners = x.groups[first + i].count;
      most = corners > most ? corners : most;
      counts[i] = static_cast<std::int32_t>(corners);
    }
    const Vectors n = normals_of(x, first);
    const Parts start = parts_of(x, first, 0, n);
    Vectors sum = start.angle * start.s;
    sum = {zero + sum.x, zero + sum.y, zero + sum.z};  // so that a zero is positive
    Mask near = Mask{} - 1;
    for (std::size_t place = 1; place < most; ++place) {
      const Parts part = parts_of(x, first, place, n);
      const Mask has = counts > static_cast<std::int32_t>(place);
      const Vectors add = part.angle * part.s;
      sum = select(has, {sum.x + add.x, sum.y + add.y, sum.z + add.z}, sum);
      near &= ~has | ((dot(part.s, start.s) > 0.1F) & (dot(part.t, start.t) > 0.1F));
    }
    const Vectors unit = normalised(sum);
    const std::array<Blocks, 4> rows = blocks_of(turned({unit.x, unit.y, unit.z, near ? one : zero}));
    for (std::size_t i = 0; i < count; ++i) store(averages + first + i, 0, rows[i % 4][i / 4]);
  }
}

#define DARBOUX_TABLE_(isa) mikktspace_table_##isa
#define DARBOUX_TABLE(isa) DARBOUX_TABLE_(isa)

}  // namespace
}  // namespace darboux::mikk

namespace darboux::kernels {
extern const mikk::LaneKernels DARBOUX_TABLE(DARBOUX_ISA);
constinit const mikk::LaneKernels DARBOUX_TABLE(DARBOUX_ISA){&mikk::differentiate, &mikk::find_parts,
                                                             &mikk::link, &mikk::average, &mikk::arc_cosines};
}  // namespace darboux::kernels
