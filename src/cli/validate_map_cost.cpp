// `validate --normal-map`: what a normal map would leave of the error of a mesh on a known surface.
#include <iomanip>
#include <iostream>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include <darboux/error.h>

#include "map_arguments.h"
#include "validate_files.h"

namespace darboux {
namespace {

struct Stage {
  const char* key;
  Statistics MapCostStages::*angles;
  const char* text;
};
constexpr Stage stages[] = {{"triangle_deg", &MapCostStages::triangle_deg, "flat triangles"},
                            {"normal_deg", &MapCostStages::normal_deg, "their normals interpolated"},
                            {"frame_deg", &MapCostStages::frame_deg, "a map in the stored frames"},
                            {"texel_deg", &MapCostStages::texel_deg, "in texels"},
                            {"codes16_deg", &MapCostStages::codes16_deg, "in 16 bits"},
                            {"codes8_deg", &MapCostStages::codes8_deg, "in 8 bits"}};
constexpr std::size_t with_texels = 3;

// Removes the vertices that no triangle uses.
void drop_unused_vertices(Mesh& mesh) {
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  Mesh kept;
  kept.triangles = std::move(mesh.triangles);
  kept.half_steps = mesh.half_steps;
  std::vector<std::uint32_t> place(mesh.positions.size(), none);
  const auto take = [](const auto& from, auto& to, std::uint32_t v) {
    if (!from.empty()) to.push_back(from[v]);
  };
  for (Triangle& triangle : kept.triangles)
    for (std::uint32_t& v : triangle) {
      if (place[v] == none) {
        place[v] = static_cast<std::uint32_t>(kept.positions.size());
        take(mesh.positions, kept.positions, v);
        take(mesh.normals, kept.normals, v);
        take(mesh.uvs, kept.uvs, v);
        take(mesh.tangents, kept.tangents, v);
      }
      v = place[v];
    }
  mesh = std::move(kept);
}

// The triangles of an assessment, with tangent signs in the glTF convention.
MapPiece piece_of(const Primitive& primitive, const Assessment& assessment) {
  MapPiece piece{.mesh = primitive.data, .mesh_index = primitive.mesh, .primitive = primitive.primitive};
  if (!assessment.triangles.empty()) {
    piece.mesh.triangles.clear();
    for (const std::uint32_t i : assessment.triangles)
      piece.mesh.triangles.push_back(primitive.data.triangles[i]);
  }
  drop_unused_vertices(piece.mesh);
  if (assessment.report.handedness.convention == HandednessConvention::raw)
    for (Vec4<double>& t : piece.mesh.tangents) t.w = -t.w;
  return piece;
}

Json stages_json(const MapCostStages& of, bool with_map) {
  Json json{{"samples", of.samples}};
  for (std::size_t k = 0; k < std::size(stages); ++k)
    json[stages[k].key] = k < with_texels || with_map ? statistics_json(of.*stages[k].angles) : Json();
  return json;
}

}  // namespace

std::optional<MapCostOptions> map_cost_options(const std::string& size, const ReadOptions& read) {
  if (size.empty()) return std::nullopt;
  MapCostOptions options;
  std::tie(options.width, options.height) = parse_grid("--normal-map", size);
  const std::uint64_t texels =
      static_cast<std::uint64_t>(options.width) * static_cast<std::uint64_t>(options.height);
  if (texels > std::uint64_t{1} << 28)
    throw ParameterError(
        "--normal-map", expected_got("1 to 2^28 texels",
                                     std::to_string(options.width) + " x " + std::to_string(options.height)));
  // In addition to the final 8-bit map: the maps of floats and of 16 bits, and the surface's normals.
  constexpr std::uint64_t there = 3 * (2 * sizeof(float) + sizeof(std::uint16_t));
  check_map_memory("--normal-map", there * texels, texels, 3, SampleType::u8, read);
  return options;
}

AssessedMapCost map_cost_of(const Primitive& primitive, const Assessment& assessment,
                            const MapCostOptions& options) {
  AssessedMapCost none{.why = "no surface is known through these uvs"};
  const Mesh& mesh = primitive.data;
  if (!assessment.fit || !assessment.fit->fits || assessment.fit->chart != UvChart::own || mesh.uvs.empty() ||
      mesh.normals.empty())
    return none;
  const MapPiece piece = piece_of(primitive, assessment);
  // Not if the tangents follow other uvs.
  if (!(rms_relative(assessment.fit->surface, std::span(&piece, 1)) <= corners_fit_below)) return none;
  try {
    return {.cost = normal_map_cost(assessment.fit->surface, piece, options)};
  } catch (const MeshError& e) {
    return {.why = e.what()};
  }
}

Json map_cost_json(const std::optional<MapCost>& cost) {
  if (!cost) return nullptr;
  const bool with_map = cost->conflicts == 0;
  Json json = stages_json(cost->all, with_map);
  json["conflicts"] = cost->conflicts;
  json["classes"] = Json::object();
  for (std::size_t c = 0; c < cost->classes.size(); ++c)
    if (cost->classes[c].samples != 0)
      json["classes"][std::string(vertex_class_names[c])] = stages_json(cost->classes[c], with_map);
  return json;
}

void print_map_cost(const AssessedMapCost& of) {
  const std::optional<MapCost>& cost = of.cost;
  if (!cost) {
    std::cout << "    normal map: " << of.why << '\n';
    return;
  }
  std::cout << "    normal map, degrees off the surface's normals     rms      max\n";
  for (std::size_t k = 0; k < std::size(stages) && (k < with_texels || cost->conflicts == 0); ++k) {
    const Statistics& angles = cost->all.*stages[k].angles;
    std::cout << "      " << std::left << std::setw(42) << stages[k].text << std::right << std::setw(9)
              << rounded(angles.rms, 3) << std::setw(9) << rounded(angles.max, 3) << '\n';
  }
  if (cost->conflicts != 0)
    std::cout << "      " << cost->conflicts
              << " texels need two different values: no single map holds both\n";
}

}  // namespace darboux
