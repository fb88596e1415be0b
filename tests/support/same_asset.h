/// \file same_asset.h
/// Whether two files were read as the same, to the bit.
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/io.h>

namespace darboux::test {

/// The bits of every number, so that NaN compares too.
template <class Vector>
std::vector<std::uint64_t> bits_of(const std::vector<Vector>& values) {
  std::vector<std::uint64_t> bits;
  const auto add = [&](double x) { bits.push_back(std::bit_cast<std::uint64_t>(x)); };
  for (const Vector& a : values) {
    add(a.x);
    add(a.y);
    if constexpr (requires { a.z; }) add(a.z);
    if constexpr (requires { a.w; }) add(a.w);
  }
  return bits;
}

inline void expect_same_mesh(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(bits_of(a.positions), bits_of(b.positions));
  EXPECT_EQ(bits_of(a.normals), bits_of(b.normals));
  EXPECT_EQ(bits_of(a.uvs), bits_of(b.uvs));
  EXPECT_EQ(bits_of(a.tangents), bits_of(b.tangents));
  EXPECT_EQ(a.triangles, b.triangles);
}

inline void expect_same_asset(const Asset& a, const Asset& b) {
  ASSERT_EQ(a.primitives.size(), b.primitives.size());
  ASSERT_EQ(a.skipped.size(), b.skipped.size());
  for (std::size_t i = 0; i < a.primitives.size(); ++i) {
    SCOPED_TRACE("primitive " + std::to_string(i));
    const Primitive &p = a.primitives[i], &q = b.primitives[i];
    EXPECT_EQ(p.mesh, q.mesh);
    EXPECT_EQ(p.primitive, q.primitive);
    EXPECT_EQ(p.name, q.name);
    EXPECT_EQ(p.texcoord, q.texcoord);
    EXPECT_EQ(p.needs_tangents, q.needs_tangents);
    EXPECT_EQ(p.instances, q.instances);
    expect_same_mesh(p.data, q.data);
  }
}

}  // namespace darboux::test
