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

std::array<Enclosed::Box, 6> boxes(const Jet2<E>& j) {
  const auto box = [](const Vec3<E>& a) {
    return Enclosed::Box{{a.x.lo, a.y.lo, a.z.lo}, {a.x.hi, a.y.hi, a.z.hi}};
  };
  return {box(j.position), box(j.dpdu), box(j.dpdv), box(j.d2pdu2), box(j.d2pduv), box(j.d2pdv2)};
}

template <class X>
Enclosed enclose_as(const X& surface, const Tile& t) {
  const auto jet_over = [&](const E& u, const E& v) {
    return boxes(surface.jet(prepare<X::info.u>(u), prepare<X::info.v>(v)));
  };
  const double u = 0.5 * (t.u0 + t.u1), v = 0.5 * (t.v0 + t.v1);
  // From the centre as it is rounded to either end.
  const double half_u = std::fmax(t.u1 - u, u - t.u0) * (1 + 0x1p-50),
               half_v = std::fmax(t.v1 - v, v - t.v0) * (1 + 0x1p-50);
  return {jet_over({t.u0, t.u1}, {t.v0, t.v1}), jet_over(u, v), half_u, half_v, !X::info.own_orientation};
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

// Of whichever type the surface is.
template <class... X>
std::optional<Enclosed> enclose_one_of(const AnySurface& surface, const Tile& tile) {
  std::optional<Enclosed> result;
  const auto attempt = [&](const auto* s) {
    if (s) try {
        result = enclose_as(*s, tile);
      } catch (const Uncertain&) {
      }
  };
  (attempt(surface.get<X>()), ...);
  return result;
}

}  // namespace

std::optional<Enclosed> enclose(const AnySurface& surface, const Tile& tile) {
  // Those without a closed form whose formulas run on intervals.
  return enclose_one_of<Torus<>, Ellipsoid<>, EllipticParaboloid<>, HyperbolicParaboloid<>,
                        OneSheetHyperboloid<>, TwoSheetHyperboloid<>, Helicoid<>, Catenoid<>, MoebiusStrip<>,
                        KleinBottle<>, Enneper<>, MonkeySaddle<>, Pseudosphere<>, Tube<>, BilinearPatch<>,
                        RuledSurface<>, Graph<>>(surface, tile);
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
  constexpr double infinity = std::numeric_limits<double>::infinity();
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

Rates enclosed_rates(const Enclosed& s) {
  const auto size = [&](std::size_t k) { return length(enclosure(s.over_tile[k])); };
  const Normals normals(s.over_tile);
  const double least_normal = length(normals.n).lo, least_du = size(du).lo;
  const auto over = [](const E& a, double least) {
    return least > 0 ? a.hi / least : std::numeric_limits<double>::infinity();
  };
  const double normal_u = over(length(normals.n_u), least_normal),
               normal_v = over(length(normals.n_v), least_normal);
  // t turns by at most |d²P| / |dpdu|, and the rest of the frame about t by at most |dn|.
  return {size(duu).hi,
          size(duv).hi,
          size(dvv).hi,
          normal_u,
          normal_v,
          normal_u + over(size(duu), least_du),
          normal_v + over(size(duv), least_du)};
}

}  // namespace darboux::tiles
