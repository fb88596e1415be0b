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
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t index : mesh.triangles[t])
      if (index >= n)
        throw MeshError(name, "index " + std::to_string(index) + " in triangle " + std::to_string(t) +
                                  " is out of range, permitted are 0 to " + std::to_string(n) + " exclusive");
}

}  // namespace darboux
