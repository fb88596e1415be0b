/// \file corner.h
/// Data that the methods need of a triangle, and of a frame that they found.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include <darboux/mesh_frames.h>

namespace darboux {

struct Face {
  std::array<Vec3<double>, 3> p;
  std::array<Vec2<double>, 3> uv;
  std::optional<TangentPair> solved;
  double sign;

  Face(const Mesh& mesh, const Triangle& triangle);
};

// A power of two that scales the largest coordinate below 1, so that areas and their inverses stay in range.
double scale_below_one(const Mesh& mesh);
std::array<Vec3<double>, 3> scaled(const std::array<Vec3<double>, 3>& p, double scale);

// The angle at a corner, and Max's weight there.
double corner_angle(const std::array<Vec3<double>, 3>& p, int corner);
double corner_max_weight(const std::array<Vec3<double>, 3>& p, int corner);
// Half the length of (p1 - p0) x (p2 - p0), and its direction; zero if there is none.
double triangle_area(const std::array<Vec3<double>, 3>& p);
Vec3<double> face_normal(const std::array<Vec3<double>, 3>& p);

// An arbitrary unit direction perpendicular to the unit vector n, made from the coordinate axis farthest from
// n.
Vec3<double> any_perpendicular(const Vec3<double>& n);
// The frame if no triangle gives one: an arbitrary direction perpendicular to n.
CornerFrame fallback_frame(const Vec3<double>& n, double sign);
// The frame that a method found, or the fallback if it is not finite or vanishes.
CornerFrame frame_or_fallback(const Vec3<double>& t, const Vec3<double>& b, const Vec3<double>& n,
                              double sign);

// Counts the triangle if it is degenerate. Counts is MeshFrames or MikktspaceCounts.
template <class Counts>
void count_degenerate(const std::array<Vec3<double>, 3>& p, const std::array<Vec2<double>, 3>& uv,
                      Counts& result) {
  if (is_degenerate(p[0], p[1], p[2]))
    ++result.degenerate_triangles;
  else if (is_degenerate(uv[0], uv[1], uv[2]))
    ++result.degenerate_uv_triangles;
}
void count_degenerate(const Face& face, MeshFrames& result);
void count_fallbacks(MeshFrames& result);

// The functions behind the list of methods.
MeshFrames compute_mikktspace(const Mesh& mesh, int threads);
MeshFrames compute_mikktspace_bitangent(const Mesh& mesh, int threads);
MeshFrames compute_face(const Mesh& mesh, int threads);
MeshFrames compute_average(const Mesh& mesh, int threads);
MeshFrames compute_unit(const Mesh& mesh, int threads);
MeshFrames compute_area(const Mesh& mesh, int threads);
MeshFrames compute_angle(const Mesh& mesh, int threads);
MeshFrames compute_max(const Mesh& mesh, int threads);
MeshFrames compute_fragment_gradient(const Mesh& mesh, int threads);
MeshFrames compute_fragment_solve(const Mesh& mesh, int threads);
MeshFrames compute_procrustes(const Mesh& mesh, int threads);
MeshFrames compute_quadratic(const Mesh& mesh, int threads);
MeshFrames compute_cubic(const Mesh& mesh, int threads);

}  // namespace darboux
