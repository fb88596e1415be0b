// MikkTSpace as one of the methods.
#include "mikktspace_frames.h"

#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <darboux/error.h>
#include <darboux/mikktspace.h>

#include "base/parallel.h"
#include "base/text.h"
#include "corner.h"

namespace darboux {
namespace {

using mikk::Buffer;

// All numbers in single precision. Numbers below its range are scaled by a power of two, since only
// directions matter.
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

// Where squares underflow to zero, MikkTSpace's t and b are zero, of any length, or not finite. Otherwise
// they have unit length up to 4.5 roundings: of a sum of squares, halved by the root, the root, the division,
// the product.
Vec3<double> unit_or_zero(const float (&x)[3]) {
  const Vec3<double> a{x[0], x[1], x[2]};
  return std::fabs(norm(a) - 1) < 3e-7 ? a : Vec3<double>{};
}

// The method's frame of a corner.
CornerFrame frame_of(const MikkTangent& x, const Vec3<double>& normal, bool own_bitangent) {
  if (!x.served) return fallback_frame(normal, x.sign);
  const Vec3<double> n = unit(normal), t = unit_or_zero(x.t);
  // Where dpdu is along n, t is only the rounding error of its projection: it may have any direction, even
  // along n.
  const Vec3<double> b = own_bitangent ? unit_or_zero(x.b) : double{x.sign} * unit(cross(n, t));
  return frame_or_fallback(t, b, n, x.sign);
}

// Whether frame_of() keeps t: t is unit, the squared length of n is a normal number, and the two are not
// parallel. Nearly all are kept, and this test costs a tenth of frame_of().
bool keeps(const Vec3<double>& t, const Vec3<double>& n) {
  const double nn = dot(n, n);
  const Vec3<double> b = cross(n, t);
  return std::fabs(dot(t, t) - 1) < 5e-7 && nn > 0x1p-100 && nn < 0x1p100 && dot(b, b) > 0x1p-60 * nn;
}

Vec3<double> vector_at(std::span<const float> values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

constexpr float unserved = 0;  // a sign that no triangle gives

// Replaces MikkTSpace's tangent by the method's. \returns whether it is a fallback
bool mend(Vec4<float>& tangent, const Vec3<double>& n) {
  const bool served = tangent.w != unserved;
  if (served && keeps({tangent.x, tangent.y, tangent.z}, n)) return false;
  MikkTangent found{.t = {tangent.x, tangent.y, tangent.z}, .served = served};
  if (served) found.sign = tangent.w;
  const CornerFrame frame = frame_of(found, n, false);
  tangent = {static_cast<float>(frame.t.x), static_cast<float>(frame.t.y), static_cast<float>(frame.t.z),
             static_cast<float>(frame.sign)};
  return frame.fallback;
}

// The same for tangents by vertex. \returns how many corners have fallbacks
std::size_t mend_vertices(const MikkMesh& mesh, std::size_t threads, mikk::VertexTangents& tangents) {
  const auto normal = [&](std::size_t v) { return vector_at(mesh.normals, v); };
  std::atomic<bool> some = false;
  std::vector<std::uint8_t> fallback(mesh.vertex_count());
  parallel_ranges(mesh.vertex_count(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      if (Vec4<float>& tangent = tangents.of_vertices[v]; tangent.w != unserved && mend(tangent, normal(v)))
        fallback[v] = 1, some = true;
  });
  std::size_t count = 0;
  if (some)
    for (const std::uint32_t v : mesh.corners) count += fallback[v];
  for (mikk::CornerTangent& other : tangents.others) {
    const std::uint32_t v = mesh.corners[other.corner];
    count -= fallback[v];
    count += mend(other.tangent, normal(v)) ? 1 : 0;
  }
  std::erase_if(tangents.others, [&](const mikk::CornerTangent& other) {
    return std::memcmp(&other.tangent, &tangents.of_vertices[mesh.corners[other.corner]],
                       sizeof other.tangent) == 0;
  });
  return count;
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
    result.of_corner.push_back(static_cast<std::uint32_t>(c));
    result.frames.push_back(frame_of(tangents[c], mesh.normals[corners[c]], own_bitangent));
  }
  count_fallbacks(result);
  return result;
}

}  // namespace

MikktspaceTangents mikktspace_tangents(const MikkMesh& mesh, int threads) {
  const MikkOptions options{.unserved_sign = unserved, .threads = threads};
  MikktspaceTangents result;
  Buffer<Vec4<float>>& of_corners = result.of_corners;
  if (mesh.corners.empty()) {
    of_corners = Buffer<Vec4<float>>(mesh.vertex_count());
    mikktspace(mesh, {&of_corners.data()->x, 4 * of_corners.size()}, options);
  } else {
    static_cast<mikk::VertexTangents&>(result) = mikk::vertex_tangents(mesh, options);
  }
  const auto vertex = [&](std::size_t c) { return mesh.corners.empty() ? c : mesh.corners[c]; };
  const auto mend_at = [&](Vec4<float>& tangent, std::size_t v) {
    return mend(tangent, vector_at(mesh.normals, v));
  };
  std::atomic<std::size_t> in_space = 0, in_uv = 0, fallbacks = 0;
  parallel_ranges(mesh.corner_count() / 3, thread_count(threads), [&](std::size_t begin, std::size_t end) {
    MikktspaceCounts here;
    for (std::size_t triangle = begin; triangle < end; ++triangle) {
      std::array<Vec3<double>, 3> p;
      std::array<Vec2<double>, 3> uv;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t c = 3 * triangle + k, v = vertex(c);
        p[k] = vector_at(mesh.positions, v);
        uv[k] = {mesh.uvs[2 * v], mesh.uvs[2 * v + 1]};
        if (!of_corners.empty()) here.fallback_corners += mend_at(of_corners[c], v) ? 1 : 0;
      }
      count_degenerate(p, uv, here);
    }
    in_space += here.degenerate_triangles, in_uv += here.degenerate_uv_triangles;
    fallbacks += here.fallback_corners;
  });
  if (of_corners.empty()) fallbacks += mend_vertices(mesh, thread_count(threads), result);
  result.counts = {in_space, in_uv, fallbacks};
  return result;
}

MeshFrames compute_mikktspace(const Mesh& mesh, int threads) {
  return compute(mesh, threads, false);
}
MeshFrames compute_mikktspace_bitangent(const Mesh& mesh, int threads) {
  return compute(mesh, threads, true);
}

}  // namespace darboux
