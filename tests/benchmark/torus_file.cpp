#include "torus_file.h"

#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace darboux::bench {
namespace {

template <class T>
void put(std::ostream& file, const std::vector<T>& numbers) {
  file.write(reinterpret_cast<const char*>(numbers.data()),
             static_cast<std::streamsize>(numbers.size() * sizeof(T)));
}
// Straight into the array: no other memory is touched.
template <class T>
std::vector<T> get(std::istream& file, std::size_t count) {
  std::vector<T> numbers(count);
  file.read(reinterpret_cast<char*>(numbers.data()), static_cast<std::streamsize>(count * sizeof(T)));
  return numbers;
}

void check(const std::ios& file, const std::filesystem::path& path) {
  if (!file) throw std::runtime_error(path.string() + ": cannot be read or written");
}

}  // namespace

MeshArrays torus(int columns, int rows) {
  MeshArrays mesh;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const double u = static_cast<double>(i) / columns, v = static_cast<double>(j) / rows;
      // The last column and row are where the first are, to the bit.
      const double a = 2 * std::numbers::pi * (i == columns ? 0 : u),
                   b = 2 * std::numbers::pi * (j == rows ? 0 : v);
      const double rho = 1 + 0.4 * std::cos(b);
      for (const double x : {rho * std::cos(a), rho * std::sin(a), 0.4 * std::sin(b)})
        mesh.positions.push_back(static_cast<float>(x));
      for (const double x : {std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b)})
        mesh.normals.push_back(static_cast<float>(x));
      for (const double x : {u, v}) mesh.uvs.push_back(static_cast<float>(x));
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      for (const auto& [di, dj] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
        mesh.corners.push_back(static_cast<std::uint32_t>((j + dj) * (columns + 1) + i + di));
  return mesh;
}

MeshArrays unindexed(const MeshArrays& mesh) {
  MeshArrays soup;
  const auto expand = [&](const std::vector<float>& from, std::size_t size, std::vector<float>& to) {
    to.reserve(size * mesh.corner_count());
    for (std::size_t c = 0; c < mesh.corner_count(); ++c)
      for (std::size_t k = 0; k < size; ++k) to.push_back(from[size * mesh.vertex(c) + k]);
  };
  expand(mesh.positions, 3, soup.positions);
  expand(mesh.normals, 3, soup.normals);
  expand(mesh.uvs, 2, soup.uvs);
  return soup;
}

void write(const MeshArrays& mesh, const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  put(file, std::vector<std::uint32_t>{static_cast<std::uint32_t>(mesh.vertex_count()),
                                       static_cast<std::uint32_t>(mesh.corners.size())});
  put(file, mesh.positions);
  put(file, mesh.normals);
  put(file, mesh.uvs);
  put(file, mesh.corners);
  check(file.flush(), path);
}

MeshArrays read_mesh_arrays(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<std::uint32_t> counts = get<std::uint32_t>(file, 2);
  check(file, path);
  MeshArrays mesh;
  mesh.positions = get<float>(file, 3 * std::size_t{counts[0]});
  mesh.normals = get<float>(file, 3 * std::size_t{counts[0]});
  mesh.uvs = get<float>(file, 2 * std::size_t{counts[0]});
  mesh.corners = get<std::uint32_t>(file, counts[1]);
  check(file, path);
  return mesh;
}

std::vector<float> read_floats(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  check(file, path);
  const std::size_t count = static_cast<std::size_t>(file.tellg()) / sizeof(float);
  file.seekg(0);
  std::vector<float> numbers = get<float>(file, count);
  check(file, path);
  return numbers;
}

void write_floats(const std::vector<float>& numbers, const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  put(file, numbers);
  check(file.flush(), path);
}

}  // namespace darboux::bench
