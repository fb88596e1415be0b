// MikkTSpace as one of the methods.
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <darboux/error.h>
#include <darboux/mikktspace.h>

#include "base/text.h"
#include "corner.h"

namespace darboux {
namespace {

// All numbers in single precision; those below its range, where only directions matter, times a power of two.
template <class Vector>
std::vector<float> to_floats(const std::vector<Vector>& values, const char* name, bool any_scale) {
  constexpr std::size_t components = sizeof(Vector) / sizeof(double);
  const auto component = [&](std::size_t i) {
    double x;
    std::memcpy(&x, reinterpret_cast<const char*>(values.data()) + i * sizeof x, sizeof x);
    return x;
  };
  double greatest = 0;
  for (std::size_t i = 0; i < components * values.size(); ++i) {
    greatest = std::fmax(greatest, std::fabs(component(i)));
    if (greatest > static_cast<double>(std::numeric_limits<float>::max()))
      throw MeshError("mesh", std::string(name) + " of vertex " + std::to_string(i / components) + ": " +
                                  expected_got("magnitudes up to 3.4e38 for mikktspace", shortest(greatest)));
  }
  const double small = 0x1p-100;
  const int exponent = any_scale && greatest > 0 && greatest < small ? std::ilogb(greatest) : 0;
  std::vector<float> result;
  result.reserve(components * values.size());
  for (std::size_t i = 0; i < components * values.size(); ++i)
    result.push_back(static_cast<float>(std::ldexp(component(i), -exponent)));
  return result;
}

// MikkTSpace's t and b are zero, of any length or not finite where squares vanish. The others are unit to 4.5
// roundings: of a sum of squares, halved by the root, the root, the division, the product.
Vec3<double> unit_or_zero(const float (&x)[3]) {
  const Vec3<double> a{x[0], x[1], x[2]};
  return std::fabs(norm(a) - 1) < 3e-7 ? a : Vec3<double>{};
}

MeshFrames compute(const Mesh& mesh, int threads, bool own_bitangent) {
  MeshFrames result;
  const std::vector<float> positions = to_floats(mesh.positions, "position", true),
                           normals = to_floats(mesh.normals, "normal", false),
                           uvs = to_floats(mesh.uvs, "uv", true);
  std::vector<std::uint32_t> corners;
  corners.reserve(mesh.corners());
  for (const Triangle& triangle : mesh.triangles) {
    count_degenerate(Face(mesh, triangle), result);
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  }
  if (corners.empty()) return result;
  const std::vector<MikkTangent> tangents =
      mikktspace(MikkMesh{positions, normals, uvs, corners, {}}, {.threads = threads});
  result.frames.reserve(corners.size());
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const MikkTangent& x = tangents[c];
    const Vec3<double> n = unit(mesh.normals[corners[c]]), t = unit_or_zero(x.t);
    // Where the mesh grows in u along n, t is the rounding of its projection: of any direction, even along n.
    const Vec3<double> b = own_bitangent ? unit_or_zero(x.b) : double{x.sign} * unit(cross(n, t));
    result.of_corner.push_back(static_cast<std::uint32_t>(c));
    result.frames.push_back(frame_or_fallback(t, b, n, x.sign));
    result.frames.back().fallback |= !x.served;
  }
  count_fallbacks(result);
  return result;
}

}  // namespace

MeshFrames compute_mikktspace(const Mesh& mesh, int threads) {
  return compute(mesh, threads, false);
}
MeshFrames compute_mikktspace_bitangent(const Mesh& mesh, int threads) {
  return compute(mesh, threads, true);
}

}  // namespace darboux
