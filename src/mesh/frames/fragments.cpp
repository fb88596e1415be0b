#include <Eigen/LU>

#include <darboux/fragments.h>
#include <darboux/frame.h>

#include "corner.h"

namespace darboux {

std::optional<TangentPair> fragment_gradients(const std::array<Vec3<double>, 3>& p,
                                              const std::array<Vec2<double>, 3>& uv, const Vec3<double>& n) {
  // Rows have length 1, so that singular means parallel, whatever the size of the triangle.
  const Vec3<double> e1 = p[1] - p[0], e2 = p[2] - p[0];
  const double l1 = norm(e1), l2 = norm(e2);
  Eigen::Matrix3d a;
  a << to_eigen(unit(e1)), to_eigen(unit(e2)), to_eigen(unit(n));
  a.transposeInPlace();
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(a);
  if (!lu.isInvertible()) return std::nullopt;
  const Eigen::Vector3d i = lu.solve(Eigen::Vector3d((uv[1].x - uv[0].x) / l1, (uv[2].x - uv[0].x) / l2, 0));
  const Eigen::Vector3d j = lu.solve(Eigen::Vector3d((uv[1].y - uv[0].y) / l1, (uv[2].y - uv[0].y) / l2, 0));
  return TangentPair{from_eigen(i), from_eigen(j)};
}

namespace {

// The direction of the remainder of unit vectors; zero if only rounding remains, as in gram_schmidt.
Vec3<double> direction(const Vec3<double>& rest) {
  constexpr double nothing_below = 16 * 0x1p-53;
  return norm(rest) > nothing_below ? unit(rest) : Vec3<double>{};
}

Vec3<double> across(const Vec3<double>& n, const Vec3<double>& unit_t) {
  return direction(unit_t - dot(n, unit_t) * n);
}

}  // namespace

CornerFrame fragment_frame(FragmentForm form, const TriangleFrames& triangle,
                           const std::array<double, 3>& weights) {
  const std::array<Vec3<double>, 3>& p = triangle.p;
  const std::array<Vec2<double>, 3>& uv = triangle.uv;
  const std::array<CornerFrame, 3>& frames = triangle.frames;
  const auto interpolated = [&](Vec3<double> CornerFrame::*of) {
    return weights[0] * (frames[0].*of) + weights[1] * (frames[1].*of) + weights[2] * (frames[2].*of);
  };
  const Vec3<double> raw_n = interpolated(&CornerFrame::n), n = direction(raw_n);
  if (form == FragmentForm::interpolated || form == FragmentForm::interpolated_raw) {
    const double sign = frames[0].sign;
    const Vec3<double> raw_t = interpolated(&CornerFrame::t);
    const Vec3<double> along = direction(raw_t), t = across(n, along);
    const CornerFrame frame = frame_or_fallback(t, sign * cross(n, t), n, sign);
    return frame.fallback || form == FragmentForm::interpolated
               ? frame
               : CornerFrame{raw_t, sign * cross(raw_n, raw_t), raw_n, sign, false};
  }
  const double sign = signed_uv_area2(uv[0], uv[1], uv[2]) > 0 ? 1 : -1;
  const std::optional<TangentPair> solved = solve_triangle(p, uv);
  if (!solved) return fallback_frame(n, sign);
  if (form == FragmentForm::projected) {
    const Vec3<double> t = across(n, unit(solved->t));
    return frame_or_fallback(t, sign * cross(n, t), n, sign);
  }
  const std::optional<TangentPair> pair =
      form == FragmentForm::gradient ? fragment_gradients(p, uv, n) : solved;
  return pair ? frame_or_fallback(unit(pair->t), unit(pair->b), n, sign) : fallback_frame(n, sign);
}

namespace {

// A separate frame for every corner.
MeshFrames at_corners(const Mesh& mesh, FragmentForm form) {
  MeshFrames result;
  for (const Triangle& triangle : mesh.triangles) {
    const Face face(mesh, triangle);
    count_degenerate(face, result);
    TriangleFrames corners{face.p, face.uv, {}};
    for (int k = 0; k < 3; ++k) corners.frames[k].n = unit(mesh.normals[triangle[k]]);
    for (int k = 0; k < 3; ++k) {
      std::array<double, 3> weights{};
      weights[k] = 1;
      result.of_corner.push_back(static_cast<std::uint32_t>(result.frames.size()));
      result.frames.push_back(fragment_frame(form, corners, weights));
    }
  }
  count_fallbacks(result);
  return result;
}

}  // namespace

MeshFrames compute_fragment_gradient(const Mesh& mesh, int) {
  return at_corners(mesh, FragmentForm::gradient);
}
MeshFrames compute_fragment_solve(const Mesh& mesh, int) {
  return at_corners(mesh, FragmentForm::solve);
}

}  // namespace darboux
