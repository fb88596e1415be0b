/// \file second_opinion.h
/// Classes and statistics of a mesh beside those of validate(): another reader, long double, angles by
/// another formula, and classes pair by pair from their definitions.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <darboux/mesh_classes.h>
#include <darboux/statistics.h>

#include "second_reader.h"

namespace darboux::test {

using Real = long double;
using V2 = Eigen::Matrix<Real, 2, 1>;
using V3 = Eigen::Matrix<Real, 3, 1>;
using V4 = Eigen::Matrix<Real, 4, 1>;
inline constexpr Real pi_real = std::numbers::pi_v<Real>;

// ---- a second reader

struct Read {
  std::vector<V3> positions, normals;
  std::vector<V2> uvs;
  std::vector<V4> tangents;
  std::vector<std::array<std::size_t, 3>> triangles;
};

template <class V>
std::vector<V> vectors(const tinygltf::Model& model, const std::string& name) {
  const auto& attributes = model.meshes.at(0).primitives.at(0).attributes;
  std::vector<V> result;
  if (!attributes.contains(name)) return result;
  const int accessor = attributes.at(name);
  result.resize(model.accessors.at(static_cast<std::size_t>(accessor)).count);
  for (std::size_t i = 0; i < result.size(); ++i) {
    Eigen::Matrix<float, V::RowsAtCompileTime, 1> value;
    std::memcpy(value.data(), bytes_of(model, accessor, i), sizeof(float) * V::RowsAtCompileTime);
    result[i] = value.template cast<Real>();
  }
  return result;
}

inline Read second_read(const std::string& path) {
  const tinygltf::Model model = load_second(path);
  Read mesh{vectors<V3>(model, "POSITION"),
            vectors<V3>(model, "NORMAL"),
            vectors<V2>(model, "TEXCOORD_0"),
            vectors<V4>(model, "TANGENT"),
            {}};
  const auto indices = second_indices(model, model.meshes.at(0).primitives.at(0).indices);
  mesh.triangles.resize(indices.size() / 3);
  for (std::size_t c = 0; c < indices.size(); ++c) mesh.triangles[c / 3][c % 3] = indices[c];
  return mesh;
}

// ---- classes and statistics

inline int uv_sign(const Read& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const V2 p = mesh.uvs[b] - mesh.uvs[a], q = mesh.uvs[c] - mesh.uvs[a];
  const Real area = p.x() * q.y() - p.y() * q.x();
  return area > 0 ? 1 : area < 0 ? -1 : 0;
}

inline std::vector<VertexClass> classes_of(const Read& mesh, const std::vector<bool>& pole) {
  const std::size_t n = mesh.positions.size();
  std::vector<int> sign(n, 0);
  std::vector<bool> used(n, false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::size_t v : mesh.triangles[t]) {
      used[v] = true;
      if (uv_sign(mesh, t) != 0) sign[v] = uv_sign(mesh, t);
    }
  // No two numbers of these meshes are nearly 1e-6 of the range apart, and their ranges are about 1.
  const auto same = [](const auto& a, const auto& b) { return (a - b).cwiseAbs().maxCoeff() < 1e-6L; };
  std::vector<std::size_t> order(n), place(n);
  for (std::size_t v = 0; v < n; ++v) order[v] = place[v] = v;
  std::ranges::sort(order, {}, [&](std::size_t v) { return mesh.positions[v].x(); });
  std::vector<bool> seam(n, false), crease(n, false);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      const std::size_t v = order[i], w = order[j];
      if (mesh.positions[w].x() - mesh.positions[v].x() > 1e-6L) break;
      if (!used[v] || !used[w] || !same(mesh.positions[v], mesh.positions[w])) continue;
      place[v] = place[w] = std::min(place[v], place[w]);
      if (!same(mesh.normals[v], mesh.normals[w]))
        crease[v] = crease[w] = true;
      else if (!same(mesh.uvs[v], mesh.uvs[w]) || sign[v] * sign[w] < 0)
        seam[v] = seam[w] = true;
    }
  for (std::size_t v = 0; v < n; ++v)
    while (place[v] != place[place[v]]) place[v] = place[place[v]];
  std::map<std::pair<std::size_t, std::size_t>, int> triangles_at;
  std::vector<bool> ring(n, false), border(n, false);
  for (const auto& triangle : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax({place[triangle[k]], place[triangle[(k + 1) % 3]]});
      if (a != b) ++triangles_at[{a, b}];
      if (pole[triangle[k]])
        for (const std::size_t v : triangle) ring[place[v]] = true;
    }
  for (const auto& [edge, count] : triangles_at)
    if (count == 1) border[edge.first] = border[edge.second] = true;
  std::vector<VertexClass> classes;
  for (std::size_t v = 0; v < n; ++v)
    classes.push_back(pole[v]            ? VertexClass::pole
                      : seam[v]          ? VertexClass::seam
                      : crease[v]        ? VertexClass::crease
                      : ring[place[v]]   ? VertexClass::pole_ring
                      : border[place[v]] ? VertexClass::border
                                         : VertexClass::interior);
  return classes;
}

inline Real degrees(const V3& a, const V3& b) {
  const V3 p = a.normalized(), q = b.normalized();
  return 2 * std::atan2((p - q).norm(), (p + q).norm()) * 180 / pi_real;
}

struct Directions {
  V3 t, b, n;  // of P_u and P_v, not of unit length
};

struct OfClass {
  std::size_t corners = 0;
  std::vector<Real> normal, tangent, bitangent;
};

// \param counts which triangles are looked at
inline std::map<VertexClass, OfClass> second_opinion(const Read& mesh, const std::vector<Directions>& truth,
                                                     const std::vector<bool>& pole,
                                                     const std::function<bool(std::size_t)>& counts) {
  const auto tangent = [&](std::size_t v) { return V3(mesh.tangents[v].head<3>()); };
  std::ptrdiff_t raw = 0;
  for (std::size_t t = 0; t < mesh.triangles.size() && !mesh.tangents.empty(); ++t)
    for (const std::size_t v : mesh.triangles[t])
      if (counts(t) && !tangent(v).isZero(0)) raw += uv_sign(mesh, t) * (mesh.tangents[v].w() > 0 ? 1 : -1);
  const std::vector<VertexClass> classes = classes_of(mesh, pole);
  std::map<VertexClass, OfClass> result;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::size_t v : mesh.triangles[t]) {
      if (!counts(t)) continue;
      OfClass& c = result[classes[v]];
      ++c.corners;
      c.normal.push_back(degrees(mesh.normals[v], truth[v].n));
      if (mesh.tangents.empty() || tangent(v).isZero(0)) continue;
      c.tangent.push_back(degrees(tangent(v), truth[v].t));
      const Real w = (raw > 0 ? 1 : -1) * mesh.tangents[v].w();
      c.bitangent.push_back(degrees(w * mesh.normals[v].cross(tangent(v)), truth[v].b));
    }
  return result;
}

// \param slack what rounding may add
inline void expect_same(const std::optional<Statistics>& found, std::vector<Real> angles, double slack,
                        const std::string& what) {
  ASSERT_EQ(found.has_value(), !angles.empty()) << what;
  if (!found) return;
  std::ranges::sort(angles);
  Real sum = 0;
  for (const Real x : angles) sum += x * x;
  const auto near = [&](double value, Real expected, const char* name) {
    EXPECT_NEAR(value, static_cast<double>(expected), 1e-6 * static_cast<double>(expected) + slack)
        << what << ", " << name;
  };
  near(found->max, angles.back(), "max");
  near(found->rms, std::sqrt(sum / static_cast<Real>(angles.size())), "rms");
  near(found->p95, angles[(95 * angles.size() + 99) / 100 - 1], "p95");
}

}  // namespace darboux::test
