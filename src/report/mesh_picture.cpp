#include "mesh_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include <darboux/vector.h>

#include "base/base64.h"
#include "html.h"

namespace darboux {
namespace {

using Json = nlohmann::ordered_json;

// For numbers of any size: half the difference of two doubles is finite.
struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double x) {
    low = std::fmin(low, x);
    high = std::fmax(high, x);
  }
  double half() const { return high / 2 - low / 2; }
  // From 0 to `most`.
  std::uint16_t share(double x, int most) const {
    return half() > 0 ? static_cast<std::uint16_t>(std::lround(most * ((x / 2 - low / 2) / half()))) : 0;
  }
};

template <class T>
std::string packed(const std::vector<T>& values) {
  return base64({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
}

}  // namespace

Json mesh_picture(const Mesh& mesh, const PictureOf& of) {
  const std::size_t all = of.triangles.empty() ? mesh.triangles.size() : of.triangles.size();
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  std::vector<std::uint32_t> vertices, corners;
  std::vector<float> errors;
  for (std::size_t i = 0; i < all; i += of.step) {
    const Triangle& triangle = mesh.triangles[of.triangles.empty() ? i : of.triangles[i]];
    if (std::any_of(triangle.begin(), triangle.end(),
                    [&](std::uint32_t v) { return !detail::finite(mesh.positions[v]); }))
      continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [at, is_new] = number.try_emplace(triangle[k], static_cast<std::uint32_t>(vertices.size()));
      if (is_new) {
        vertices.push_back(triangle[k]);
        errors.push_back(std::numeric_limits<float>::quiet_NaN());
      }
      corners.push_back(at->second);
      errors[at->second] = std::fmax(errors[at->second], of.errors_deg[3 * i + k]);
    }
  }

  std::array<Interval, 3> box;
  std::array<Interval, 2> square;
  for (Interval& range : square) range = {0, 1};
  for (const std::uint32_t v : vertices) {
    const Vec3<double>& p = mesh.positions[v];
    box[0].add(p.x);
    box[1].add(p.y);
    box[2].add(p.z);
    if (mesh.uvs.empty() || !detail::finite(mesh.uvs[v])) continue;
    square[0].add(mesh.uvs[v].x);
    square[1].add(mesh.uvs[v].y);
  }
  std::vector<std::uint16_t> places, uvs;
  std::vector<std::uint8_t> levels;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::uint32_t v = vertices[i];
    const Vec3<double>& p = mesh.positions[v];
    for (const auto& [range, x] : {std::pair{box[0], p.x}, {box[1], p.y}, {box[2], p.z}})
      places.push_back(range.share(x, 0xffff));
    if (!mesh.uvs.empty()) {
      const bool finite = detail::finite(mesh.uvs[v]);
      uvs.push_back(finite ? square[0].share(mesh.uvs[v].x, 0xfffe) : 0xffff);
      uvs.push_back(finite ? square[1].share(mesh.uvs[v].y, 0xfffe) : 0xffff);
    }
    levels.push_back(std::isnan(errors[i]) ? 255
                                           : static_cast<std::uint8_t>(
                                                 std::lround(254 * std::fmin(errors[i] / of.limit_deg, 1))));
  }

  // The script needs only the shape of the box.
  const double largest = std::fmax(std::fmax(box[0].half(), box[1].half()), box[2].half());
  Json shape = Json::array();
  for (const Interval& range : box) shape.push_back(largest > 0 ? range.half() / largest : 0);
  Json result{{"vertices", vertices.size()},
              {"shape", shape},
              {"places", packed(places)},
              {"errors", packed(levels)}};
  result["triangles"] = vertices.size() <= 0x10000
                            ? packed(std::vector<std::uint16_t>(corners.begin(), corners.end()))
                            : packed(corners);
  if (!uvs.empty()) {
    result["uvs"] = packed(uvs);
    result["square"] = {square[0].low, square[0].high, square[1].low, square[1].high};
  }
  return result;
}

std::vector<std::size_t> picture_steps(const std::vector<std::size_t>& triangles, std::size_t most) {
  // The number of triangles that each of the largest may have, once the smaller ones have all of theirs.
  std::vector<std::size_t> sorted = triangles;
  std::sort(sorted.begin(), sorted.end());
  std::size_t left = most, share = std::numeric_limits<std::size_t>::max();
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const std::size_t fair = left / (sorted.size() - i);
    if (sorted[i] > fair) {
      share = std::max<std::size_t>(fair, 1);
      break;
    }
    left -= sorted[i];
  }
  std::vector<std::size_t> steps;
  for (const std::size_t n : triangles) steps.push_back(n <= share ? 1 : (n + share - 1) / share);
  return steps;
}

}  // namespace darboux
