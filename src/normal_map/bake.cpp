#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <darboux/bake.h>
#include <darboux/error.h>
#include <darboux/frame.h>

#include "base/parallel.h"
#include "base/text.h"
#include "normal_map/corners.h"
#include "normal_map/frames.h"
#include "normal_map/sampler.h"
#include "normal_map/texels.h"

namespace darboux {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

void check(const BakeOptions& options) {
  const auto expect = [](bool good, const char* name, const char* expected, const std::string& got) {
    if (!good) throw ParameterError(name, expected_got(expected, got));
  };
  const double texels = static_cast<double>(options.width) * options.height;
  expect(options.width >= 1 && options.height >= 1 && texels <= 0x1p28, "size", "1 to 2^28 texels",
         std::to_string(options.width) + " x " + std::to_string(options.height));
  expect(options.basis != MapBasis::analytic, "basis", "stored or mikktspace, those that a mesh has",
         "analytic");
  expect(options.samples >= 0 && options.samples <= 10000, "samples", "0 to 10000 per triangle",
         std::to_string(options.samples));
}

// The surface's normals in the mesh's space, a texel each.
Image normals_of(const AnySurface& surface, bool v_up, const BakeOptions& options) {
  Image image(options.width, options.height, 3, SampleType::f32);
  auto& samples = std::get<2>(image.samples);
  const auto width = static_cast<std::size_t>(options.width);
  parallel_ranges(
      static_cast<std::size_t>(options.height), thread_count(options.threads),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
          for (std::size_t x = 0; x < width; ++x) {
            const double down = (static_cast<double>(y) + 0.5) / options.height;
            const Vec3<double> n =
                surface.frame((static_cast<double>(x) + 0.5) / options.width, v_up ? 1 - down : down).n;
            float* to = &samples[3 * (y * width + x)];
            to[0] = static_cast<float>(n.x);
            to[1] = static_cast<float>(n.y);
            to[2] = static_cast<float>(n.z);
          }
      },
      16);
  return image;
}

struct Angles {
  std::vector<double> without, with;
};
using AnglesByClass = std::array<Angles, vertex_class_names.size()>;

std::vector<bool> poles_of(const AnySurface& surface, const Mesh& mesh) {
  std::vector<bool> result;
  for (const Vec2<double>& uv : mesh.uvs)
    result.push_back(
        has(surface.frame(uv.x, uv.y).status, Status::dpdu_zero | Status::dpdv_zero | Status::parallel));
  return result;
}

template <class Frames>
void look_at(const AnySurface& surface, const MapPiece& piece, const BakeResult& result,
             const BakeOptions& options, AnglesByClass& angles) {
  const Mesh& mesh = piece.mesh;
  const MeshClasses classes = classify(mesh, poles_of(surface, mesh));
  const normal_map::Corners corners(piece, options.basis, options.threads);
  const normal_map::Sampler sampler(result.map.image, piece, true, options.green);
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> uniform;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& triangle = mesh.triangles[i];
    if (classes.island_of_triangle[i] < 0) continue;  // no texel is its own
    const auto of = corners.of(i);
    Frames frames(of);
    const VertexClass lowest = std::min(
        {classes.of_vertex[triangle[0]], classes.of_vertex[triangle[1]], classes.of_vertex[triangle[2]]});
    for (int s = 0; s < options.samples; ++s) {
      const double root = std::sqrt(uniform(random)), share = uniform(random);
      const std::array<double, 3> weights{1 - root, root * (1 - share), root * share};
      Vec2<double> uv{};
      Vec3<double> normal{};
      for (std::size_t k = 0; k < 3; ++k) {
        uv = uv + weights[k] * mesh.uvs[triangle[k]];
        normal += weights[k] * of[k].n;
      }
      const Vec3<double> truth = surface.frame(uv.x, uv.y).n;
      frames.start_row(weights);
      const Vec3<double> shaded = normal_map::times(frames.at(0), sampler.at(uv));
      const double without = angle_between(normal, truth) * degrees,
                   with = angle_between(shaded, truth) * degrees;
      if (!std::isfinite(without) || !std::isfinite(with)) continue;
      angles[static_cast<std::size_t>(lowest)].without.push_back(without);
      angles[static_cast<std::size_t>(lowest)].with.push_back(with);
    }
  }
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
  check(options);
  if (pieces.empty()) throw ParameterError("mesh", expected_got("triangles that the map lies on", "none"));
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
  convert.signed_floats = true;
  BakeResult result;
  result.map = convert_normal_map(normals_of(surface, pieces.front().v_up, options), pieces, convert);
  const double half_code = options.type == SampleType::f32 ? 0x1p-24 : 1 / normal_map::most_of(options.type);
  result.bound_deg =
      std::asin(std::fmin(1, result.map.condition * (std::sqrt(3.0) * half_code + 0x1p-23))) * degrees;
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
