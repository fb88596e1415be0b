/// \file random_meshes.h
/// Meshes like those that people have, some of them surfaces of the catalogue and some not: they test what
/// recognition claims.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include <darboux/any_surface.h>
#include <darboux/assess.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>
#include <darboux/vertex_normals.h>

#include "base/linear_algebra.h"
#include "random_pose.h"

namespace darboux::test {

inline double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
inline int integer(std::mt19937_64& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

// ---- polyhedra --------------------------------------------------------------------------------------------

struct Polyhedron {
  std::vector<Vec3<double>> points;
  std::vector<std::vector<int>> faces;  // counter-clockwise from outside
};

// By trying all triples: few points.
inline Polyhedron convex_hull(const std::vector<Vec3<double>>& points) {
  Polyhedron result{points, {}};
  const int n = static_cast<int>(points.size());
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      for (int k = j + 1; k < n; ++k) {
        const Vec3<double> m = cross(points[j] - points[i], points[k] - points[i]);
        if (norm(m) < 1e-12) continue;
        int above = 0, below = 0;
        bool first = true;  // of coplanar triples the one with the lowest numbers, fanned below
        std::vector<int> on;
        for (int l = 0; l < n; ++l) {
          const double side = dot(points[l] - points[i], m) / norm(m);
          if (side > 1e-9)
            ++above;
          else if (side < -1e-9)
            ++below;
          else
            on.push_back(l);
        }
        if (above > 0 && below > 0) continue;
        first = on[0] == i && on[1] == j && on[2] == k;
        if (!first) continue;
        const Vec3<double> out = above > 0 ? -1.0 * m : m, x = unit(points[on[1]] - points[on[0]]),
                           y = unit(cross(out, x));
        Vec3<double> middle{};
        for (const int l : on) middle = middle + (1.0 / static_cast<double>(on.size())) * points[l];
        std::sort(on.begin(), on.end(), [&](int a, int b) {
          const Vec3<double> p = points[a] - middle, q = points[b] - middle;
          return std::atan2(dot(p, y), dot(p, x)) < std::atan2(dot(q, y), dot(q, x));
        });
        result.faces.push_back(on);
      }
  return result;
}

inline Polyhedron platonic(std::mt19937_64& random) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3<double>> p;
  const auto signs = [&](double x, double y, double z) {
    for (const double a : {-1., 1.})
      for (const double b : {-1., 1.})
        for (const double c : {-1., 1.})
          if ((x != 0 || a > 0) && (y != 0 || b > 0) && (z != 0 || c > 0)) p.push_back({a * x, b * y, c * z});
  };
  switch (integer(random, 0, 4)) {
    case 0:
      p = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
      break;
    case 1:
      signs(1, 1, 1);
      break;
    case 2:
      signs(1, 0, 0), signs(0, 1, 0), signs(0, 0, 1);
      break;
    case 3:
      signs(0, 1, g), signs(1, g, 0), signs(g, 0, 1);
      break;
    default:
      signs(1, 1, 1), signs(0, 1 / g, g), signs(1 / g, g, 0), signs(g, 0, 1 / g);
  }
  if (integer(random, 0, 1) == 1)
    for (auto& q : p) q = {q.x, uniform(random, 0.999, 1) * q.y, q.z};
  const double y = integer(random, 0, 1) ? uniform(random, 0.3, 3) : 1,
               z = integer(random, 0, 1) ? uniform(random, 0.3, 3) : 1;
  for (auto& q : p) q = {q.x, y * q.y, z * q.z};
  return convex_hull(p);
}

inline Polyhedron random_hull(std::mt19937_64& random) {
  std::vector<Vec3<double>> p;
  for (int n = integer(random, 5, 18); n > 0;) {
    const Vec3<double> q{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
    if (dot(q, q) <= 1) p.push_back(q), --n;
  }
  return convex_hull(p);
}

// Rings of so many corners at radii and heights; each turned by `twist` against the one below. Caps where the
// last radii are not 0.
inline Polyhedron rings(int sides, const std::vector<std::array<double, 2>>& profile, double twist,
                        bool caps) {
  Polyhedron result;
  for (std::size_t k = 0; k < profile.size(); ++k)
    for (int i = 0; i < sides; ++i) {
      const double a = 2 * M_PI * (i + twist * static_cast<double>(k)) / sides;
      result.points.push_back({profile[k][0] * std::cos(a), profile[k][0] * std::sin(a), profile[k][1]});
    }
  for (std::size_t k = 0; k + 1 < profile.size(); ++k)
    for (int i = 0; i < sides; ++i) {
      const int at = static_cast<int>(k) * sides, a = at + i, b = at + (i + 1) % sides, c = a + sides,
                d = b + sides;
      if (twist == 0) {
        result.faces.push_back({a, b, d, c});
      } else {
        result.faces.push_back({a, b, c});
        result.faces.push_back({b, d, c});
      }
    }
  if (!caps) return result;
  std::vector<int> low, high;
  for (int i = 0; i < sides; ++i) {
    low.push_back(sides - 1 - i);
    high.push_back(static_cast<int>(profile.size() - 1) * sides + i);
  }
  result.faces.push_back(low);
  result.faces.push_back(high);
  return result;
}

inline Polyhedron prism(std::mt19937_64& random) {
  const int sides = integer(random, 3, 7);
  const double r = uniform(random, 0.2, 1), h = uniform(random, 0.2, 2), kind = integer(random, 0, 3);
  return rings(sides,
               {{r, 0},
                {kind == 2   ? 1e-3 * r
                 : kind == 3 ? r * uniform(random, 0.2, 0.9)
                             : r,
                 h}},
               kind == 1 ? 0.5 : 0, integer(random, 0, 1) == 1);
}

inline Polyhedron lathe(std::mt19937_64& random, int sides) {
  std::vector<std::array<double, 2>> profile;
  double z = 0;
  for (int n = integer(random, 4, 7); n > 0; --n)
    profile.push_back({uniform(random, 0.2, 1), z += uniform(random, 0.1, 0.6)});
  return rings(sides, profile, 0, integer(random, 0, 1) == 1);
}

inline Polyhedron bevelled_box(std::mt19937_64& random) {
  const Vec3<double> half{uniform(random, 0.3, 1), uniform(random, 0.3, 1), uniform(random, 0.3, 1)};
  const double b = uniform(random, 0.02, 0.25);
  const bool round = integer(random, 0, 1) == 1;
  std::vector<Vec3<double>> p;
  const double c = b * (1 - std::sqrt(0.5));
  for (const double x : {-1., 1.})
    for (const double y : {-1., 1.})
      for (const double z : {-1., 1.}) {
        const auto add = [&](double dx, double dy, double dz) {
          p.push_back({x * (half.x - dx), y * (half.y - dy), z * (half.z - dz)});
        };
        add(0, b, b), add(b, 0, b), add(b, b, 0);
        if (round) add(c, c, b), add(c, b, c), add(b, c, c);
      }
  return convex_hull(p);
}

inline Polyhedron extruded(std::mt19937_64& random) {
  const int n = integer(random, 4, 12);
  std::vector<std::array<double, 2>> outline;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * M_PI * i / n, r = uniform(random, 0.3, 1);
    outline.push_back({r * std::cos(a), r * std::sin(a)});
  }
  Polyhedron result;
  const double h = uniform(random, 0.1, 2);
  for (const double z : {0., h})
    for (const auto& q : outline) result.points.push_back({q[0], q[1], z});
  for (int i = 0; i < n; ++i) result.faces.push_back({i, (i + 1) % n, n + (i + 1) % n, n + i});
  result.points.push_back({0, 0, 0}), result.points.push_back({0, 0, h});
  for (int i = 0; i < n; ++i) {
    result.faces.push_back({2 * n, (i + 1) % n, i});
    result.faces.push_back({2 * n + 1, n + i, n + (i + 1) % n});
  }
  return result;
}

inline Polyhedron stairs(std::mt19937_64& random) {
  const int steps = integer(random, 2, 8);
  const double rise = uniform(random, 0.1, 0.5), run = uniform(random, 0.1, 0.5),
               width = uniform(random, 0.5, 2);
  Polyhedron result;
  for (int k = 0; k <= 2 * steps; ++k)
    for (const double y : {0., width}) result.points.push_back({run * ((k + 1) / 2), y, rise * (k / 2)});
  for (int k = 0; k < 2 * steps; ++k) result.faces.push_back({2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1});
  return result;
}

inline Polyhedron heightfield(std::mt19937_64& random) {
  const int n = integer(random, 3, 12);
  Polyhedron result;
  const double rough = uniform(random, 0.02, 0.3);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      result.points.push_back({1.0 * i / n, 1.0 * j / n, rough * uniform(random, -1, 1)});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      result.faces.push_back({a, a + 1, a + n + 2});
      result.faces.push_back({a, a + n + 2, a + n + 1});
    }
  return result;
}

// A ball with waves and noise: a low-poly animal.
inline Polyhedron blob(std::mt19937_64& random) {
  const Mesh ball = sample_mesh(make_surface("sphere"),
                                {.topology = MeshTopology::icosphere, .subdivisions = integer(random, 1, 5)});
  Polyhedron result;
  const double wave = uniform(random, 0.02, 0.4), noise = uniform(random, 0, 0.1);
  Vec3<double> k{uniform(random, 1, 4), uniform(random, 1, 4), uniform(random, 1, 4)};
  std::vector<int> of_vertex;
  for (const Vec3<double>& p : ball.positions) {
    const auto same = std::find_if(result.points.begin(), result.points.end(),
                                   [&](const Vec3<double>& q) { return norm(q - p) < 1e-9; });
    of_vertex.push_back(static_cast<int>(same - result.points.begin()));
    if (same == result.points.end()) result.points.push_back(p);
  }
  for (auto& p : result.points)
    p = (1 + wave * (std::sin(k.x * p.x + 1) + std::sin(k.y * p.y) * std::cos(k.z * p.z)) +
         noise * uniform(random, -1, 1)) *
        p;
  for (const Triangle& t : ball.triangles)
    result.faces.push_back({of_vertex[t[0]], of_vertex[t[1]], of_vertex[t[2]]});
  return result;
}

inline Polyhedron soup(std::mt19937_64& random) {
  Polyhedron result;
  const int triangles = integer(random, 1, 12);
  const bool strip = integer(random, 0, 1) == 1;
  for (int i = 0; i < (strip ? triangles + 2 : 3 * triangles); ++i)
    result.points.push_back({uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)});
  for (int i = 0; i < triangles; ++i)
    result.faces.push_back(strip ? (i % 2 ? std::vector{i + 1, i, i + 2} : std::vector{i, i + 1, i + 2})
                                 : std::vector{3 * i, 3 * i + 1, 3 * i + 2});
  return result;
}

enum class Normals { none, flat, averaged };
enum class Unwrap { none, by_face, by_box, random };

inline Mesh mesh_of(const Polyhedron& polyhedron, Normals normals, Unwrap unwrap, std::mt19937_64& random) {
  Mesh mesh;
  const bool split = normals == Normals::flat || unwrap == Unwrap::by_face;
  if (!split) mesh.positions = polyhedron.points;
  std::vector<Vec3<double>> averaged;
  Mesh shared;
  shared.positions = polyhedron.points;
  for (const auto& face : polyhedron.faces)
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      shared.triangles.push_back({static_cast<std::uint32_t>(face[0]), static_cast<std::uint32_t>(face[k]),
                                  static_cast<std::uint32_t>(face[k + 1])});
  if (normals == Normals::averaged) averaged = vertex_normals(shared, NormalWeight::angle);
  for (const auto& face : polyhedron.faces) {
    const Vec3<double>&o = polyhedron.points[face[0]], a = polyhedron.points[face[1]] - o,
          n = unit(cross(a, polyhedron.points[face[2]] - o)), x = unit(a), y = cross(n, x);
    const auto begin = static_cast<std::uint32_t>(mesh.positions.size());
    if (split)
      for (const int i : face) {
        mesh.positions.push_back(polyhedron.points[i]);
        if (normals == Normals::flat) mesh.normals.push_back(n);
        if (normals == Normals::averaged) mesh.normals.push_back(averaged[i]);
        if (unwrap == Unwrap::by_face)
          mesh.uvs.push_back({dot(polyhedron.points[i] - o, x), dot(polyhedron.points[i] - o, y)});
      }
    for (std::size_t k = 1; k + 1 < face.size(); ++k)
      mesh.triangles.push_back(split ? Triangle{begin, begin + static_cast<std::uint32_t>(k),
                                                begin + static_cast<std::uint32_t>(k) + 1}
                                     : Triangle{static_cast<std::uint32_t>(face[0]),
                                                static_cast<std::uint32_t>(face[k]),
                                                static_cast<std::uint32_t>(face[k + 1])});
  }
  if (!split && normals == Normals::averaged) mesh.normals = averaged;
  for (const Vec3<double>& p : mesh.positions)
    if (unwrap == Unwrap::by_box)
      mesh.uvs.push_back({p.x + 0.2 * p.z, p.y});
    else if (unwrap == Unwrap::random)
      mesh.uvs.push_back({uniform(random, 0, 1), uniform(random, 0, 1)});
  return mesh;
}

// ---- patches ----------------------------------------------------------------------------------------------

// A grid with uvs of its own, seen from where u runs to the right and v up. \param position of (u, v)
template <class Position>
void add_grid(Mesh& mesh, int columns, int rows, Position position) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size()),
             up = static_cast<std::uint32_t>(columns + 1);
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const double u = static_cast<double>(i) / columns, v = static_cast<double>(j) / rows;
      mesh.positions.push_back(position(u, v));
      mesh.uvs.push_back({u, v});
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const std::uint32_t a = first + static_cast<std::uint32_t>(j) * up + static_cast<std::uint32_t>(i);
      mesh.triangles.push_back({a, a + 1, a + 1 + up});
      mesh.triangles.push_back({a, a + 1 + up, a + up});
    }
}

inline Vec3<double> on_ring(double radius, double turn, double z) {
  const double angle = 2 * M_PI * (turn - std::floor(turn));
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

// A disk in rings, with a vertex in the middle for each of its sides, facing up or down.
inline void add_disk(Mesh& mesh, double radius, double z, int sides, int rings, bool up) {
  add_grid(mesh, sides, rings, [&](double u, double v) { return on_ring(radius * (1 - v), up ? u : -u, z); });
}

inline Mesh box_of_patches(const Vec3<double>& size, int n) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1., 1.})
      add_grid(mesh, n, n, [&](double u, double v) {
        const std::array<double, 3> at{0.5 * side, side * (u - 0.5), v - 0.5};
        const auto along = [&](int k) { return at[static_cast<std::size_t>((k - axis + 3) % 3)]; };
        return Vec3<double>{size.x * along(0), size.y * along(1), size.z * along(2)};
      });
  return mesh;
}

inline Mesh capped_cylinder(int sides, int rows, int rings, double height) {
  Mesh mesh;
  add_grid(mesh, sides, rows, [&](double u, double v) { return on_ring(1, u, height * v); });
  add_disk(mesh, 1, height, sides, rings, true);
  add_disk(mesh, 1, 0, sides, rings, false);
  return mesh;
}

inline void add_dome(Mesh& mesh, int sides, int rows) {
  add_grid(mesh, sides, rows, [&](double u, double v) {
    return on_ring(v == 1 ? 0 : std::cos(M_PI / 2 * v), u, std::sin(M_PI / 2 * v));
  });
}

// ---- ways to store one mesh -------------------------------------------------------------------------------

// For each vertex, the first one at its position.
inline std::vector<std::uint32_t> places_of(const Mesh& mesh) {
  std::map<std::array<long long, 3>, std::uint32_t> first;
  std::vector<std::uint32_t> result;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3<double>& p = mesh.positions[v];
    const auto step = [](double x) { return std::llround(x * 1e9); };
    result.push_back(first.try_emplace({step(p.x), step(p.y), step(p.z)}, v).first->second);
  }
  return result;
}

// With the normals of a mesh that has one vertex at each position, weighted by angle unless told otherwise:
// shaded smooth.
inline Mesh with_averaged_normals(Mesh mesh, NormalWeight weight = NormalWeight::angle) {
  const std::vector<std::uint32_t> place = places_of(mesh);
  Mesh joined;
  joined.positions = mesh.positions;
  for (const auto& [a, b, c] : mesh.triangles)
    if (place[a] != place[b] && place[b] != place[c] && place[c] != place[a])
      joined.triangles.push_back({place[a], place[b], place[c]});
  const std::vector<Vec3<double>> normals = vertex_normals(joined, weight);
  mesh.normals.clear();
  for (const std::uint32_t v : place) mesh.normals.push_back(normals[v]);
  return mesh;
}

// One vertex at each position, without uvs; triangles without area are left out.
inline Mesh welded(const Mesh& mesh) {
  const std::vector<std::uint32_t> place = places_of(mesh);
  std::vector<std::uint32_t> number(mesh.positions.size(), 0);
  Mesh result;
  for (std::uint32_t v = 0; v < place.size(); ++v) {
    if (place[v] != v) continue;
    number[v] = static_cast<std::uint32_t>(result.positions.size());
    result.positions.push_back(mesh.positions[v]);
    if (!mesh.normals.empty()) result.normals.push_back(mesh.normals[v]);
  }
  for (const auto& [a, b, c] : mesh.triangles)
    if (place[a] != place[b] && place[b] != place[c] && place[c] != place[a])
      result.triangles.push_back({number[place[a]], number[place[b]], number[place[c]]});
  return result;
}

inline Mesh one_vertex_per_corner(const Mesh& mesh) {
  Mesh soup;
  soup.half_steps = mesh.half_steps;
  const auto take = [](const auto& from, auto& to, std::uint32_t v) {
    if (!from.empty()) to.push_back(from[v]);
  };
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    soup.triangles.push_back({first, first + 1, first + 2});
    for (const std::uint32_t v : t) {
      take(mesh.positions, soup.positions, v), take(mesh.normals, soup.normals, v);
      take(mesh.uvs, soup.uvs, v), take(mesh.tangents, soup.tangents, v);
    }
  }
  return soup;
}

// MikkTSpace's tangents, with glTF's sign; vertices are shared as they are.
inline void bake(Mesh& mesh) {
  const MeshFrames frames = mesh_frames(mesh, find_frame_method("mikktspace"));
  mesh.tangents.assign(mesh.positions.size(), {1, 0, 0, 1});
  for (std::size_t c = 0; c < mesh.corners(); ++c) {
    const CornerFrame& f = frames.corner(c);
    if (!f.fallback) mesh.tangents[mesh.triangles[c / 3][c % 3]] = {f.t.x, f.t.y, f.t.z, -f.sign};
  }
}

inline void round_to_floats(Mesh& mesh) {
  const auto f = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  for (auto& p : mesh.positions) p = {f(p.x), f(p.y), f(p.z)};
  for (auto& n : mesh.normals) n = {f(n.x), f(n.y), f(n.z)};
  for (auto& uv : mesh.uvs) uv = {f(uv.x), f(uv.y)};
  for (auto& t : mesh.tangents) t = {f(t.x), f(t.y), f(t.z), t.w};
}

struct NegativeFamily {
  std::string_view name;
  std::function<Polyhedron(std::mt19937_64&)> make;
  std::string_view allowed;  // kinds beside planes that a part of it may really be
  std::function<Mesh(std::mt19937_64&)> make_mesh = {};  // or the whole mesh, with its normals and uvs
};

// A solid of patches, shaded smooth, as vertices split by uvs, welded, or one per corner; every other time
// with MikkTSpace's tangents.
inline Mesh smooth_solid(Mesh patches, std::mt19937_64& random) {
  Mesh mesh = with_averaged_normals(std::move(patches));
  const int stored = integer(random, 0, 2);
  if (stored == 1) return welded(mesh);
  if (integer(random, 0, 1) == 1) bake(mesh);
  return stored == 2 ? one_vertex_per_corner(mesh) : mesh;
}

inline Mesh smooth_box(std::mt19937_64& random) {
  const Vec3<double> size{uniform(random, 0.2, 2), uniform(random, 0.2, 2), uniform(random, 0.02, 2)};
  return smooth_solid(box_of_patches(size, integer(random, 1, 24)), random);
}
inline Mesh smooth_coin(std::mt19937_64& random) {
  return smooth_solid(capped_cylinder(integer(random, 24, 48), integer(random, 1, 3), integer(random, 1, 6),
                                      uniform(random, 0.03, 0.3)),
                      random);
}
inline Mesh smooth_cylinder(std::mt19937_64& random) {
  return smooth_solid(capped_cylinder(integer(random, 8, 32), integer(random, 1, 12), integer(random, 1, 4),
                                      uniform(random, 0.5, 4)),
                      random);
}
inline Mesh smooth_hemisphere(std::mt19937_64& random) {
  Mesh mesh;
  const int sides = integer(random, 12, 32);
  add_dome(mesh, sides, integer(random, 4, 12));
  add_disk(mesh, 1, 0, sides, integer(random, 1, 4), false);
  return smooth_solid(std::move(mesh), random);
}

inline const std::vector<NegativeFamily>& negative_families() {
  static const std::vector<NegativeFamily> list{
      {"platonic solids, stretched", platonic, ""},
      {"convex hulls of random points", random_hull, ""},
      {"prisms, antiprisms, pyramids, frusta of 3 to 7 sides", prism, ""},
      {"lathes of 3 to 7 sides", [](std::mt19937_64& r) { return lathe(r, integer(r, 3, 7)); }, ""},
      {"lathes of 8 to 16 sides", [](std::mt19937_64& r) { return lathe(r, integer(r, 8, 16)); },
       "cone cylinder"},
      {"bevelled boxes", bevelled_box, ""},
      {"extruded polygons", extruded, ""},
      {"stairs", stairs, ""},
      {"heightfields", heightfield, ""},
      {"low-poly blobs", blob, ""},
      {"triangle soups and strips", soup, ""},
      {"smooth boxes", {}, "", smooth_box},
      {"smooth coins", {}, "cylinder", smooth_coin},
      {"smooth capped cylinders", {}, "cylinder", smooth_cylinder},
      {"smooth hemispheres", {}, "sphere ellipsoid", smooth_hemisphere},
  };
  return list;
}

// One of the family, by its seed.
inline Mesh negative(const NegativeFamily& family, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Mesh mesh;
  if (family.make_mesh) {
    mesh = family.make_mesh(random);
  } else {
    const Polyhedron polyhedron = family.make(random);
    const auto normals = static_cast<Normals>(integer(random, 0, 2));
    mesh = mesh_of(polyhedron, normals, static_cast<Unwrap>(integer(random, 0, 3)), random);
  }
  const double size = std::pow(10, uniform(random, -3, 3));
  for (auto& p : mesh.positions) p = size * p;
  darboux::place(mesh, random_pose(random, size * uniform(random, 0, 3)));
  round_to_floats(mesh);
  return mesh;
}

// Whether all vertices of the assessment's triangles lie in one plane, within a thousandth of their extent.
inline bool is_flat(const Mesh& mesh, const Assessment& assessment) {
  std::vector<Vec3<double>> points;
  const auto take = [&](const Triangle& t) {
    for (const std::uint32_t v : t) points.push_back(mesh.positions[v]);
  };
  if (assessment.triangles.empty())
    for (const Triangle& t : mesh.triangles) take(t);
  for (const std::uint32_t t : assessment.triangles) take(mesh.triangles[t]);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Vec3<double>& p : points) middle += to_eigen(p) / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  double size = 0;
  for (const Vec3<double>& p : points) {
    const Eigen::Vector3d d = to_eigen(p) - middle;
    spread += d * d.transpose();
    size = std::fmax(size, d.norm());
  }
  const Eigen::Vector3d normal = symmetric_eigen(spread).vectors.col(0);
  return std::ranges::all_of(points, [&](const Vec3<double>& p) {
    return std::fabs((to_eigen(p) - middle).dot(normal)) <= 1e-3 * size;
  });
}

// The first kind that is claimed and wrong, a plane where the part is not flat; "fail" where the mesh, which
// is correct, is called wrong; empty where nothing is.
inline std::string false_claim(const NegativeFamily& family, const Mesh& mesh) {
  for (const Assessment& j : assess_parts(mesh)) {
    if (family.make_mesh && j.report.verdict == Verdict::fail) return "fail";
    if (!j.fit || !j.fit->fits) continue;
    const std::string kind(j.fit->surface.surface.info().name);
    const bool right = kind == "plane" || kind == "disk"
                           ? is_flat(mesh, j)
                           : family.allowed.find(kind) != std::string_view::npos;
    if (!right) return kind;
  }
  return "";
}

// ---- surfaces ---------------------------------------------------------------------------------------------

enum class Storage { single, half, int16 };
inline constexpr std::array<std::string_view, 3> storage_names{"float32", "float16", "int16"};

struct PositiveFamily {
  std::string_view name, kind;
  std::function<Mesh(std::mt19937_64&)> make;
};

inline const std::vector<PositiveFamily>& positive_families() {
  const auto grid = [](const std::string& surface, int columns, int rows) {
    return sample_mesh(make_surface(surface), {.columns = columns, .rows = rows});
  };
  static const std::vector<PositiveFamily> list{
      {"spheres, 8x6", "sphere", [=](std::mt19937_64&) { return grid("sphere", 8, 6); }},
      {"spheres, 12x8 to 32x16", "sphere",
       [=](std::mt19937_64& r) {
         const int n = integer(r, 6, 16);
         return grid("sphere", 2 * n, n);
       }},
      {"cylinders, 8x1", "cylinder",
       [=](std::mt19937_64& r) {
         return grid("cylinder:height=" + std::to_string(uniform(r, 0.3, 4)), 8, 1);
       }},
      {"cylinders, 8 to 32 sides, 1 to 8 rows", "cylinder",
       [=](std::mt19937_64& r) {
         return grid("cylinder:height=" + std::to_string(uniform(r, 0.3, 4)), integer(r, 8, 32),
                     integer(r, 1, 8));
       }},
      {"tori, 12x8", "torus",
       [=](std::mt19937_64& r) {
         return grid("torus:minor_radius=" + std::to_string(uniform(r, 0.15, 0.7)), 12, 8);
       }},
      {"tori, 16x8 to 48x24", "torus",
       [=](std::mt19937_64& r) {
         const int n = integer(r, 8, 24);
         return grid("torus:minor_radius=" + std::to_string(uniform(r, 0.15, 0.7)), 2 * n, n);
       }},
      {"cones, 8x1", "cone",
       [=](std::mt19937_64& r) { return grid("cone:height=" + std::to_string(uniform(r, 0.5, 3)), 8, 1); }},
      {"cones, 8 to 32 sides, 1 to 8 rows", "cone",
       [=](std::mt19937_64& r) {
         return grid("cone:height=" + std::to_string(uniform(r, 0.5, 3)), integer(r, 8, 32),
                     integer(r, 1, 8));
       }},
      {"ellipsoids, 12x8", "ellipsoid",
       [=](std::mt19937_64& r) {
         return grid("ellipsoid:semi_axis_y=" + std::to_string(uniform(r, 0.5, 0.9)) +
                         ",semi_axis_z=" + std::to_string(uniform(r, 0.5, 0.9)),
                     12, 8);
       }},
      {"ellipsoids, 16x8 to 48x24", "ellipsoid",
       [=](std::mt19937_64& r) {
         const int n = integer(r, 8, 24);
         return grid("ellipsoid:semi_axis_y=" + std::to_string(uniform(r, 0.5, 0.9)) +
                         ",semi_axis_z=" + std::to_string(uniform(r, 0.5, 0.9)),
                     2 * n, n);
       }},
  };
  return list;
}

inline double to_half(double x) {
  if (x == 0) return 0;
  int exponent;
  const double m = std::frexp(x, &exponent);
  exponent = std::max(exponent, -13);
  return std::ldexp(std::nearbyint(std::ldexp(x, 11 - exponent)), exponent - 11) + 0 * m;
}

inline Mesh positive(const PositiveFamily& family, Storage storage, bool uvs, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Mesh mesh = family.make(random);
  mesh.tangents.clear();
  if (!uvs) mesh.uvs.clear();
  darboux::place(mesh, random_pose(random, 0));
  const double size = std::pow(10, uniform(random, -2, 2));
  for (auto& p : mesh.positions) p = size * p;
  double largest = 0;
  for (const auto& p : mesh.positions)
    largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  const double step = largest / 32767;
  const auto stored = [&](double x) {
    return storage == Storage::half    ? to_half(x)
           : storage == Storage::int16 ? step * std::nearbyint(x / step)
                                       : x;
  };
  for (auto& p : mesh.positions) p = {stored(p.x), stored(p.y), stored(p.z)};
  if (storage == Storage::int16) mesh.half_steps.position = step / 2;
  round_to_floats(mesh);
  return mesh;
}

inline bool is_recognised(const PositiveFamily& family, const Mesh& mesh) {
  const std::vector<Assessment> assessments = assess_parts(mesh);
  return assessments.size() == 1 && assessments[0].fit && assessments[0].fit->fits &&
         assessments[0].fit->surface.surface.info().name == family.kind;
}

}  // namespace darboux::test
