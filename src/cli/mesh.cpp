#include <algorithm>
#include <iostream>
#include <stdexcept>

#include <darboux/io.h>
#include <darboux/sample_mesh.h>

#include "base/counted.h"
#include "base/text.h"
#include "command.h"

namespace darboux {
namespace {

constexpr Choice<MeshTopology, 4> topologies{{"grid", "icosphere", "cube-sphere", "lantern"}};
constexpr Choice<PolePlacement, 3> poles{{"per-column", "half-cell", "shared"}};

struct MeshArguments {
  std::string surface, topology = "grid", grid, pole = "per-column", scale = "1,1,1", output, seam = "split",
                       diagonal = "regular", sign = "gltf";
  int subdivisions = 0;  // 0: not given
  SampleMeshOptions options;
  bool no_tangents = false;
};

Vec3<double> parse_scale(const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 3)
    throw ParameterError("--scale", expected_got("SX,SY,SZ such as -1,1,1", "'" + text + "'"));
  return {parse_finite("--scale", parts[0]), parse_finite("--scale", parts[1]),
          parse_finite("--scale", parts[2])};
}

// Parses the strings.
SampleMeshOptions parse(const MeshArguments& arguments) {
  SampleMeshOptions o = arguments.options;
  o.topology = topologies.of(arguments.topology);
  const bool sphere = o.topology == MeshTopology::icosphere || o.topology == MeshTopology::cube_sphere;
  const bool grid_given = !arguments.grid.empty(), subdivisions_given = arguments.subdivisions > 0;
  const auto takes = [&](const char* needed, const char* example, const char* other, bool given,
                         bool other_given) {
    if (other_given)
      throw ParameterError(
          other,
          expected_got(std::string(needed) + " for " + arguments.topology + ", such as " + example, other));
    if (!given)
      throw ParameterError(
          "mesh",
          expected_got(std::string(needed) + " for " + arguments.topology + ", such as " + example, "none"));
  };
  if (sphere) {
    takes("--subdivisions N", "16", "--grid", subdivisions_given, grid_given);
    o.subdivisions = arguments.subdivisions;
  } else {
    takes("--grid NxM", "64x32", "--subdivisions", grid_given, subdivisions_given);
    std::tie(o.columns, o.rows) = parse_grid("--grid", arguments.grid);
  }
  o.pole = poles.of(arguments.pole);
  o.shared_seam = arguments.seam == "shared";
  o.random_diagonals = arguments.diagonal == "random";
  o.scale = parse_scale(arguments.scale);
  o.sign = sign_conventions.of(arguments.sign);
  return o;
}

// The library's errors name the option; this adds the dashes.
Mesh make(const AnySurface& surface, const SampleMeshOptions& o, std::size_t& dropped_cells) try {
  return sample_mesh(surface, o, &dropped_cells);
} catch (const ParameterError& error) {
  throw std::invalid_argument(std::string("--") + error.what());
}

// Whether any triangle has area once positions are rounded to floats, as in the file.
bool any_area(const Mesh& mesh) {
  const auto stored = [&](std::uint32_t v) {
    const Vec3<double>& p = mesh.positions[v];
    return Vec3<double>{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  };
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    const Vec3<double> p = stored(t[0]);
    return !(norm(cross(stored(t[1]) - p, stored(t[2]) - p)) <= 0);  // write_glb() refuses what is no number
  });
}

void run_mesh(const MeshArguments& arguments, const Common& common) {
  if (is_standard_output(arguments.output) && common.json)
    throw ParameterError("-", expected_got("one of -o - and --json for standard output", "both"));
  check_glb_name(arguments.output);
  const AnySurface surface = surface_argument(arguments.surface);
  const SampleMeshOptions o = parse(arguments);
  std::size_t dropped = 0;
  Mesh mesh = make(surface, o, dropped);
  if (!any_area(mesh))
    throw ParameterError("mesh", expected_got("triangles with an area, of positions that floats hold",
                                              "none: try a finer grid, or another size"));
  if (arguments.no_tangents) mesh.tangents.clear();
  Json how{{"surface", surface.specification()}, {"topology", arguments.topology}};
  if (arguments.grid.empty())
    how["subdivisions"] = o.subdivisions;
  else
    how["grid"] = arguments.grid;
  how.update({{"pole", arguments.pole},
              {"seam", arguments.seam},
              {"diagonal", arguments.diagonal},
              {"jitter", o.jitter},
              {"seed", o.seed},
              {"shear", o.shear},
              {"mirror", o.mirror},
              {"scale", array(o.scale)},
              {"degenerate", o.degenerate},
              {"degenerate_uvs", o.degenerate_uvs},
              {"sign", arguments.sign}});
  write_glb(arguments.output, mesh, std::string(surface.info().name), json_text({{"darboux", how}}, -1));
  if (dropped > 0 && !common.quiet)
    print_error(std::string(surface.info().name) +
                ": expected all cells of the grid to be finite and to have area, got " +
                std::to_string(dropped) + " of " +
                std::to_string(static_cast<std::size_t>(o.columns) * static_cast<std::size_t>(o.rows)) +
                " that are left out or have one triangle left");
  if (common.json)
    print_json({{"file", arguments.output},
                {"surface", surface_json(surface)},
                {"vertices", mesh.positions.size()},
                {"triangles", mesh.triangles.size()},
                {"dropped_cells", dropped}});
  else if (!common.quiet && !is_standard_output(arguments.output))
    std::cout << arguments.output << ": " << counted(mesh.positions.size(), "vertex", "vertices") << ", "
              << counted(mesh.triangles.size(), "triangle") << '\n';
}

}  // namespace

void add_mesh(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand("mesh", "Write a reference mesh with exact normals, uvs and tangents");
  auto arguments = std::make_shared<MeshArguments>();
  SampleMeshOptions& o = arguments->options;
  const CLI::Validator triangle_count = whole_number_up_to(std::numeric_limits<int>::max());
  sub.add_option("SURFACE", arguments->surface, surface_help)->required();
  sub.add_option("-o,--output", arguments->output, "the .glb to write; - for standard output")->required();
  sub.add_option(
         "--topology", arguments->topology,
         "how the surface is cut into triangles. grid: rows and columns of cells. icosphere, cube-sphere: a "
         "subdivided icosahedron or cube, for a sphere, ellipsoid or superellipsoid. lantern: a tube with "
         "every other row turned by half a cell; its triangles need not converge to the tube (Schwarz)")
      ->capture_default_str()
      ->check(topologies.check());
  sub.add_option("--grid", arguments->grid, "NxM segments along u and v, for grid and lantern");
  sub.add_option("--subdivisions", arguments->subdivisions,
                 "segments along each edge of the icosahedron, or cube (then even)")
      ->check(whole_number_between(1, 2000));
  sub.add_option("--pole", arguments->pole,
                 "vertices where all columns meet in one point: per-column (one per column, with its u), "
                 "half-cell (one per column, with u in its middle, as three.js does), shared (one for all)")
      ->capture_default_str()
      ->check(poles.check());
  sub.add_option("--seam", arguments->seam,
                 "split: separate vertices at u = 0 and u = 1; shared: one vertex, where the uv jumps")
      ->capture_default_str()
      ->check(CLI::IsMember({"split", "shared"}));
  sub.add_option("--jitter", o.jitter,
                 "move interior vertices at random, by up to this fraction of a cell in each direction")
      ->capture_default_str();
  sub.add_option("--seed", o.seed, "seed of the jitter and of random diagonals")
      ->capture_default_str()
      ->check(whole_number);
  sub.add_option("--diagonal", arguments->diagonal, "direction of the cells' diagonals: regular or random")
      ->capture_default_str()
      ->check(CLI::IsMember({"regular", "random"}));
  sub.add_option("--shear", o.shear, "K: store u + K v instead of u, K from -1000 to 1000")
      ->capture_default_str();
  sub.add_flag("--mirror", o.mirror,
               "store 1 - |2u - 1| instead of u: the second half is mirrored; N must be even");
  sub.add_option("--scale", arguments->scale,
                 "SX,SY,SZ: scale the mesh along x, y and z, with its normals and tangents; an odd number of "
                 "negative factors mirrors it. Each is 1e-30 to 1e30 in size, and at most 1e12 times another")
      ->capture_default_str();
  sub.add_option("--degenerate", o.degenerate,
                 "add this many triangles without area: in turn collinear, with two vertices in one place, "
                 "with one vertex twice")
      ->capture_default_str()
      ->check(triangle_count);
  sub.add_option("--degenerate-uvs", o.degenerate_uvs,
                 "make the uv area of this many triangles zero: in turn with all corners at one uv, with two "
                 "corners at one uv")
      ->capture_default_str()
      ->check(triangle_count);
  sub.add_flag("--no-tangents", arguments->no_tangents, "leave TANGENT out");
  sub.add_option("--sign", arguments->sign, "sign convention of w: gltf or raw")
      ->capture_default_str()
      ->check(sign_conventions.check());
  add_common(sub, common, "darboux mesh sphere --grid 64x32 -o sphere.glb");
  sub.callback([arguments, &common] { run_mesh(*arguments, common); });
}

}  // namespace darboux
