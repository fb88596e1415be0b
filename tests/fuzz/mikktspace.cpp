// MikkTSpace over arbitrary triangles. Of small numbers t and b are unit or zero, lengths are finite; of any,
// they are what mikktspace.h says of rounding and of the ends of the range. Signs are ±1; threads and lanes
// change no bit.
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <numbers>
#include <span>

#include <darboux/mikktspace.h>

#include "support.h"

namespace {

using namespace darboux;

// Unit, or zero; of any numbers also not finite, with no component above the least normal float, or, where
// few bits of a square are left, of a length from 0.7 to 1.23.
bool is_direction(const float (&a)[3], bool small) {
  const double length = std::hypot(a[0], a[1], a[2]);
  if (std::fabs(length - 1) < 3e-7 || length == 0) return true;
  if (small) return false;
  return !std::isfinite(length) || (length > 0.7 && length < 1.23) ||
         std::all_of(a, a + 3, [](float x) { return std::fabs(x) <= FLT_MIN; });
}

// The largest |dpdu| and |dpdv| of the triangles, for uv areas as small as rounding may have them.
struct Largest {
  double s = 0, t = 0;
};
Largest largest_derivatives(const MikkMesh& mesh) {
  Largest largest;
  const auto vertex = [&](std::size_t c) { return mesh.corners.empty() ? c : mesh.corners[c]; };
  for (std::size_t c = 0; c < mesh.corner_count(); c += 3) {
    const auto difference = [&](std::span<const float> of, std::size_t size, std::size_t corner,
                                std::size_t k) {
      return double{of[size * vertex(c + corner) + k]} - double{of[size * vertex(c) + k]};
    };
    double d[3], u[3], v[3];
    for (std::size_t k = 1; k < 3; ++k) {
      const auto edge = [&](std::size_t i) { return difference(mesh.positions, 3, k, i); };
      d[k] = std::hypot(edge(0), edge(1), edge(2));
      u[k] = std::fabs(difference(mesh.uvs, 2, k, 0)), v[k] = std::fabs(difference(mesh.uvs, 2, k, 1));
    }
    const double area = 0x1p-25 * std::max(u[1] * v[2], v[1] * u[2]);
    if (area == 0) continue;
    largest.s = std::max(largest.s, (v[2] * d[1] + v[1] * d[2]) / area);
    largest.t = std::max(largest.t, (u[1] * d[2] + u[2] * d[1]) / area);
  }
  return largest;
}

// Not negative; finite, unless the sum over all corners may leave the range: by up to pi for each, and 16 for
// the rounding of squares near the end of the range.
bool is_length(float length, double largest, std::size_t corners) {
  if (std::isfinite(length)) return length >= 0;
  return !(length < 0) && 16 * std::numbers::pi * static_cast<double>(corners) * largest > double{FLT_MAX};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
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
    const Largest largest = largest_derivatives(mesh);
    for (const MikkTangent& a : result) {
      fuzz::expect(is_direction(a.t, small), "t is unit or zero");
      fuzz::expect(is_direction(a.b, small), "b is unit or zero");
      fuzz::expect(a.sign == 1 || a.sign == -1, "signs are 1 or -1");
      if (!a.served) continue;  // the lengths stand for nothing
      fuzz::expect(is_length(a.t_length, largest.s, result.size()),
                   "t_length is finite unless dpdu is beyond float");
      fuzz::expect(is_length(a.b_length, largest.t, result.size()),
                   "b_length is finite unless dpdv is beyond float");
    }
    MikkOptions two;
    two.threads = 2;
    std::vector<float> one(4 * result.size()), other(one.size());
    mikktspace(mesh, one);
    mikktspace(mesh, other, two);
    const auto same = [](float a, float b) {
      return std::memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b);
    };
    for (std::size_t c = 0; c < result.size(); ++c) {
      for (std::size_t k = 0; k < 3; ++k)
        fuzz::expect(same(one[4 * c + k], result[c].t[k]), "tangents in full are those in four");
      fuzz::expect(one[4 * c + 3] == result[c].sign, "signs in full are those in four");
    }
    fuzz::expect(one.empty() || std::memcmp(one.data(), other.data(), 4 * one.size()) == 0,
                 "threads change no bit");
  });
  return 0;
}
