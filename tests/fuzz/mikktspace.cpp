// MikkTSpace over arbitrary triangles. Tangents are finite and unit or zero, signs are ±1; threads change no
// bit.
#include <cmath>

#include <darboux/mikktspace.h>

#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  fuzz::Bytes bytes(data, size);
  const std::size_t vertices = bytes.take<std::uint8_t>() % 24,
                    corners = 3 * (bytes.take<std::uint8_t>() % 24);
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < corners; ++i)
    indices.push_back(bytes.take<std::uint8_t>() % 25);  // one of 24 is not there
  std::vector<float> positions, normals, uvs;
  // Halves: small numbers, so that triangles meet; else any bits.
  const bool small = bytes.take<std::uint8_t>() % 2 == 0;
  const auto number = [&] {
    return small ? 0.25f * static_cast<float>(bytes.take<std::int8_t>() % 5) : bytes.take<float>();
  };
  for (std::size_t i = 0; i < vertices; ++i) {
    for (int k = 0; k < 3; ++k) positions.push_back(number());
    for (int k = 0; k < 2; ++k) uvs.push_back(number());
    float n[3] = {number(), number(), number()};
    const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (const float x : n) normals.push_back(small && length > 0 ? x / length : x);
  }
  const MikkMesh mesh{positions, normals, uvs, indices, {}};
  fuzz::may_refuse([&] {
    const std::vector<MikkTangent> result = mikktspace(mesh);
    fuzz::expect(result.size() == mesh.corner_count(), "a tangent per corner");
    for (const MikkTangent& a : result) {
      const double length =
          std::sqrt(double{a.t[0]} * a.t[0] + double{a.t[1]} * a.t[1] + double{a.t[2]} * a.t[2]);
      fuzz::expect(std::isfinite(length) && (length == 0 || std::fabs(length - 1) < 1e-3),
                   "t is unit or zero");
      fuzz::expect(a.sign == 1 || a.sign == -1, "signs are 1 or -1");
      fuzz::expect(!small || (std::isfinite(a.t_length) && std::isfinite(a.b_length)), "lengths are finite");
    }
    MikkOptions two;
    two.threads = 2;
    std::vector<float> one(4 * result.size()), other(one.size());
    mikktspace(mesh, one);
    mikktspace(mesh, other, two);
    fuzz::expect(one.empty() || std::memcmp(one.data(), other.data(), 4 * one.size()) == 0,
                 "threads change no bit");
  });
  return 0;
}
