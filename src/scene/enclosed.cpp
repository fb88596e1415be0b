#include "enclosed.h"

#include <cmath>
#include <limits>

#include <darboux/bilinear_patch.h>
#include <darboux/catenoid.h>
#include <darboux/ellipsoid.h>
#include <darboux/elliptic_paraboloid.h>
#include <darboux/enneper.h>
#include <darboux/graph.h>
#include <darboux/helicoid.h>
#include <darboux/hyperbolic_paraboloid.h>
#include <darboux/klein_bottle.h>
#include <darboux/moebius_strip.h>
#include <darboux/monkey_saddle.h>
#include <darboux/one_sheet_hyperboloid.h>
#include <darboux/point.h>
#include <darboux/pseudosphere.h>
#include <darboux/ruled_surface.h>
#include <darboux/torus.h>
#include <darboux/tube.h>
#include <darboux/two_sheet_hyperboloid.h>

#include "interval.h"

namespace darboux::tiles {
namespace {

using E = Enclosure;

constexpr double infinity = std::numeric_limits<double>::infinity();

std::array<Enclosed::Box, 6> boxes(const Jet2<E>& j) {
  const auto box = [](const Vec3<E>& a) {
    return Enclosed::Box{{a.x.lo, a.y.lo, a.z.lo}, {a.x.hi, a.y.hi, a.z.hi}};
  };
  return {box(j.position), box(j.dpdu), box(j.dpdv), box(j.d2pdu2), box(j.d2pduv), box(j.d2pdv2)};
}

Vec3<E> enclosure(const Enclosed::Box& box) {
  return {{box.lo.x, box.hi.x}, {box.lo.y, box.hi.y}, {box.lo.z, box.hi.z}};
}
Vec3<E> point(const Vec3<double>& a) {
  return {a.x, a.y, a.z};
}
E product(const Vec3<E>& a, const Vec3<E>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec3<E> cross_product(const Vec3<E>& a, const Vec3<E>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
E square(const E& a) {
  const E b = abs(a);
  return b * b;
}
E length(const Vec3<E>& a) {
  return sqrt(square(a.x) + square(a.y) + square(a.z));
}

// x over [-half, half]
E symmetric(double half) {
  return {-half, half};
}

enum { position, du, dv, duu, duv, dvv };

// dpdu × dpdv and its derivatives.
struct Normals {
  Vec3<E> n, n_u, n_v;
  explicit Normals(const std::array<Enclosed::Box, 6>& j)
      : n(cross_product(enclosure(j[du]), enclosure(j[dv]))),
        n_u(cross_product(enclosure(j[duu]), enclosure(j[dv])) +
            cross_product(enclosure(j[du]), enclosure(j[duv]))),
        n_v(cross_product(enclosure(j[duv]), enclosure(j[dv])) +
            cross_product(enclosure(j[du]), enclosure(j[dvv]))) {}
};

// ---- derivatives of unit vectors
// ---------------------------------------------------------------------------

double over(double a, double least) {
  return least > 0 ? (E(a) / E(least)).hi : infinity;
}
// The length of a vector: that of its enclosure, or a bound by other means.
double length_of(const Vec3<E>& enclosed, double bound) {
  const double a = length(enclosed).hi;
  return std::isnan(a) ? bound : std::fmin(a, bound);
}

// A derivative of n = N/s, s = |N|.
struct Slope {
  Vec3<E> N, n;            // N_a, n_a
  E s;                     // s_a
  double length, turning;  // |N_a|, |n_a|
};
struct UnitVector {
  Vec3<E> n;
  E s;
  Slope u, v;
  UnitVector(const Vec3<E>& N, const Vec3<E>& N_u, const Vec3<E>& N_v)
      : n(N / length(N)), s(length(N)), u(slope(N_u)), v(slope(N_v)) {}

  // From N_ab = s_ab n + s_a n_b + s_b n_a + s n_ab: the part of n_ab across n; along n it is -n_a·n_b.
  struct Second {
    Vec3<E> n;
    double across, length;  // of the part perpendicular to n, and of all
  };
  Second second(const Slope& a, const Slope& b, const Vec3<E>& N_ab) const {
    const Vec3<E> rest = N_ab - a.s * b.n - b.s * a.n, part = (rest - product(n, rest) * n) / s;
    const E bound = length(N_ab) + E(a.length) * E(b.turning) + E(b.length) * E(a.turning);
    const double across = length_of(part, over(bound.hi, s.lo));
    const E along = E(a.turning) * E(b.turning);
    return {part - product(a.n, b.n) * n, across, sqrt(along * along + E(across) * E(across)).hi};
  }

 private:
  Slope slope(const Vec3<E>& N_a) const {
    const E s_a = product(n, N_a);
    const Vec3<E> n_a = (N_a - s_a * n) / s;
    const double most = length(N_a).hi;
    return {N_a, n_a, s_a, most, length_of(n_a, over(most, s.lo))};
  }
};

// The second derivatives of n, t and b = n × t from the partials to third order.
struct ThirdPartials {
  Vec3<E> uuu, uuv, uvv, vvv;
};
TileRates second_rates(const std::array<Enclosed::Box, 6>& boxes, const ThirdPartials& third) {
  std::array<Vec3<E>, 6> p;
  for (std::size_t k = 0; k < 6; ++k) p[k] = enclosure(boxes[k]);
  const Normals normals(boxes);
  const UnitVector n(normals.n, normals.n_u, normals.n_v), t(p[du], p[duu], p[duv]);
  const auto x = [](const Vec3<E>& a, const Vec3<E>& b) { return cross_product(a, b); };
  const E two(2);
  const std::array n_second{
      n.second(n.u, n.u, x(third.uuu, p[dv]) + two * x(p[duu], p[duv]) + x(p[du], third.uuv)),
      n.second(n.u, n.v, x(third.uuv, p[dv]) + x(p[duu], p[dvv]) + x(p[du], third.uvv)),
      n.second(n.v, n.v, x(third.uvv, p[dv]) + two * x(p[duv], p[dvv]) + x(p[du], third.vvv))};
  const std::array t_second{t.second(t.u, t.u, third.uuu), t.second(t.u, t.v, third.uuv),
                            t.second(t.v, t.v, third.uvv)};
  const Vec3<E> b = x(n.n, t.n);
  const auto frame = [&](std::size_t k, const Slope& n_a, const Slope& n_b, const Slope& t_a,
                         const Slope& t_b) {
    const Vec3<E> b_ab = x(n_second[k].n, t.n) + x(n_a.n, t_b.n) + x(n_b.n, t_a.n) + x(n.n, t_second[k].n);
    const E bound = E(n_second[k].length) + E(t_second[k].length) + E(n_a.turning) * E(t_b.turning) +
                    E(n_b.turning) * E(t_a.turning);
    return std::fmax(std::fmax(n_second[k].across, t_second[k].across),
                     length_of(b_ab - product(b, b_ab) * b, bound.hi));
  };
  TileRates r;
  r.frame_uu = frame(0, n.u, n.u, t.u, t.u);
  r.frame_uv = frame(1, n.u, n.v, t.u, t.v);
  r.frame_vv = frame(2, n.v, n.v, t.v, t.v);
  r.normal_uu = n_second[0].across, r.normal_uv = n_second[1].across, r.normal_vv = n_second[2].across;
  return r;
}

// ---- running formulas
// --------------------------------------------------------------------------------------

template <class X>
Enclosed enclose_as(const X& surface, const Tile& t, TileOrder order) {
  const auto jet_over = [&](const auto& u, const auto& v) {
    return surface.jet(prepare<X::info.u>(u), prepare<X::info.v>(v));
  };
  const double u = 0.5 * (t.u0 + t.u1), v = 0.5 * (t.v0 + t.v1);
  // From the centre as it is rounded to either end.
  const double half_u = std::fmax(t.u1 - u, u - t.u0) * (1 + 0x1p-50),
               half_v = std::fmax(t.v1 - v, v - t.v0) * (1 + 0x1p-50);
  const E over_u(t.u0, t.u1), over_v(t.v0, t.v1);
  Enclosed result{boxes(jet_over(over_u, over_v)), boxes(jet_over(E(u), E(v))), half_u, half_v,
                  !X::info.own_orientation};
  if (order == TileOrder::second) {
    using D = Dual<E, 2>;
    const Jet2<D> j = jet_over(D::variable(over_u, 0), D::variable(over_v, 1));
    const auto along = [](const Vec3<D>& a, std::size_t k) {
      return Vec3<E>{a.x.derivative[k], a.y.derivative[k], a.z.derivative[k]};
    };
    result.rates = second_rates(
        result.over_tile, {along(j.d2pdu2, 0), along(j.d2pdu2, 1), along(j.d2pdv2, 0), along(j.d2pdv2, 1)});
  }
  return result;
}

// Of whichever type the surface is.
template <class... X>
std::optional<Enclosed> enclose_one_of(const AnySurface& surface, const Tile& tile, TileOrder order) {
  std::optional<Enclosed> result;
  const auto attempt = [&](const auto* s) {
    if (s) try {
        result = enclose_as(*s, tile, order);
      } catch (const Uncertain&) {
      }
  };
  (attempt(surface.get<X>()), ...);
  return result;
}

}  // namespace

std::optional<Enclosed> enclose(const AnySurface& surface, const Tile& tile, TileOrder order) {
  // Those without a closed form whose formulas run on intervals.
  return enclose_one_of<Torus<>, Ellipsoid<>, EllipticParaboloid<>, HyperbolicParaboloid<>,
                        OneSheetHyperboloid<>, TwoSheetHyperboloid<>, Helicoid<>, Catenoid<>, MoebiusStrip<>,
                        KleinBottle<>, Enneper<>, MonkeySaddle<>, Pseudosphere<>, Tube<>, BilinearPatch<>,
                        RuledSurface<>, Graph<>>(surface, tile, order);
}

double enclosed_support(const Enclosed& s, const Vec3<double>& direction) {
  const Vec3<E> d = point(direction);
  const auto along = [&](const Enclosed::Box& box) { return product(d, enclosure(box)); };
  // The mean value theorem from the centre: of second order, where the box alone is of first.
  const E from_centre = along(s.at_centre[position]) + along(s.over_tile[du]) * symmetric(s.half_u) +
                        along(s.over_tile[dv]) * symmetric(s.half_v);
  return std::fmin(from_centre.hi, along(s.over_tile[position]).hi);
}

double enclosed_facing(const Enclosed& s, const Vec3<double>& e, double offset) {
  if (!s.oriented) return infinity;
  // g = N·(e - P) for N = dpdu × dpdv, whose derivatives are N_u·(e - P) and N_v·(e - P): the rest is square
  // to N.
  const Vec3<E> eye = point(e);
  const auto seen_from = [&](const Enclosed::Box& p) { return offset == 0 ? eye : eye - enclosure(p); };
  const Normals over(s.over_tile), centre(s.at_centre);
  const Vec3<E> to_eye = seen_from(s.over_tile[position]);
  const E from_centre = product(centre.n, seen_from(s.at_centre[position])) +
                        product(over.n_u, to_eye) * symmetric(s.half_u) +
                        product(over.n_v, to_eye) * symmetric(s.half_v);
  const double g = std::fmin(from_centre.hi, product(over.n, to_eye).hi);
  const E size = length(over.n);
  return g < 0 ? g / size.hi : size.lo > 0 ? g / size.lo : infinity;
}

TileRates enclosed_rates(const Enclosed& s) {
  const auto size = [&](std::size_t k) { return length(enclosure(s.over_tile[k])).hi; };
  const Normals normals(s.over_tile);
  const double least_normal = length(normals.n).lo, least_du = length(enclosure(s.over_tile[du])).lo;
  TileRates r = s.rates;
  r.position_uu = size(duu), r.position_uv = size(duv), r.position_vv = size(dvv);
  r.normal_u = over(length(normals.n_u).hi, least_normal);
  r.normal_v = over(length(normals.n_v).hi, least_normal);
  // The frame turns by |ω|² = |t'|² + (n'·b)².
  const auto turning = [&](double t, double n) { return sqrt(E(t) * E(t) + E(n) * E(n)).hi; };
  r.frame_u = turning(over(r.position_uu, least_du), r.normal_u);
  r.frame_v = turning(over(r.position_uv, least_du), r.normal_v);
  return r;
}

}  // namespace darboux::tiles
