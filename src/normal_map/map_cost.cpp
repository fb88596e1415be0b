#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <darboux/bake.h>
#include <darboux/frame.h>
#include <darboux/map_cost.h>

#include "normal_map/corners.h"
#include "normal_map/frames.h"
#include "normal_map/points_inside.h"
#include "normal_map/sampler.h"

namespace darboux {
namespace {

constexpr std::size_t stage_count = 6;
constexpr std::array<Statistics MapCostStages::*, stage_count> stages{
    &MapCostStages::triangle_deg, &MapCostStages::normal_deg,  &MapCostStages::frame_deg,
    &MapCostStages::texel_deg,    &MapCostStages::codes16_deg, &MapCostStages::codes8_deg};
constexpr std::array map_types{SampleType::f32, SampleType::u16, SampleType::u8};

using Angles = std::array<std::vector<double>, stage_count>;

MapCostStages summed_up(Angles& angles, std::size_t count) {
  MapCostStages result;
  result.samples = angles[0].size();
  for (std::size_t k = 0; k < count; ++k) result.*stages[k] = summarise(angles[k]);
  return result;
}

std::vector<Image> maps_of(const PlacedSurface& surface, const MapPiece& piece, const MapCostOptions& options,
                           std::size_t& conflicts) {
  std::vector<Image> maps;
  for (const SampleType type : map_types) {
    BakeOptions bake;
    bake.width = options.width;
    bake.height = options.height;
    bake.basis = MapBasis::mikktspace;
    bake.type = type;
    bake.signed_floats = true;
    bake.samples = 0;
    bake.threads = options.threads;
    BakeResult baked = bake_normal_map(surface, std::span(&piece, 1), bake);
    conflicts = std::max(conflicts, baked.map.conflicts);
    if (conflicts != 0) return {};
    maps.push_back(std::move(baked.map.image));
  }
  return maps;
}

}  // namespace

MapCost normal_map_cost(const PlacedSurface& surface, const MapPiece& piece, const MapCostOptions& options) {
  MapCost cost;
  const std::vector<Image> maps = maps_of(surface, piece, options, cost.conflicts);
  std::vector<normal_map::Sampler> samplers;
  for (const Image& map : maps) samplers.emplace_back(map, piece, true, MapGreen::opengl);
  const std::size_t count = stage_count - map_types.size() + maps.size();
  const Mesh& mesh = piece.mesh;
  const normal_map::Corners made(piece, MapBasis::mikktspace, options.threads),
      stored(piece, mesh.tangents.empty() ? MapBasis::mikktspace : MapBasis::stored, options.threads);
  std::array<Angles, vertex_class_names.size()> angles;
  normal_map::each_point_inside(
      surface, mesh, options.samples, options.seed, [&](std::size_t i, VertexClass lowest) {
        const Triangle& t = mesh.triangles[i];
        const Vec3<double> flat =
            cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
        const Vec3<double> across =
            dot(flat, mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]]) < 0 ? -flat : flat;
        return [&, across, &of_class = angles[static_cast<std::size_t>(lowest)],
                baker = normal_map::MikkFrames(made.of(i), piece.scale),
                viewer = normal_map::MikkFrames(stored.of(i), piece.scale)](
                   const normal_map::PointInside& point) mutable {
          baker.start_row(point.weights);
          viewer.start_row(point.weights);
          const normal_map::Columns frame = viewer.at(0);
          std::array<Vec3<double>, stage_count> shaded{across, point.normal,
                                                       times(frame, inverse_times(baker.at(0), point.truth))};
          for (std::size_t k = 0; k < samplers.size(); ++k)
            shaded[3 + k] = times(frame, samplers[k].at(point.uv));
          std::array<double, stage_count> degrees{};
          for (std::size_t k = 0; k < count; ++k) {
            degrees[k] = angle_between(shaded[k], point.truth) * 180 / std::numbers::pi;
            if (!std::isfinite(degrees[k])) return;
          }
          for (std::size_t k = 0; k < count; ++k) of_class[k].push_back(degrees[k]);
        };
      });
  Angles all;
  for (std::size_t c = 0; c < angles.size(); ++c) {
    for (std::size_t k = 0; k < count; ++k)
      all[k].insert(all[k].end(), angles[c][k].begin(), angles[c][k].end());
    cost.classes[c] = summed_up(angles[c], count);
  }
  cost.all = summed_up(all, count);
  return cost;
}

}  // namespace darboux
