/// \file arrays.h
/// Meshes as mikktspace() takes them, for its tests.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <utility>
#include <vector>

#include <darboux/mikktspace.h>

#include "generated_meshes.h"

namespace darboux::test {

struct Arrays {
  std::vector<float> positions, normals, uvs;
  std::vector<std::uint32_t> corners;
  std::vector<std::uint8_t> face_sizes;

  Arrays() = default;
  explicit Arrays(const Soup& soup) {
    for (const Corner& x : soup) add(x);
  }
  void add(const Corner& x) {
    positions.insert(positions.end(), x.begin(), x.begin() + 3);
    normals.insert(normals.end(), x.begin() + 3, x.begin() + 6);
    uvs.insert(uvs.end(), x.begin() + 6, x.end());
  }
  MikkMesh mesh() const { return {positions, normals, uvs, corners, face_sizes}; }
  std::vector<float> tangents(const MikkOptions& options = {}) const {
    std::vector<float> result(4 * mesh().corner_count(), 7);
    mikktspace(mesh(), result, options);
    return result;
  }
};

inline bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

// All but the padding.
inline bool same_bits(const MikkTangent& a, const MikkTangent& b) {
  const auto words = [](const MikkTangent& x) {
    return std::bit_cast<std::array<std::uint32_t, 9>>(
        std::array<float, 9>{x.t[0], x.t[1], x.t[2], x.b[0], x.b[1], x.b[2], x.t_length, x.b_length, x.sign});
  };
  return words(a) == words(b) && a.served == b.served;
}

inline Corner torus(double u, double v, float s, float t) {
  const double a = 2 * std::numbers::pi * u, b = 2 * std::numbers::pi * v, rho = 1 + 0.4 * std::cos(b);
  const std::array<double, 6> x{rho * std::cos(a),         rho * std::sin(a),         0.4 * std::sin(b),
                                std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b)};
  Corner corner{};
  for (std::size_t k = 0; k < 6; ++k) corner[k] = static_cast<float>(x[k]);
  corner[6] = s, corner[7] = t;
  return corner;
}
inline Soup torus_soup(int columns, int rows) {
  Soup soup;
  const auto at = [&](int i, int j) {
    const double u = static_cast<double>(i) / columns, v = static_cast<double>(j) / rows;
    return torus(i == columns ? 0 : u, j == rows ? 0 : v, static_cast<float>(u), static_cast<float>(v));
  };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      for (const auto& [di, dj] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
        soup.push_back(at(i + di, j + dj));
  return soup;
}

}  // namespace darboux::test
