// Several meshes in one, as the parts of a file's primitive.
#pragma once

#include <cstdint>

#include <darboux/mesh.h>

namespace darboux {

// Adds another mesh's vertices and triangles behind those that are there.
inline void append(Mesh& mesh, const Mesh& more) {
  const auto shift = static_cast<std::uint32_t>(mesh.positions.size());
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  add(mesh.positions, more.positions);
  add(mesh.normals, more.normals);
  add(mesh.uvs, more.uvs);
  add(mesh.tangents, more.tangents);
  for (const auto& [a, b, c] : more.triangles) mesh.triangles.push_back({a + shift, b + shift, c + shift});
}

}  // namespace darboux
