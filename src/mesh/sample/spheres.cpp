#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "chart_mesh.h"

namespace darboux {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double steps = 0x1p23;  // of u and v in [0, 1]: a float holds u up to 2 so

struct ChartPoint {
  double u, v;
  bool pole;
};

// The (u, v) of a direction.
ChartPoint chart_point(const Vec3<double>& p) {
  const double across = std::hypot(p.x, p.y);
  const double v = std::nearbyint(std::atan2(across, -p.z) / pi * steps) / steps;
  double u = std::nearbyint(std::atan2(p.y, p.x) / (2 * pi) * steps) / steps;
  u += u < 0 ? 1 : 0;  // and -0 becomes 0
  return {u, v, across == 0};
}

// Collects triangles given by directions, each counter-clockwise seen from outside.
class SphereBuilder {
 public:
  explicit SphereBuilder(const AnySurface& surface) : surface_(surface) {}

  void add(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
    std::array<ChartPoint, 3> p{chart_point(a), chart_point(b), chart_point(c)};
    // Across the seam, vertices beyond it continue at u > 1.
    double greatest = 0;
    for (const ChartPoint& x : p)
      if (!x.pole) greatest = std::max(greatest, x.u);
    for (ChartPoint& x : p)
      if (!x.pole && greatest - x.u > 0.5) x.u += 1;
    for (int k = 0; k < 3; ++k)
      if (p[k].pole) p[k].u = std::nearbyint((p[(k + 1) % 3].u + p[(k + 2) % 3].u) / 2 * steps) / steps;
    const Vec2<double> centre{(p[0].u + p[1].u + p[2].u) / 3, (p[0].v + p[1].v + p[2].v) / 3};
    if (turned_over(surface_, centre)) std::swap(p[1], p[2]);
    Triangle triangle;
    for (int k = 0; k < 3; ++k) triangle[k] = vertex({p[k].u, p[k].v});
    mesh_.triangles.push_back(triangle);
  }

  ChartMesh take() { return std::move(mesh_); }

 private:
  std::uint32_t vertex(const Vec2<double>& uv) {
    const auto key =
        static_cast<std::uint64_t>(uv.x * steps) << 32 | static_cast<std::uint64_t>(uv.y * steps);
    const auto next = static_cast<std::uint32_t>(mesh_.vertices.size());
    const auto [known, fresh] = index_.try_emplace(key, next);
    if (fresh) mesh_.vertices.push_back({uv});
    return known->second;
  }

  const AnySurface& surface_;
  ChartMesh mesh_;
  std::unordered_map<std::uint64_t, std::uint32_t> index_;
};

// 0 and 11 at the poles, two rings of five at z = ∓1/sqrt(5), the upper one turned by a tenth.
std::array<Vec3<double>, 12> icosahedron_corners() {
  std::array<Vec3<double>, 12> corners;
  corners[0] = {0, 0, -1};
  corners[11] = {0, 0, 1};
  const double z = 1 / std::sqrt(5.0);
  for (int k = 0; k < 5; ++k) {
    const double lower = 2 * pi * k / 5, upper = 2 * pi * (k + 0.5) / 5;
    corners[1 + k] = {2 * z * std::cos(lower), 2 * z * std::sin(lower), -z};
    corners[6 + k] = {2 * z * std::cos(upper), 2 * z * std::sin(upper), z};
  }
  return corners;
}

void add_icosahedron(SphereBuilder& builder, int n) {
  const std::array<Vec3<double>, 12> corners = icosahedron_corners();
  const auto add_face = [&](std::array<int, 3> corner) {
    // The point i and j steps from corner 0 towards corners 1 and 2; corners are added in the same order on
    // every face.
    const auto point = [&](int i, int j) {
      std::array<std::pair<int, int>, 3> weighted{{{corner[0], n - i - j}, {corner[1], i}, {corner[2], j}}};
      std::sort(weighted.begin(), weighted.end());
      Vec3<double> sum{};
      for (const auto& [k, weight] : weighted)
        if (weight > 0) sum += static_cast<double>(weight) * corners[k];
      return sum;
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        builder.add(point(i, j), point(i + 1, j), point(i, j + 1));
        if (i + j + 1 < n) builder.add(point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
      }
  };
  for (int k = 0; k < 5; ++k) {
    const int lower = 1 + k, lower_next = 1 + (k + 1) % 5, upper = 6 + k, upper_next = 6 + (k + 1) % 5;
    add_face({0, lower_next, lower});
    add_face({lower, lower_next, upper});
    add_face({lower_next, upper_next, upper});
    add_face({upper, upper_next, 11});
  }
}

void add_cube(SphereBuilder& builder, int n) {
  // Equal angles seen from the centre; odd in the step, so that edges of two faces agree.
  const auto coordinate = [n](int step) { return std::tan(pi / 4 * step / n); };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      const auto point = [&](int i, int j) {
        std::array<double, 3> p;
        p[axis] = side * coordinate(n);
        p[(axis + 1) % 3] = side * coordinate(2 * i - n);
        p[(axis + 2) % 3] = coordinate(2 * j - n);
        return Vec3<double>{p[0], p[1], p[2]};
      };
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          builder.add(point(i, j), point(i + 1, j), point(i, j + 1));
          builder.add(point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
        }
    }
}

}  // namespace

ChartMesh sphere_mesh(const AnySurface& surface, const SampleMeshOptions& o) {
  SphereBuilder builder(surface);
  if (o.topology == MeshTopology::icosphere)
    add_icosahedron(builder, o.subdivisions);
  else
    add_cube(builder, o.subdivisions);
  return builder.take();
}

}  // namespace darboux
