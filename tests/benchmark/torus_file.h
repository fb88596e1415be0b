/// \file torus_file.h
/// A torus as arrays in a file, so that all programs compared have the same floats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace darboux::bench {

/// Positions, normals, uvs of vertices and the vertex of each corner of the triangles; no corners: corner i
/// is vertex i.
struct MeshArrays {
  std::vector<float> positions, normals, uvs;
  std::vector<std::uint32_t> corners;

  std::size_t vertex_count() const { return uvs.size() / 2; }
  std::size_t corner_count() const { return corners.empty() ? vertex_count() : corners.size(); }
  std::uint32_t vertex(std::size_t corner) const {
    return corners.empty() ? static_cast<std::uint32_t>(corner) : corners[corner];
  }
};

/// R = 1, r = 0.4 about z on a regular grid of 2 * columns * rows triangles, indexed; vertices at the seams
/// come twice, once for each uv.
MeshArrays torus(int columns, int rows);
/// The same triangles, three vertices each, without corners.
MeshArrays unindexed(const MeshArrays& mesh);

/// A file: the numbers of vertices and of corners as 32-bit integers, then the four arrays, in the machine's
/// byte order.
void write(const MeshArrays& mesh, const std::filesystem::path& file);
/// \throws std::runtime_error
MeshArrays read_mesh_arrays(const std::filesystem::path& file);

/// All floats of a file.
std::vector<float> read_floats(const std::filesystem::path& file);
void write_floats(const std::vector<float>& numbers, const std::filesystem::path& file);

}  // namespace darboux::bench
