/// \file generated_meshes.h
/// Triangle soups that are hard for MikkTSpace, the same on every machine: what tests/mikktspace/oracle.js is
/// asked, and mikktspace_test compares.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace darboux::test {

/// Position, normal and uv of a corner; three corners are a triangle.
using Corner = std::array<float, 8>;
using Soup = std::vector<Corner>;

class Chance {
 public:
  explicit Chance(std::uint32_t seed) : bits_(seed) {}
  double number() { return static_cast<double>(bits_()) / 4294967296.0; }  // in [0, 1)
  int below(int n) { return static_cast<int>(number() * n); }
  bool one_in(double n) { return number() * n < 1; }
  void direction(float* to, double tilt) {
    const double x = tilt * (number() - 0.5), y = tilt * (number() - 0.5), z = tilt < 1 ? 1 : number() - 0.5;
    const double length = std::sqrt(x * x + y * y + z * z);
    to[0] = static_cast<float>(x / length), to[1] = static_cast<float>(y / length);
    to[2] = static_cast<float>(z / length);
  }

 private:
  std::mt19937 bits_;
};

/// Triangles over vertices taken at random, most near each other: edges of many triangles, equal places and
/// uvs, no area in space or uv, zeros of both signs.
inline Soup random_soup(std::uint32_t seed, int vertices) {
  Chance chance(seed);
  const bool coarse = chance.one_in(2), coarse_uv = chance.one_in(2), both_zeros = chance.one_in(3);
  const int places = 1 + chance.below(8);
  std::vector<Corner> vertex(static_cast<std::size_t>(vertices));
  for (Corner& x : vertex) {
    for (int k = 0; k < 3; ++k)
      x[k] = static_cast<float>(coarse ? chance.below(places) : 2 * chance.number() - 1);
    chance.direction(&x[3], 1);
    if (coarse && !chance.one_in(3)) x[3] = x[4] = 0, x[5] = 1;
    for (int k = 6; k < 8; ++k)
      x[k] = static_cast<float>(coarse_uv ? chance.below(3) / 2.0 : chance.number());
    if (both_zeros)
      for (float& value : x)
        if (value == 0 && chance.one_in(2)) value = -0.0F;
  }
  Soup soup;
  const int triangles = static_cast<int>(vertices * (0.3 + 3 * chance.number()));
  for (int t = 0; t < triangles; ++t) {
    const int near = chance.below(vertices);
    for (int k = 0; k < 3; ++k)
      soup.push_back(vertex[static_cast<std::size_t>(
          chance.number() < 0.6 ? (near + chance.below(5)) % vertices : chance.below(vertices))]);
  }
  return soup;
}

/// A wavy grid with random diagonals; some uvs are one and the same, some triangles twice, turned round or
/// without area.
inline Soup wavy_grid(std::uint32_t seed, int n) {
  Chance chance(seed);
  std::vector<Corner> vertex(static_cast<std::size_t>((n + 1) * (n + 1)));
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      Corner& x = vertex[static_cast<std::size_t>(j * (n + 1) + i)];
      x[0] = static_cast<float>(i + 0.3 * (chance.number() - 0.5));
      x[1] = static_cast<float>(j + 0.3 * (chance.number() - 0.5));
      x[2] = static_cast<float>(0.3 * chance.number());
      chance.direction(&x[3], 0.2);
      x[6] = static_cast<float>(i) / static_cast<float>(n),
      x[7] = static_cast<float>(j) / static_cast<float>(n);
      if (chance.one_in(20)) x[6] = x[7] = 0.5F;
    }
  std::vector<std::array<int, 3>> triangles;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int p = j * (n + 1) + i, q = p + n + 1;
      if (chance.one_in(2))
        triangles.insert(triangles.end(), {{p, p + 1, q + 1}, {p, q + 1, q}});
      else
        triangles.insert(triangles.end(), {{p, p + 1, q}, {p + 1, q + 1, q}});
      if (chance.one_in(10)) triangles.push_back({p, p + 1, q});
      if (chance.one_in(20)) triangles.push_back({p, p, p + 1});
      if (chance.one_in(10)) std::swap(triangles.back()[0], triangles.back()[1]);
    }
  if (!chance.one_in(3))
    for (std::size_t k = triangles.size(); k > 1; --k)
      std::swap(triangles[k - 1], triangles[static_cast<std::size_t>(chance.below(static_cast<int>(k)))]);
  Soup soup;
  for (const auto& triangle : triangles)
    for (const int v : triangle) soup.push_back(vertex[static_cast<std::size_t>(v)]);
  return soup;
}

constexpr std::uint32_t generated_meshes = 220;
inline Soup generated_mesh(std::uint32_t k) {
  return k % 2 == 0 ? random_soup(k + 1, 4 + static_cast<int>(k) % 28)
                    : wavy_grid(k + 1, 2 + static_cast<int>(k) % 5);
}

}  // namespace darboux::test
