#include <cmath>
#include <string>

#include <Eigen/LU>

#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/mesh_frames.h>

namespace darboux {
namespace {

constexpr double parallel_below = 8 * 0x1p-53;

bool is_zero(const Vec3<double>& a) {
  return a == Vec3<double>{};
}

// An arbitrary unit direction across n: from the coordinate axis farthest from it.
Vec3<double> any_perpendicular(const Vec3<double>& n) {
  const double ax = std::fabs(n.x), ay = std::fabs(n.y), az = std::fabs(n.z);
  const Vec3<double> axis = ax <= ay && ax <= az ? Vec3<double>{1, 0, 0}
                            : ay <= az           ? Vec3<double>{0, 1, 0}
                                                 : Vec3<double>{0, 0, 1};
  return unit(axis - dot(axis, n) * n);
}

bool is_direction(const Vec3<double>& a) {
  return detail::finite(a) && !is_zero(a);
}

// The frame where no triangle serves.
CornerFrame fallback_frame(const Vec3<double>& n, double sign) {
  const Vec3<double> normal = is_direction(unit(n)) ? unit(n) : Vec3<double>{0, 0, 1};
  const Vec3<double> t = any_perpendicular(normal);
  return {t, sign * cross(normal, t), normal, sign, true};
}

// The frame a method found, or the fallback where data that are not finite or vanish leave it none.
CornerFrame frame_or_fallback(const Vec3<double>& t, const Vec3<double>& b, const Vec3<double>& n,
                              double sign) {
  return is_direction(t) && is_direction(b) && is_direction(n) ? CornerFrame{t, b, n, sign, false}
                                                               : fallback_frame(n, sign);
}

// What every method needs of a triangle.
struct Face {
  std::array<Vec3<double>, 3> p;
  std::array<Vec2<double>, 3> uv;
  std::optional<TangentPair> solved;
  double sign;

  Face(const Mesh& mesh, const Triangle& triangle) {
    for (int k = 0; k < 3; ++k) {
      p[k] = mesh.positions[triangle[k]];
      uv[k] = mesh.uvs[triangle[k]];
    }
    solved = solve_triangle(p, uv);
    sign = signed_uv_area2(uv[0], uv[1], uv[2]) > 0 ? 1 : -1;
  }
  Vec3<double> area_vector() const {  // twice the area, along the face normal
    return accurate_cross(p[1] - p[0], p[2] - p[0]);
  }
  double angle(int corner) const {
    return angle_between(p[(corner + 1) % 3] - p[corner], p[(corner + 2) % 3] - p[corner]);
  }
};

void count_degenerate(const Face& face, MeshFrames& result) {
  if (is_degenerate(face.p[0], face.p[1], face.p[2]))
    ++result.degenerate_triangles;
  else if (is_degenerate(face.uv[0], face.uv[1], face.uv[2]))
    ++result.degenerate_uv_triangles;
}

void count_fallbacks(MeshFrames& result) {
  for (const std::uint32_t f : result.of_corner) result.fallback_corners += result.frames[f].fallback;
}

MeshFrames compute_face(const Mesh& mesh) {
  MeshFrames result;
  for (const Triangle& triangle : mesh.triangles) {
    const Face face(mesh, triangle);
    count_degenerate(face, result);
    const Vec3<double> n = unit(accurate_cross(unit(face.p[1] - face.p[0]), unit(face.p[2] - face.p[0])));
    const auto index = static_cast<std::uint32_t>(result.frames.size());
    result.frames.push_back(face.solved
                                ? CornerFrame{unit(face.solved->t), unit(face.solved->b), n, face.sign, false}
                                : fallback_frame(n, face.sign));
    result.of_corner.insert(result.of_corner.end(), 3, index);
  }
  count_fallbacks(result);
  return result;
}

// Sums of weighted tangents at every vertex, then Gram-Schmidt against its normal. weight(face, corner)
// multiplies unit(T) and unit(B), or T and B themselves where `raw`.
template <bool raw, class Weight>
MeshFrames compute_average(const Mesh& mesh, Weight weight) {
  MeshFrames result;
  std::vector<Vec3<double>> t(mesh.positions.size()), b(mesh.positions.size());
  std::vector<double> sign(mesh.positions.size(), 0);
  result.of_corner.reserve(mesh.corners());
  for (const Triangle& triangle : mesh.triangles) {
    const Face face(mesh, triangle);
    count_degenerate(face, result);
    for (int k = 0; k < 3; ++k) {
      result.of_corner.push_back(triangle[k]);
      if (!face.solved) continue;
      const double w = weight(face, k);
      t[triangle[k]] += w * (raw ? face.solved->t : unit(face.solved->t));
      b[triangle[k]] += w * (raw ? face.solved->b : unit(face.solved->b));
      sign[triangle[k]] += w * face.sign;
    }
  }
  result.frames.reserve(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3<double> n = unit(mesh.normals[v]);
    const auto frame = gram_schmidt(t[v], b[v], n);
    const double s = sign[v] < 0 ? -1 : 1;
    result.frames.push_back(frame_or_fallback(frame.t, frame.b, n, s));
  }
  count_fallbacks(result);
  return result;
}

MeshFrames compute_raw_sum(const Mesh& mesh) {
  return compute_average<true>(mesh, [](const Face&, int) { return 1.0; });
}
MeshFrames compute_unit(const Mesh& mesh) {
  return compute_average<false>(mesh, [](const Face&, int) { return 1.0; });
}
MeshFrames compute_area(const Mesh& mesh) {
  return compute_average<false>(mesh, [](const Face& face, int) { return norm(face.area_vector()) / 2; });
}
MeshFrames compute_angle(const Mesh& mesh) {
  return compute_average<false>(mesh, [](const Face& face, int k) { return face.angle(k); });
}

// A frame of its own for every corner, from the triangle and the normal there.
template <class Fragment>
MeshFrames compute_fragments(const Mesh& mesh, Fragment fragment) {
  MeshFrames result;
  for (const Triangle& triangle : mesh.triangles) {
    const Face face(mesh, triangle);
    count_degenerate(face, result);
    for (int k = 0; k < 3; ++k) {
      const Vec3<double> n = unit(mesh.normals[triangle[k]]);
      const std::optional<TangentPair> pair = face.solved ? fragment(face, n) : std::nullopt;
      result.of_corner.push_back(static_cast<std::uint32_t>(result.frames.size()));
      result.frames.push_back(pair ? frame_or_fallback(unit(pair->t), unit(pair->b), n, face.sign)
                                   : fallback_frame(n, face.sign));
    }
  }
  count_fallbacks(result);
  return result;
}

MeshFrames compute_fragment_gradient(const Mesh& mesh) {
  return compute_fragments(
      mesh, [](const Face& face, const Vec3<double>& n) { return fragment_gradients(face.p, face.uv, n); });
}
MeshFrames compute_fragment_solve(const Mesh& mesh) {
  return compute_fragments(mesh, [](const Face& face, const Vec3<double>&) { return face.solved; });
}

constexpr FrameMethod methods[] = {
    {"face",
     "each triangle on its own: the directions in which u and v grow on it; faceted, as with flat shading",
     "[p1-p0, p2-p0] = [T B] U, t = T/|T|, b = B/|B|", false, 1, 1, 1, 1, compute_face},
    {"average",
     "triangle tangents added up at each vertex, long ones count more, then made square to the normal "
     "(three.js, PlayCanvas and many textbooks)",
     "t = GramSchmidt(sum T), b = GramSchmidt(sum B)", true, 2, 1, 2, 0, compute_raw_sum},
    {"unit", "triangle directions averaged at each vertex, every triangle counts the same",
     "t = GramSchmidt(sum T/|T|), b likewise", true, 2, 1, 2, 0, compute_unit},
    {"area", "triangle directions averaged at each vertex, large triangles count more",
     "t = GramSchmidt(sum area T/|T|), b likewise", true, 2, 1, 2, 0, compute_area},
    {"angle", "triangle directions averaged at each vertex, by the angle the triangle has there",
     "t = GramSchmidt(sum angle T/|T|), b likewise", true, 2, 1, 2, 0, compute_angle},
    {"fragment-gradient",
     "what a shader gets from solving for the gradients of u and v across the smooth normal "
     "(tinyrenderer); on sheared uvs these are not the directions of the texture's axes",
     "A = (p1-p0; p2-p0; n), A i = (du1, du2, 0), A j = (dv1, dv2, 0), t = i/|i|, b = j/|j|", true, 1, 1, 0,
     0, compute_fragment_gradient},
    {"fragment-solve",
     "what a shader gets from the triangle's own directions beside the smooth normal (tinyrenderer); "
     "not square to that normal",
     "T = E U^-1, t = T/|T|, b = B/|B|, n interpolated", true, 1, 1, 1, 1, compute_fragment_solve},
};

}  // namespace

bool is_degenerate(const Vec3<double>& p0, const Vec3<double>& p1, const Vec3<double>& p2) {
  const Vec3<double> a = unit(p1 - p0), b = unit(p2 - p0);
  return !(norm(accurate_cross(a, b)) > parallel_below);
}

bool is_degenerate(const Vec2<double>& uv0, const Vec2<double>& uv1, const Vec2<double>& uv2) {
  return is_degenerate(Vec3<double>{uv0.x, uv0.y, 0}, {uv1.x, uv1.y, 0}, {uv2.x, uv2.y, 0});
}

double signed_uv_area2(const Vec2<double>& uv0, const Vec2<double>& uv1, const Vec2<double>& uv2) {
  return difference_of_products(uv1.x - uv0.x, uv2.y - uv0.y, uv2.x - uv0.x, uv1.y - uv0.y);
}

std::optional<TangentPair> solve_triangle(const std::array<Vec3<double>, 3>& p,
                                          const std::array<Vec2<double>, 3>& uv) {
  if (is_degenerate(p[0], p[1], p[2]) || is_degenerate(uv[0], uv[1], uv[2])) return std::nullopt;
  const Vec3<double> e1 = p[1] - p[0], e2 = p[2] - p[0];
  const double du1 = uv[1].x - uv[0].x, dv1 = uv[1].y - uv[0].y;
  const double du2 = uv[2].x - uv[0].x, dv2 = uv[2].y - uv[0].y;
  const double det = difference_of_products(du1, dv2, du2, dv1);
  if (det == 0 || !std::isfinite(det)) return std::nullopt;
  return TangentPair{(dv2 / det) * e1 - (dv1 / det) * e2, (du1 / det) * e2 - (du2 / det) * e1};
}

std::optional<TangentPair> fragment_gradients(const std::array<Vec3<double>, 3>& p,
                                              const std::array<Vec2<double>, 3>& uv, const Vec3<double>& n) {
  // Rows of length 1, so that singular means parallel, whatever the size of the triangle.
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

std::span<const FrameMethod> frame_methods() {
  return methods;
}

const FrameMethod& find_frame_method(std::string_view name) {
  std::string known;
  for (const FrameMethod& method : methods) {
    if (method.name == name) return method;
    known += (known.empty() ? "" : ", ") + std::string(method.name);
  }
  throw ParameterError("method", "unknown method '" + std::string(name) + "', known are " + known);
}

MeshFrames mesh_frames(const Mesh& mesh, const FrameMethod& method) {
  check_consistent(mesh, "mesh");
  if (mesh.uvs.empty() && !mesh.triangles.empty())
    throw MeshError("mesh", "has no uvs, tangents need one uv set");
  if (method.needs_normals && mesh.normals.empty() && !mesh.triangles.empty())
    throw MeshError("mesh",
                    "has no normals, method '" + std::string(method.name) + "' needs them ('face' does not)");
  return method.compute(mesh);
}

}  // namespace darboux
