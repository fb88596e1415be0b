/// \file coarse_sphere.h
/// Spheres of few columns with MikkTSpace's tangents, as engines build them.
#pragma once

#include <cstddef>
#include <cstdint>

#include <darboux/any_surface.h>
#include <darboux/mesh.h>
#include <darboux/mesh_frames.h>

namespace darboux::test {

/// MikkTSpace's tangents, one per vertex: that of its last corner.
inline void add_mikktspace(Mesh& mesh) {
  const MeshFrames frames = mesh_frames(mesh, find_frame_method("mikktspace"));
  mesh.tangents.resize(mesh.positions.size());
  for (std::size_t c = 0; c < mesh.corners(); ++c) {
    const CornerFrame& f = frames.corner(c);
    mesh.tangents[mesh.triangles[c / 3][c % 3]] = {f.t.x, f.t.y, f.t.z, -f.sign};
  }
}

/// A grid over (u, v) whose first and last row lie at the poles, with or without the triangles there that
/// have no area.
inline Mesh coarse_sphere(std::uint32_t columns, std::uint32_t rows, bool with_degenerate) {
  Mesh mesh;
  const AnySurface sphere = make_surface("sphere");
  for (std::uint32_t j = 0; j <= rows; ++j)
    for (std::uint32_t i = 0; i <= columns; ++i) {
      mesh.uvs.push_back({static_cast<double>(i) / columns, static_cast<double>(j) / rows});
      const Sample<double> s = sphere.sample(mesh.uvs.back().x, mesh.uvs.back().y);
      mesh.positions.push_back(s.jet.position);
      mesh.normals.push_back(s.frame.n);
      if (i == columns || j == rows) continue;
      const std::uint32_t a = j * (columns + 1) + i, above = a + columns + 1;
      if (with_degenerate || j > 0) mesh.triangles.push_back({a, a + 1, above + 1});
      if (with_degenerate || j + 1 < rows) mesh.triangles.push_back({a, above + 1, above});
    }
  add_mikktspace(mesh);
  return mesh;
}

}  // namespace darboux::test
