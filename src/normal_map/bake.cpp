#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <darboux/bake.h>
#include <darboux/error.h>
#include <darboux/frame.h>

#include "base/degrees.h"
#include "base/parallel.h"
#include "base/text.h"
#include "normal_map/corners.h"
#include "normal_map/covered.h"
#include "normal_map/frames.h"
#include "normal_map/points_inside.h"
#include "normal_map/sampler.h"
#include "normal_map/texels.h"
#include "normal_map/wrap.h"

namespace darboux {
namespace {

void check(const BakeOptions& options) {
  const auto expect = [](bool good, const char* name, const char* expected, const std::string& got) {
    if (!good) throw ParameterError(name, expected_got(expected, got));
  };
  const double texels = static_cast<double>(options.width) * options.height;
  expect(options.width >= 1 && options.height >= 1 && texels <= 0x1p28, "size", "1 to 2^28 texels",
         std::to_string(options.width) + " x " + std::to_string(options.height));
  expect(options.basis != MapBasis::analytic, "basis", "stored or mikktspace, those that a mesh has",
         "analytic");
  expect(options.threads >= 0, "threads", "0, all, or more", std::to_string(options.threads));
  expect(options.samples >= 0 && options.samples <= 10000, "samples", "0 to 10000 per triangle",
         std::to_string(options.samples));
}

// A texel has one normal, so a uv outside the map must give the same normal as the one inside.
void check_uvs(const PlacedSurface& surface, const MapPiece& piece) {
  check_consistent(piece.mesh, normal_map::name_of(piece));
  if (piece.mesh.uvs.empty()) return;  // which convert_normal_map() refuses
  constexpr double radians = 1e-4;     // of a fitted uv convention
  const auto inside = [](double x, MapWrap wrap) {
    if (x >= 0 && x <= 1) return x;
    const double of_two = x - 2 * std::floor(x / 2);
    return wrap == MapWrap::mirror ? std::fmin(of_two, 2 - of_two) : x - std::floor(x);
  };
  const auto check_one = [&](const Vec2<double>& uv) {
    const Vec2<double> there{piece.wrap[0] == MapWrap::clamp ? uv.x : inside(uv.x, piece.wrap[0]),
                             piece.wrap[1] == MapWrap::clamp ? uv.y : inside(uv.y, piece.wrap[1])};
    if (there == uv) return;
    if (angle_between(normal_map::normal_at(surface, uv), normal_map::normal_at(surface, there)) > radians)
      throw MeshError(normal_map::name_of(piece),
                      expected_got("uvs from 0 to 1, or a surface that repeats as the map does",
                                   "(" + rounded(uv.x, 4) + ", " + rounded(uv.y, 4) + ")"));
  };
  std::vector<bool> seen(piece.mesh.uvs.size());  // of corners: vertices that no triangle uses do not matter
  for (const Triangle& triangle : piece.mesh.triangles)
    for (const std::uint32_t v : triangle) {
      if (!seen[v]) check_one(piece.mesh.uvs[v]);
      seen[v] = true;
    }
}

// Whether the normals are passed as signed floats: convert_normal_map() encodes floats of input and output
// alike.
bool signed_floats(const BakeOptions& options) {
  return options.signed_floats || options.type != SampleType::f32;
}

// The surface's normals in the mesh's space, one per texel: from -1 to 1 or, if floats are to be written in
// that form, from 0 to 1.
Image normals_of(const PlacedSurface& surface, bool v_up, const BakeOptions& options) {
  Image image(options.width, options.height, 3, SampleType::f32);
  auto& samples = std::get<2>(image.samples);
  const auto width = static_cast<std::size_t>(options.width);
  parallel_ranges(
      static_cast<std::size_t>(options.height), thread_count(options.threads),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
          for (std::size_t x = 0; x < width; ++x) {
            const double down = (static_cast<double>(y) + 0.5) / options.height;
            const Vec3<double> n = normal_map::normal_at(
                surface, {(static_cast<double>(x) + 0.5) / options.width, v_up ? 1 - down : down});
            float* to = &samples[3 * (y * width + x)];
            const std::array<double, 3> numbers{n.x, n.y, n.z};
            for (std::size_t c = 0; c < 3; ++c)
              to[c] = static_cast<float>(signed_floats(options) ? numbers[c] : (numbers[c] + 1) / 2);
          }
      },
      16);
  return image;
}

struct Angles {
  std::vector<double> without, with;
};
using AnglesByClass = std::array<Angles, vertex_class_names.size()>;

template <class Frames>
void look_at(const PlacedSurface& surface, const MapPiece& piece, const BakeResult& result,
             const BakeOptions& options, AnglesByClass& angles) {
  const normal_map::Corners corners(piece, options.basis, options.threads);
  const normal_map::Sampler sampler(result.map.image, piece, options.signed_floats, options.green);
  normal_map::each_point_inside(
      surface, piece.mesh, options.samples, options.seed, [&](std::size_t triangle, VertexClass lowest) {
        return [&, frames = Frames(corners.of(triangle), piece.scale),
                lowest](const normal_map::PointInside& point) mutable {
          frames.start_row(point.weights);
          const Vec3<double> shaded = normal_map::times(frames.at(0), sampler.at(point.uv));
          const double without = angle_between(point.normal, point.truth) * degrees_per_radian,
                       with = angle_between(shaded, point.truth) * degrees_per_radian;
          if (!std::isfinite(without) || !std::isfinite(with)) return;
          angles[static_cast<std::size_t>(lowest)].without.push_back(without);
          angles[static_cast<std::size_t>(lowest)].with.push_back(with);
        };
      });
}

BakeError summed_up(Angles& angles) {
  BakeError error;
  error.samples = angles.with.size();
  error.without_map_deg = summarise(angles.without);
  error.with_map_deg = summarise(angles.with);
  return error;
}

}  // namespace

BakeResult bake_normal_map(const AnySurface& surface, std::span<const MapPiece> pieces,
                           const BakeOptions& options) {
  return bake_normal_map(PlacedSurface{surface}, pieces, options);
}

BakeResult bake_normal_map(const PlacedSurface& surface, std::span<const MapPiece> pieces,
                           const BakeOptions& options) {
  check(options);
  if (pieces.empty()) throw ParameterError("mesh", expected_got("triangles that the map lies on", "none"));
  for (const MapPiece& piece : pieces) check_uvs(surface, piece);
  NormalMapOptions convert;
  convert.from = MapSpace::object;
  convert.to = MapSpace::tangent;
  convert.basis = options.basis;
  convert.decode = options.decode;
  convert.green = options.green;
  convert.type = options.type;
  convert.dither = options.dither;
  convert.dilate = options.dilate;
  convert.threads = options.threads;
  convert.progress = options.progress;
  convert.signed_floats = signed_floats(options);
  BakeResult result;
  result.map = convert_normal_map(normals_of(surface, pieces.front().v_up, options), pieces, convert);
  // Per channel: half a code by rounding, a whole one by dithering, neither for floats.
  const double off = options.type == SampleType::f32
                         ? 0x1p-24
                         : (options.dither ? 2 : 1) / normal_map::most_of(options.type);
  result.bound_deg =
      std::asin(std::fmin(1, result.map.condition * (std::sqrt(3.0) * off + 0x1p-23))) * degrees_per_radian;
  if (result.map.conflicts != 0) return result;
  AnglesByClass angles;
  for (const MapPiece& piece : pieces)
    if (options.decode == MapDecode::mikktspace)
      look_at<normal_map::MikkFrames>(surface, piece, result, options, angles);
    else
      look_at<normal_map::ViewerFrames>(surface, piece, result, options, angles);
  Angles all;
  for (std::size_t k = 0; k < angles.size(); ++k) {
    all.without.insert(all.without.end(), angles[k].without.begin(), angles[k].without.end());
    all.with.insert(all.with.end(), angles[k].with.begin(), angles[k].with.end());
    result.errors[k] = summed_up(angles[k]);
  }
  result.all = summed_up(all);
  return result;
}

}  // namespace darboux
