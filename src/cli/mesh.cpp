#include <iostream>

#include <darboux/io.h>
#include <darboux/sample_mesh.h>

#include "command.h"

namespace darboux {
namespace {

struct Arguments {
  std::string surface, grid, output, seam = "split", diagonal = "regular", sign = "gltf";
  SampleMeshOptions options;
  bool no_tangents = false;
};

void run(Arguments arguments, const Common& common) {
  if (arguments.output == "-" && common.json)
    throw ParameterError("-", "standard output is asked for twice, permitted is one of -o - and --json");
  const AnySurface surface = surface_argument(arguments.surface);
  SampleMeshOptions& o = arguments.options;
  std::tie(o.columns, o.rows) = parse_grid("--grid", arguments.grid);
  o.shared_seam = arguments.seam == "shared";
  o.random_diagonals = arguments.diagonal == "random";
  o.sign = arguments.sign == "raw" ? SignConvention::raw : SignConvention::gltf;
  Mesh mesh = sample_mesh(surface, o);
  if (arguments.no_tangents) mesh.tangents.clear();
  const Json extras{{"darboux",
                     {{"surface", surface.specification()},
                      {"grid", arguments.grid},
                      {"seam", arguments.seam},
                      {"diagonal", arguments.diagonal},
                      {"jitter", o.jitter},
                      {"seed", o.seed},
                      {"shear", o.shear},
                      {"mirror", o.mirror},
                      {"sign", arguments.sign}}}};
  write_glb(arguments.output, mesh, std::string(surface.info().name),
            extras.dump(-1, ' ', false, Json::error_handler_t::replace));
  if (common.json)
    print_json({{"file", arguments.output},
                {"surface", surface_json(surface)},
                {"vertices", mesh.positions.size()},
                {"triangles", mesh.triangles.size()}});
  else if (!common.quiet && arguments.output != "-")
    std::cout << arguments.output << ": " << mesh.positions.size() << " vertices, " << mesh.triangles.size()
              << " triangles\n";
}

}  // namespace

void add_mesh(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand("mesh", "Write a reference mesh with exact normals, uvs and tangents");
  auto arguments = std::make_shared<Arguments>();
  SampleMeshOptions& o = arguments->options;
  sub.add_option("SURFACE", arguments->surface, surface_help)->required();
  sub.add_option("--grid", arguments->grid, "NxM segments along u and v")->required();
  sub.add_option("-o,--output", arguments->output, "the .glb to write")->required();
  sub.add_option("--seam", arguments->seam,
                 "split: vertices of their own at u = 0 and 1; shared: one vertex, uv jumps")
      ->capture_default_str()
      ->check(CLI::IsMember({"split", "shared"}));
  sub.add_option("--jitter", o.jitter, "interior vertices move by up to ± this share of a cell")
      ->capture_default_str();
  sub.add_option("--seed", o.seed, "of jitter and random diagonals")
      ->capture_default_str()
      ->check(whole_number);
  sub.add_option("--diagonal", arguments->diagonal, "regular or random")
      ->capture_default_str()
      ->check(CLI::IsMember({"regular", "random"}));
  sub.add_option("--shear", o.shear, "K: store u + K v instead of u")->capture_default_str();
  sub.add_flag("--mirror", o.mirror, "store 1 - |2u - 1|: the second half mirrored, N even");
  sub.add_flag("--no-tangents", arguments->no_tangents, "leave TANGENT out");
  sub.add_option("--sign", arguments->sign, "sign convention of w: gltf or raw")
      ->capture_default_str()
      ->check(CLI::IsMember({"gltf", "raw"}));
  add_common(sub, common, "darboux mesh sphere --grid 64x32 -o sphere.glb");
  sub.callback([arguments, &common] { run(*arguments, common); });
}

}  // namespace darboux
