/// \file points_inside.h
/// Random points inside the triangles of a mesh of a surface, with the truth there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <darboux/mesh_classes.h>
#include <darboux/placed_surface.h>

namespace darboux::normal_map {

/// The surface's normal at a stored uv, in the mesh's space.
inline Vec3<double> normal_at(const PlacedSurface& surface, const Vec2<double>& stored) {
  const Vec2<double> p = surface.uv.surface_uv(stored);
  return from_eigen(surface.placement.linear() * to_eigen(surface.surface.frame(p.x, p.y).n));
}

/// The classes of the vertices of a mesh whose uvs lie on the surface.
inline MeshClasses classes_on(const PlacedSurface& surface, const Mesh& mesh) {
  std::vector<bool> poles;
  for (const Vec2<double>& stored : mesh.uvs) {
    const Vec2<double> p = surface.uv.surface_uv(stored);
    poles.push_back(has(surface.surface.frame(p.x, p.y).status,
                        Status::dpdu_zero | Status::dpdv_zero | Status::parallel));
  }
  return classify(mesh, poles);
}

struct PointInside {
  std::array<double, 3> weights;
  Vec2<double> uv;
  Vec3<double> normal;  ///< interpolated, not unit
  Vec3<double> truth;   ///< the surface's, unit
};

/// f(triangle, its lowest class) returns a function, which is called with each of `samples` points of that
/// triangle. Triangles without uv area are skipped. \param mesh with normals and uvs
template <class F>
void each_point_inside(const PlacedSurface& surface, const Mesh& mesh, int samples, std::uint64_t seed,
                       const F& f) {
  const MeshClasses classes = classes_on(surface, mesh);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& triangle = mesh.triangles[i];
    if (classes.island_of_triangle[i] < 0) continue;  // no texel is its own
    const VertexClass lowest = std::min(
        {classes.of_vertex[triangle[0]], classes.of_vertex[triangle[1]], classes.of_vertex[triangle[2]]});
    auto take = f(i, lowest);
    for (int s = 0; s < samples; ++s) {
      const double root = std::sqrt(uniform(random)), share = uniform(random);
      PointInside point{{1 - root, root * (1 - share), root * share}, {}, {}, {}};
      for (std::size_t k = 0; k < 3; ++k) {
        point.uv = point.uv + point.weights[k] * mesh.uvs[triangle[k]];
        point.normal += point.weights[k] * mesh.normals[triangle[k]];
      }
      point.truth = normal_at(surface, point.uv);
      take(point);
    }
  }
}

}  // namespace darboux::normal_map
