#include "adapted.h"

#include <string_view>

namespace darboux::test {
namespace {

std::string identifier(std::string_view name) {
  std::string result(name);
  for (char& c : result)
    if (c == '-') c = '_';
  return result;
}

template <class X>
void add_charts(std::vector<Adapted>& all, const X& base) {
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
void add_placed(std::vector<Adapted>& all, const X& base) {
  const std::string name = identifier(X::info.name);
  all.push_back(
      {name + "_rotated", Placed{base, rotation, {3, -2, 1}}, base, {1, 0, 0, 1, 0, 0}, rotation, 1});
  all.push_back({name + "_stretched", Placed{base, uneven, {1, 2, 3}}, base, {1, 0, 0, 1, 0, 0}, uneven, 1});
  all.push_back({name + "_mirrored", Placed{base, mirror, {0, 0, 0}}, base, {1, 0, 0, 1, 0, 0}, mirror, -1});
}

// \param d within the focal distances: the handedness is the base's
template <class X>
void add_offset(std::vector<Adapted>& all, const X& base, double d) {
  const std::string name = identifier(X::info.name);
  for (const double distance : {d, -d}) {
    all.push_back({name + (distance == d ? "_offset" : "_offset_back"), Offset{base, distance}, base});
    all.back().distance = distance;
  }
}

const std::vector<Adapted>& charts() {
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
const std::vector<Adapted>& placements() {
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
const std::vector<Adapted>& offsets() {
  static const std::vector<Adapted> all = [] {
    std::vector<Adapted> list;
    add_offset(list, Sphere{2.0}, 0.5);
    add_offset(list, Torus{1.0, 0.25}, 0.125);
    add_offset(list, Ellipsoid{1.0, 0.7, 0.5}, 0.125);  // the least radius of curvature is 0.25
    add_offset(list, MoebiusStrip{1.0, 0.5}, 0.03125);  // has one side; a closed one takes half a minute
    add_offset(list, Cylinder{1.0, 2.0}, 0.5);
    add_offset(list, Catenoid<double>(), 0.25);
    add_offset(list, BezierPatch<double>(), 0.03125);
    return list;
  }();
  return all;
}
const std::vector<Adapted>& compositions() {
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
}  // namespace

std::vector<Adapted> every_adapted() {
  std::vector<Adapted> all;
  for (const auto* list : {&charts(), &placements(), &offsets(), &compositions()})
    all.insert(all.end(), list->begin(), list->end());
  return all;
}

}  // namespace darboux::test
