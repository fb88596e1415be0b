// Surfaces that adaptor.h makes of others, and how they come from them.
#pragma once

#include <array>
#include <ostream>
#include <string>
#include <vector>

#include <darboux/catalogue.h>
#include <darboux/offset.h>
#include <darboux/placed.h>
#include <darboux/reparametrised.h>
#include <darboux/testing.h>

#include "compare_frames.h"
#include "every_surface.h"

namespace darboux::test {

// The sign of det(dpdu, dpdv, n).
inline double det_sign(const Jet2<double>& j, const Vec3<double>& n) {
  return dot(cross(unit(j.dpdu), unit(j.dpdv)), n) < 0 ? -1 : 1;
}

using Linear = std::array<double, 9>;
// A rotation by 36.87 degrees about z after one by 90 about x, to the last bit; a non-uniform map; a mirror.
inline constexpr Linear rotation{0.6, 0, 0.8, 0.8, 0, -0.6, 0, 1, 0};
inline constexpr Linear uneven{2, 0.5, 0, -0.25, 1, 0.75, 0, 0.5, 0.5};
inline constexpr Linear mirror{-1, 0, 0, 0, 1, 0, 0, 0, 1};

// An adapted surface, and how it comes from its base: base (u, v) = map (u, v), P = A P_base + d A^-T n_base.
struct Adapted {
  std::string name;
  AnySurface surface, base;
  std::array<double, 6> map{1, 0, 0, 1, 0, 0};  // row by row, then the offset
  Linear A{1, 0, 0, 0, 1, 0, 0, 0, 1};
  double handedness = 1;  // times the base's
  double distance = 0;

  Vec2<double> at(double u, double v) const {
    return {map[0] * u + map[1] * v + map[4], map[2] * u + map[3] * v + map[5]};
  }
  Eigen::Matrix3d linear() const {
    Eigen::Matrix3d m;
    for (int k = 0; k < 9; ++k) m(k / 3, k % 3) = A[static_cast<std::size_t>(k)];
    return m;
  }
};

inline void PrintTo(const Adapted& x, std::ostream* out) {
  *out << x.name;
}

inline std::string identifier(std::string_view name) {
  std::string result(name);
  for (char& c : result)
    if (c == '-') c = '_';
  return result;
}

template <class X>
inline void add_charts(std::vector<Adapted>& all, const X& base) {
  const std::string name = identifier(X::info.name);
  const auto add = [&](const char* how, const Reparametrised<X>& surface, double sign) {
    const auto& [a, b, c, d] = surface.M;
    all.push_back({name + how,
                   surface,
                   base,
                   {a, b, c, d, surface.offset[0], surface.offset[1]},
                   {1, 0, 0, 0, 1, 0, 0, 0, 1},
                   sign});
  };
  add("_swapped", swapped(base), -1);
  add("_flipped_u", flipped_u(base), -1);
  add("_flipped_v", flipped_v(base), -1);
  add("_sub_rectangle", sub_rectangle(base, 0.125, 0.75, 0.25, 0.875), 1);
  add("_reversed_sub_rectangle", sub_rectangle(base, 0.75, 0.125, 0.25, 0.875), -1);
  add("_sheared", sheared(base, 0.75), 1);
}

template <class X>
inline void add_placed(std::vector<Adapted>& all, const X& base) {
  const std::string name = identifier(X::info.name);
  all.push_back(
      {name + "_rotated", Placed{base, rotation, {3, -2, 1}}, base, {1, 0, 0, 1, 0, 0}, rotation, 1});
  all.push_back({name + "_stretched", Placed{base, uneven, {1, 2, 3}}, base, {1, 0, 0, 1, 0, 0}, uneven, 1});
  all.push_back({name + "_mirrored", Placed{base, mirror, {0, 0, 0}}, base, {1, 0, 0, 1, 0, 0}, mirror, -1});
}

// \param d within the focal distances: the handedness is the base's
template <class X>
inline void add_offset(std::vector<Adapted>& all, const X& base, double d) {
  const std::string name = identifier(X::info.name);
  for (const double distance : {d, -d}) {
    all.push_back({name + (distance == d ? "_offset" : "_offset_back"), Offset{base, distance}, base});
    all.back().distance = distance;
  }
}

inline BezierPatch<double>
cap() {  // both edges along u collapsed, with horizontal tangent planes there; rational
  const Vec3<double> south{0, 0, -1}, north{0, 0, 1};
  return BezierPatch<double>(2, 3,
                             {south,
                              {1, 0, -1},
                              {1, 0, 1},
                              north,
                              south,
                              {0.75, 0.75, -1},
                              {0.75, 0.75, 1},
                              north,
                              south,
                              {0, 1, -1},
                              {0, 1, 1},
                              north},
                             {1, 0.75, 1, 1, 0.75, 0.5, 0.75, 0.75, 1, 0.75, 1, 1});
}
inline BezierPatch<double> fan() {  // its edge u = 0 collapsed, obliquely: dpdv vanishes there
  const Vec3<double> tip{0, 0, 0};
  return BezierPatch<double>(
      2, 2, {tip, tip, tip, {1, -0.5, 0}, {1, 0.25, 0}, {1, 0.75, 0}, {2, -1, 0.5}, {2, 0, 0}, {2, 1, 0.25}});
}

inline const std::vector<Adapted>& charts() {
  static const std::vector<Adapted> all = [] {
    std::vector<Adapted> list;
    add_charts(list, Sphere{2.0});
    add_charts(list, Torus{1.0, 0.25});
    add_charts(list, Cone{1.0, 2.0});
    add_charts(list, Ellipsoid{1.0, 0.7, 0.5});
    add_charts(list, MoebiusStrip{1.0, 0.5});
    add_charts(list, Enneper{1.0, 1.0});
    add_charts(list, BezierPatch<double>());
    return list;
  }();
  return all;
}
inline const std::vector<Adapted>& placements() {
  static const std::vector<Adapted> all = [] {
    std::vector<Adapted> list;
    add_placed(list, Sphere{2.0});
    add_placed(list, Torus{1.0, 0.25});
    add_placed(list, Cone{1.0, 2.0});
    add_placed(list, Ellipsoid{1.0, 0.7, 0.5});
    add_placed(list, Helicoid<double>());
    add_placed(list, KleinBottle<double>());
    add_placed(list, BezierPatch<double>());
    add_placed(list, BilinearPatch<double>());
    return list;
  }();
  return all;
}
inline const std::vector<Adapted>& offsets() {
  static const std::vector<Adapted> all = [] {
    std::vector<Adapted> list;
    add_offset(list, Sphere{2.0}, 0.5);
    add_offset(list, Torus{1.0, 0.25}, 0.125);
    add_offset(list, Ellipsoid{1.0, 0.7, 0.5}, 0.125);  // the least radius of curvature is 0.25
    add_offset(list, KleinBottle<double>(), 0.03125);
    add_offset(list, Cylinder{1.0, 2.0}, 0.5);
    add_offset(list, Catenoid<double>(), 0.25);
    add_offset(list, BezierPatch<double>(), 0.03125);
    return list;
  }();
  return all;
}
inline const std::vector<Adapted>& compositions() {
  static const std::vector<Adapted> all = [] {
    std::vector<Adapted> list;
    const Ellipsoid ellipsoid{1.0, 0.7, 0.5};
    const Torus torus{1.0, 0.25};
    list.push_back(
        {"offset_of_flipped", Offset{flipped_v(ellipsoid), 0.125}, ellipsoid, {1, 0, 0, -1, 0, 1}});
    list.back().handedness = -1;
    list.back().distance = 0.125;
    list.push_back({"offset_of_swapped_sheared",
                    Offset{swapped(sheared(torus, 0.5)), -0.125},
                    torus,
                    {0.5, 1, 1, 0, 0, 0}});
    list.back().handedness = -1;
    list.back().distance = -0.125;
    list.push_back({"placed_offset",
                    Placed{Offset{ellipsoid, 0.125}, mirror, {1, 2, 3}},
                    Offset{ellipsoid, 0.125},
                    {1, 0, 0, 1, 0, 0},
                    mirror,
                    -1});
    list.push_back({"placed_placed",
                    Placed{Placed{torus, uneven, {1, 0, 0}}, mirror, {0, 1, 0}},
                    Placed{torus, uneven, {1, 0, 0}},
                    {1, 0, 0, 1, 0, 0},
                    mirror,
                    -1});
    list.push_back(
        {"flipped_placed", flipped_u(Placed{torus, mirror, {0, 0, 0}}), torus, {-1, 0, 0, 1, 1, 0}, mirror});
    list.push_back({"offset_of_offset", Offset{Offset{torus, 0.0625}, 0.0625}, torus});
    list.back().distance = 0.125;
    return list;
  }();
  return all;
}
inline std::vector<Adapted> everything() {
  std::vector<Adapted> all;
  for (const auto* list : {&charts(), &placements(), &offsets(), &compositions()})
    all.insert(all.end(), list->begin(), list->end());
  return all;
}

#ifdef DARBOUX_SHORT_TESTS
inline constexpr int law_points = 10;
#else
inline constexpr int law_points = 50;
#endif

}  // namespace darboux::test
