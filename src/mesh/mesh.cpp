#include <cmath>

#include <darboux/error.h>
#include <darboux/mesh.h>

#include "base/text.h"

namespace darboux {

void check_consistent(const Mesh& mesh, const std::string& name) {
  const std::size_t n = mesh.positions.size();
  const auto check_size = [&](std::size_t size, const char* attribute) {
    if (size != 0 && size != n)
      throw MeshError(
          name, expected_got("no " + std::string(attribute) + " or one per position, " + std::to_string(n),
                             std::to_string(size)));
  };
  check_size(mesh.normals.size(), "normals");
  check_size(mesh.uvs.size(), "uvs");
  check_size(mesh.tangents.size(), "tangents");
  constexpr std::size_t most_triangles = 0xffffffff / 3;  // their corners and edges have 32-bit numbers
  if (mesh.triangles.size() > most_triangles)
    throw MeshError(name, expected_got("at most " + std::to_string(most_triangles) + " triangles",
                                       std::to_string(mesh.triangles.size())));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t index : mesh.triangles[t])
      if (index >= n)
        throw MeshError(name, "triangle " + std::to_string(t) + ": " +
                                  expected_got("indices below " + std::to_string(n), std::to_string(index)));
}

void check_finite(const Mesh& mesh, const std::string& name) {
  const auto check = [&](const char* attribute, const auto& values, const auto& finite) {
    for (std::size_t v = 0; v < values.size(); ++v)
      if (!finite(values[v]))
        throw MeshError(name, std::string(attribute) + " of vertex " + std::to_string(v) + ": " +
                                  expected_got("finite numbers", "NaN or infinity"));
  };
  const auto finite3 = [](const Vec3<double>& x) { return detail::finite(x); };
  check("position", mesh.positions, finite3);
  check("normal", mesh.normals, finite3);
  check("uv", mesh.uvs, [](const Vec2<double>& x) { return std::isfinite(x.x) && std::isfinite(x.y); });
}

}  // namespace darboux
