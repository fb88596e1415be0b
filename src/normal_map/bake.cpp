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

// Whether the normals are handed over as they are: convert_normal_map() codes floats of input and output
// alike.
bool signed_floats(const BakeOptions& options) {
  return options.signed_floats || options.type != SampleType::f32;
}

// The surface's normals in the mesh's space, a texel each: from -1 to 1, or, where floats are to be written
// so, from 0 to 1.
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
  const normal_map::Sampler sampler(result.map.image, piece, options.signed_floats, options.green);
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> uniform;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& triangle = mesh.triangles[i];
    if (classes.island_of_triangle[i] < 0) continue;  // no texel is its own
    const auto of = corners.of(i);
    Frames frames(of, piece.scale);
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
  convert.signed_floats = signed_floats(options);
  BakeResult result;
  result.map = convert_normal_map(normals_of(surface, pieces.front().v_up, options), pieces, convert);
  // In each channel: half a code by rounding, a whole one by dithering, which floats do not have.
  const double off = options.type == SampleType::f32
                         ? 0x1p-24
                         : (options.dither ? 2 : 1) / normal_map::most_of(options.type);
  result.bound_deg =
      std::asin(std::fmin(1, result.map.condition * (std::sqrt(3.0) * off + 0x1p-23))) * degrees;
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
