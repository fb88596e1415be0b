#include <cmath>

#include <darboux/error.h>
#include <darboux/mesh.h>

namespace darboux {

void check_consistent(const Mesh& mesh, const std::string& name) {
  const std::size_t n = mesh.positions.size();
  const auto check_size = [&](std::size_t size, const char* attribute) {
    if (size != 0 && size != n)
      throw MeshError(name, std::to_string(size) + " " + attribute + " for " + std::to_string(n) +
                                " positions, permitted are none or as many");
  };
  check_size(mesh.normals.size(), "normals");
  check_size(mesh.uvs.size(), "uvs");
  check_size(mesh.tangents.size(), "tangents");
  constexpr std::size_t most_triangles = 0xffffffff / 3;  // whose corners, and edges, 32 bits number
  if (mesh.triangles.size() > most_triangles)
    throw MeshError(name, std::to_string(mesh.triangles.size()) + " triangles, permitted are at most " +
                              std::to_string(most_triangles));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t index : mesh.triangles[t])
      if (index >= n)
        throw MeshError(name, "index " + std::to_string(index) + " in triangle " + std::to_string(t) +
                                  " is out of range, permitted are 0 to " + std::to_string(n) + " exclusive");
}

void check_finite(const Mesh& mesh, const std::string& name) {
  const auto check = [&](const char* attribute, const auto& values, const auto& finite) {
    for (std::size_t v = 0; v < values.size(); ++v)
      if (!finite(values[v]))
        throw MeshError(name, std::string(attribute) + " of vertex " + std::to_string(v) +
                                  " is not finite, permitted are finite numbers");
  };
  const auto finite3 = [](const Vec3<double>& x) { return detail::finite(x); };
  check("position", mesh.positions, finite3);
  check("normal", mesh.normals, finite3);
  check("uv", mesh.uvs, [](const Vec2<double>& x) { return std::isfinite(x.x) && std::isfinite(x.y); });
}

}  // namespace darboux
