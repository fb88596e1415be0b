// `darboux bake`: the exact normals of a surface as a tangent-space map for a coarse mesh of it.
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <span>
#include <tuple>

#include <darboux/bake.h>

#include "map_arguments.h"

namespace darboux {
namespace {

struct BakeArguments : MapArguments {
  std::string surface, size = "1024x1024", report;
  std::uint64_t samples = 16, seed = 1;
};

Json error_json(std::string_view name, const BakeError& error) {
  return {{"class", name},
          {"samples", error.samples},
          {"without_map_deg", statistics_json(error.without_map_deg)},
          {"with_map_deg", statistics_json(error.with_map_deg)}};
}

// The surface as placed for the mesh, and the distance of its vertices from it at their uvs.
struct Place {
  PlacedSurface surface;
  double rms_relative = 0;  // to the bounding box's diagonal
};

// The surface as it is, if the mesh lies on it; else with the placement and uv convention that fit_surface()
// finds. Its parameters are not fitted. \throws FileError if the mesh does not lie on this surface
Place placed_on(const AnySurface& surface, std::span<const MapPiece> pieces, const std::string& file) {
  const PlacedSurface as_is{surface};
  const auto has_uvs = [](const MapPiece& piece) { return !piece.mesh.uvs.empty(); };
  if (!std::all_of(pieces.begin(), pieces.end(), has_uvs)) return {as_is};  // which is refused
  const double off = rms_relative(as_is, pieces);
  if (!(off > corners_fit_below)) return {as_is, off};
  try {
    const MeshFit fit = fit_surface(pieces[0].mesh, surface);
    const double fitted = rms_relative(fit.surface, pieces);
    if (fit.fits && fitted <= corners_fit_below) return {fit.surface, fitted};
  } catch (const UndeterminedError&) {
  } catch (const MeshError&) {
  }
  throw FileError(
      file, expected_got("a mesh of the surface, its parameters given, as in --surface "
                         "ellipsoid:semi_axis_x=3",
                         std::isinf(off)
                             ? "one at whose uvs the surface has no value"
                             : "one that is off it by " + rounded(100 * off, 3) +
                                   " % of its size (rms) at its uvs, which must be those of the surface: not "
                                   "mirrored, not packed into an atlas"));
}

Json report_json(const BakeArguments& a, const Place& place, const BakeResult& r,
                 std::span<const MapPiece> pieces, const BakeOptions& options) {
  Json classes = Json::array();
  for (std::size_t k = 0; k < r.errors.size(); ++k)
    if (r.errors[k].samples != 0) classes.push_back(error_json(vertex_class_names[k], r.errors[k]));
  Json json{{"file", utf8(a.mesh)},
            {"surface", surface_json(place.surface.surface)},
            {"placement", numbers({place.surface.placement.data(), 16})},
            {"uv", {{"convention", place.surface.uv.name}, {"affine", numbers(place.surface.uv.affine)}}},
            {"rms_relative", number(place.rms_relative)},
            {"output", MapOutputs::none(r.map) ? Json() : Json(utf8(a.output))},
            {"basis", a.basis},
            {"decode", a.decode},
            {"green", a.green},
            {"depth", map_depths.names[static_cast<std::size_t>(options.type)]},
            {"texels", r.map.states.size()}};
  add_counts(json, r.map);
  json["first_conflict"] = conflict_json(r.map, pieces);
  json["bound_deg"] = number(r.bound_deg);
  json["error"] = error_json("all", r.all);
  json["classes"] = std::move(classes);
  return json;
}

void print_errors(const BakeResult& r) {
  std::cout << "degrees off the surface's normal, at points inside triangles\n"
            << "                         without the map       with it\n"
            << "  class        samples      rms      max      rms      max\n";
  const auto row = [](std::string_view name, const BakeError& e) {
    if (e.samples == 0) return;
    std::cout << "  " << std::left << std::setw(10) << name << std::right << std::setw(10) << e.samples;
    for (const double x :
         {e.without_map_deg.rms, e.without_map_deg.max, e.with_map_deg.rms, e.with_map_deg.max})
      std::cout << std::setw(9) << rounded(x, 3);
    std::cout << '\n';
  };
  for (std::size_t k = 0; k < r.errors.size(); ++k) row(vertex_class_names[k], r.errors[k]);
  row("all", r.all);
  if (r.all.with_map_deg.rms > r.all.without_map_deg.rms)
    std::cout << "the map makes these normals worse: --depth 16 helps where 8 bits are too few, --size where "
                 "texels "
                 "are too large\n";
}

void print_text(const BakeArguments& a, const Place& place, const BakeResult& r,
                std::span<const MapPiece> pieces) {
  if (place.surface.uv.name != uv_conventions()[0].name ||
      !place.surface.placement.isApprox(Eigen::Isometry3d::Identity()))
    std::cout << "the surface is fitted to the mesh, uvs " << place.surface.uv.name << '\n';
  std::cout << one_line(a.mesh) << ": " << r.map.covered << " of " << r.map.states.size()
            << " texels covered, " << r.map.dilated << " in the gutter filled\n";
  print_counts(r.map);
  if (r.map.first_conflict) return print_conflict(r.map, pieces);
  if (r.map.covered == 0) return;
  std::cout << "at texels the normals are within " << rounded(r.bound_deg, 3) << " degrees (proven)\n";
  if (r.all.samples != 0) print_errors(r);
  std::cout << a.output << '\n';
}

void run_bake(const BakeArguments& a, Common& common) {
  const auto need = [](const std::string& value, const char* what) {
    if (value.empty()) throw ParameterError("bake", expected_got(what, "none"));
  };
  need(a.surface, "--surface SURFACE");
  need(a.mesh, "--mesh FILE");
  need(a.output, "-o OUT.png");
  check_map_files({{"--mesh", a.mesh}}, a.output, a.report);
  const AnySurface surface = surface_argument(a.surface);
  BakeOptions options;
  std::tie(options.width, options.height) = parse_grid("--size", a.size);
  options.basis = map_bases.of(a.basis);
  options.decode = map_decodes.of(a.decode);
  options.green = map_greens.of(a.green);
  options.type = map_type(a, SampleType::u8);
  options.signed_floats = a.signed_floats;
  options.dither = a.dither;
  options.dilate = static_cast<int>(a.dilate);
  options.samples = static_cast<int>(a.samples);
  options.seed = a.seed;
  options.threads = common.threads;
  const std::uint64_t texels =
      static_cast<std::uint64_t>(options.width) * static_cast<std::uint64_t>(options.height);
  check_map_memory(a.output, 3 * sizeof(float) * texels, texels, 3, options.type, common.read);
  MapOutputs outputs(a.output, a.report);
  const std::vector<MapPiece> pieces = map_pieces(a, common, false);
  const Place place = placed_on(surface, pieces, a.mesh);
  BakeResult result;
  {
    Progress progress("bake", common);
    options.progress = [&](double share) { progress.update(share); };
    result = naming_the_mesh(a.mesh, [&] { return bake_normal_map(place.surface, pieces, options); });
  }
  outputs.write(result.map, options.width, options.height);
  if (MapOutputs::none(result.map)) common.exit_status = 1;
  if (common.json)
    print_json(report_json(a, place, result, pieces, options));
  else if (!common.quiet)
    print_text(a, place, result, pieces);
}

}  // namespace

void add_bake(CLI::App& app, Common& common) {
  CLI::App& sub =
      *app.add_subcommand("bake", "Bake a surface's exact normals as a normal map for a coarse mesh of it");
  auto a = std::make_shared<BakeArguments>();
  a->basis = "stored";
  a->dilate = 4;
  sub.add_option("--surface", a->surface, std::string("the surface, required: ") + surface_help);
  add_map_options(sub, *a);
  sub.add_option("--basis", a->basis, "which tangents: stored (in the file) or mikktspace (computed anew)")
      ->capture_default_str()
      ->check(CLI::IsMember({"stored", "mikktspace"}));
  sub.add_option("--size", a->size, "size of the map in texels, WIDTHxHEIGHT")->capture_default_str();
  sub.add_option("--depth", a->depth, "bits per channel to write: 8, 16 or float [8; EXR float]")
      ->check(map_depths.check());
  sub.add_option("--samples", a->samples, "points per triangle at which the error is measured")
      ->capture_default_str()
      ->check(whole_number_up_to(10000));
  sub.add_option("--seed", a->seed, "seed of these points")->capture_default_str()->check(whole_number);
  sub.add_option("--report", a->report, "write a picture of the texels that are covered, conflicts in red");
  add_read_options(sub, common);
  add_common(sub, common, "darboux bake --surface torus --mesh torus.glb --size 256x256 -o normal.png");
  sub.callback([a, &common] { run_bake(*a, common); });
}

}  // namespace darboux
