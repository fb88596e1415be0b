/// \file map_meshes.h
/// Meshes on which normal maps are tried, and maps for them.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <darboux/normal_map.h>
#include <darboux/sample_mesh.h>

namespace darboux::test {

struct NamedPiece {
  std::string name;
  MapPiece piece;
};

/// Puts the halves of a mirrored mesh side by side: the one whose uvs wind the other way goes to u + 1/2.
inline void move_halves_apart(Mesh& mesh) {
  std::vector<bool> moved(mesh.uvs.size(), false);
  for (const Triangle& t : mesh.triangles) {
    const Vec2<double> a = mesh.uvs[t[1]] - mesh.uvs[t[0]], b = mesh.uvs[t[2]] - mesh.uvs[t[0]];
    for (const std::uint32_t v : t) moved[v] = a.x * b.y - a.y * b.x < 0;
  }
  for (std::size_t v = 0; v < mesh.uvs.size(); ++v)
    mesh.uvs[v] = {mesh.uvs[v].x / 2 + (moved[v] ? 0.5 : 0), mesh.uvs[v].y};
}

inline Mesh halves_apart(const AnySurface& surface, SampleMeshOptions options) {
  options.mirror = true;
  Mesh mesh = sample_mesh(surface, options);
  move_halves_apart(mesh);
  return mesh;
}

/// A sphere, a torus, sheared, jittered and mirrored ones, with exact tangents at the corners, and one mesh
/// with arbitrary tangents; two whose maps are scaled.
inline std::vector<NamedPiece> map_meshes() {
  const AnySurface torus = make_surface("torus:major_radius=1,minor_radius=0.4"),
                   sphere = make_surface("sphere");
  SampleMeshOptions grid;
  grid.columns = 16;
  grid.rows = 8;
  SampleMeshOptions jittered = grid, sheared = grid;
  jittered.jitter = 0.2;  // by more some triangles fold over
  jittered.random_diagonals = true;
  jittered.seed = 5;
  sheared.shear = 0.5;
  std::vector<NamedPiece> result;
  const auto add = [&](const char* name, Mesh mesh) { result.push_back({name, {.mesh = std::move(mesh)}}); };
  add("sphere", sample_mesh(sphere, grid));
  add("torus", sample_mesh(torus, grid));
  add("jittered torus", sample_mesh(torus, jittered));
  add("mirrored halves", halves_apart(torus, grid));
  // Frames of any kind at the vertices, of conditions up to 10 and beyond inside of triangles.
  SampleMeshOptions coarse;
  coarse.columns = coarse.rows = 6;
  Mesh askew = sample_mesh(make_surface("plane"), coarse);
  std::mt19937_64 random(29);
  std::normal_distribution<double> normal(0, 0.6);
  for (std::size_t v = 0; v < askew.uvs.size(); ++v) {
    askew.normals[v] = unit(Vec3<double>{normal(random), normal(random), 1});
    const Vec3<double> t = unit(Vec3<double>{1, normal(random), normal(random)});
    askew.tangents[v] = {t.x, t.y, t.z, 1};
  }
  add("askew plane", std::move(askew));
  // u + v/2 up to 1.5: of half the width, so that no triangle lies outside of the map.
  Mesh mesh = sample_mesh(torus, sheared);
  for (Vec2<double>& uv : mesh.uvs) uv.x /= 2;
  add("sheared torus", std::move(mesh));
  add("scaled", sample_mesh(torus, jittered));
  result.back().piece.scale = 0.4;
  add("scaled and turned", sample_mesh(sphere, grid));
  result.back().piece.scale = -2;
  return result;
}

/// Of unit length.
inline std::array<double, 3> random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  double x = normal(random), y = normal(random), z = normal(random);
  const double length = std::sqrt(x * x + y * y + z * z);
  return {x / length, y / length, z / length};
}

/// Codes of unit vectors of any direction.
inline Image random_directions(int width, int height, SampleType type, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Image image(width, height, 3, type);
  for (std::size_t i = 0; i < image.texels(); ++i) {
    const auto x = random_direction(random);
    for (std::size_t c = 0; c < 3; ++c)
      std::visit(
          [&](auto& s) {
            using T = typename std::remove_reference_t<decltype(s)>::value_type;
            const double most = type == SampleType::u8 ? 255 : type == SampleType::u16 ? 65535 : 1;
            const double code = (x[c] + 1) / 2 * most;
            s[3 * i + c] = static_cast<T>(type == SampleType::f32 ? code : std::round(code));
          },
          image.samples);
  }
  return image;
}

}  // namespace darboux::test
