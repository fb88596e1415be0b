// Single triangles, and averages over those at a vertex.
#include <darboux/frame.h>

#include "corner.h"

namespace darboux {
namespace {

// Sums weighted tangents at every vertex, then applies Gram-Schmidt against its normal. weight(face, corner)
// multiplies unit(T) and unit(B), or T and B themselves if `raw`.
template <bool raw, class Weight>
MeshFrames average(const Mesh& mesh, Weight weight) {
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

}  // namespace

MeshFrames compute_face(const Mesh& mesh, int) {
  MeshFrames result;
  for (const Triangle& triangle : mesh.triangles) {
    const Face face(mesh, triangle);
    count_degenerate(face, result);
    const Vec3<double> n = face_normal(face.p);
    const auto index = static_cast<std::uint32_t>(result.frames.size());
    result.frames.push_back(face.solved
                                ? CornerFrame{unit(face.solved->t), unit(face.solved->b), n, face.sign, false}
                                : fallback_frame(n, face.sign));
    result.of_corner.insert(result.of_corner.end(), 3, index);
  }
  count_fallbacks(result);
  return result;
}

MeshFrames compute_average(const Mesh& mesh, int) {
  return average<true>(mesh, [](const Face&, int) { return 1.0; });
}
MeshFrames compute_unit(const Mesh& mesh, int) {
  return average<false>(mesh, [](const Face&, int) { return 1.0; });
}
MeshFrames compute_area(const Mesh& mesh, int) {
  const double scale = scale_below_one(mesh);
  return average<false>(mesh,
                        [scale](const Face& face, int) { return triangle_area(scaled(face.p, scale)); });
}
MeshFrames compute_angle(const Mesh& mesh, int) {
  return average<false>(mesh, [](const Face& face, int k) { return corner_angle(face.p, k); });
}
MeshFrames compute_max(const Mesh& mesh, int) {
  const double scale = scale_below_one(mesh);
  return average<false>(
      mesh, [scale](const Face& face, int k) { return corner_max_weight(scaled(face.p, scale), k); });
}

}  // namespace darboux
