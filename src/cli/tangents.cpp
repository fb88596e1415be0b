#include <iostream>
#include <map>

#include <darboux/frame.h>
#include <darboux/io.h>
#include <darboux/mesh_frames.h>

#include "command.h"

namespace darboux {
namespace {

struct Arguments {
  std::string input, output, method, sign = "gltf";
  bool list = false;
};

// Vertices of their own for every distinct (vertex, frame): vertex i of the new mesh is `source[i]` with
// `frame[i]`.
struct SplitVertices {
  std::vector<std::uint32_t> source, frame, indices;
  bool changed = false;
};

SplitVertices split_vertices(const Mesh& mesh, const MeshFrames& frames) {
  SplitVertices result;
  constexpr auto none = static_cast<std::uint32_t>(-1);
  // The first frame a vertex is used with stays with the vertex; every further one gets a new vertex.
  result.source.resize(mesh.positions.size());
  result.frame.assign(mesh.positions.size(), none);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) result.source[v] = v;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> further;
  for (std::size_t c = 0; c < mesh.corners(); ++c) {
    const std::uint32_t v = mesh.triangles[c / 3][c % 3], f = frames.of_corner[c];
    if (result.frame[v] == none) result.frame[v] = f;
    if (result.frame[v] == f) {
      result.indices.push_back(v);
      continue;
    }
    const auto [it, inserted] = further.try_emplace({v, f}, static_cast<std::uint32_t>(result.source.size()));
    if (inserted) {
      result.source.push_back(v);
      result.frame.push_back(f);
      result.changed = true;
    }
    result.indices.push_back(it->second);
  }
  return result;
}

void list(const Common& common) {
  Json all = Json::array();
  for (const FrameMethod& m : frame_methods()) {
    all.push_back({{"name", m.name},
                   {"summary", m.summary},
                   {"formula", m.formula},
                   {"needs_normals", m.needs_normals},
                   {"order_regular", m.direction.regular},
                   {"order_jittered", m.direction.jittered}});
    if (!common.json)
      std::cout << m.name << "\n    " << m.summary << "\n    " << m.formula
                << "\n    error falls with the mesh width to the power " << m.direction.regular
                << " on regular grids, " << m.direction.jittered << " on irregular meshes\n";
  }
  if (common.json) print_json({{"methods", all}});
}

void run(const Arguments& arguments, Common& common) {
  if (arguments.list) return list(common);
  if (arguments.input.empty()) throw ParameterError("tangents", "needs a .glb or .gltf to read, or --list");
  if (arguments.output.empty()) throw ParameterError("tangents", "needs -o OUT.glb");
  if (arguments.method.empty())
    throw ParameterError("tangents", "needs --method, see darboux tangents --list");
  if (arguments.output == "-" && common.json)
    throw ParameterError("-", "standard output is asked for twice, permitted is one of -o - and --json");
  const FrameMethod& method = find_frame_method(arguments.method);
  GltfDocument document = GltfDocument::load(arguments.input);
  const Asset asset = document.asset();
  Json primitives = Json::array(), skipped = Json::array();
  const auto skip = [&](std::size_t mesh, std::size_t primitive, const std::string& reason) {
    skipped.push_back({{"mesh", mesh}, {"primitive", primitive}, {"reason", reason}});
  };
  for (const SkippedPrimitive& s : asset.skipped) skip(s.mesh, s.primitive, s.reason);
  Progress progress("tangents", common);
  std::size_t done = 0;
  for (const Primitive& p : asset.primitives) {
    progress.update(static_cast<double>(done++) / static_cast<double>(asset.primitives.size()));
    if (p.data.uvs.empty() || (method.needs_normals && p.data.normals.empty())) {
      skip(p.mesh, p.primitive, p.data.uvs.empty() ? "has no uvs" : "has no normals");
      continue;
    }
    const MeshFrames frames = mesh_frames(p.data, method);
    const SplitVertices vertices = split_vertices(p.data, frames);
    if (vertices.changed) document.remap_vertices(p.mesh, p.primitive, vertices.source, vertices.indices);
    std::vector<Vec4<float>> tangents;
    tangents.reserve(vertices.frame.size());
    const float to_stored = arguments.sign == "raw" ? 1 : -1;
    for (const std::uint32_t f : vertices.frame) {
      // A vertex no triangle uses gets a valid direction that nothing reads.
      const CornerFrame frame =
          f < frames.frames.size() ? frames.frames[f] : CornerFrame{{1, 0, 0}, {}, {}, 1, true};
      tangents.push_back({static_cast<float>(frame.t.x), static_cast<float>(frame.t.y),
                          static_cast<float>(frame.t.z), to_stored * static_cast<float>(frame.sign)});
    }
    document.set_tangents(p.mesh, p.primitive, tangents);
    primitives.push_back({{"mesh", p.mesh},
                          {"primitive", p.primitive},
                          {"name", p.name},
                          {"corners", p.data.corners()},
                          {"vertices", vertices.source.size()},
                          {"degenerate_triangles", frames.degenerate_triangles},
                          {"degenerate_uv_triangles", frames.degenerate_uv_triangles},
                          {"fallback_corners", frames.fallback_corners}});
  }
  document.save_glb(arguments.output);
  common.exit_status = primitives.empty() ? 1 : 0;  // tangents were asked for, and none could be made
  if (common.json)
    return print_json({{"file", arguments.output},
                       {"method", method.name},
                       {"sign", arguments.sign},
                       {"primitives", primitives},
                       {"skipped", skipped}});
  if (common.quiet) return;
  for (const Json& p : primitives) {
    std::cout << "mesh " << p["mesh"] << " primitive " << p["primitive"] << ": " << p["corners"]
              << " corners";
    if (p["fallback_corners"] != 0)
      std::cout << ", " << p["fallback_corners"]
                << " of them served by no triangle: an arbitrary direction was written";
    std::cout << '\n';
  }
  for (const Json& s : skipped)
    std::cout << "mesh " << s["mesh"] << " primitive " << s["primitive"]
              << " left alone: " << s["reason"].get<std::string>() << '\n';
  std::cout << arguments.output << '\n';
}

}  // namespace

void add_tangents(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand("tangents", "Give a glTF file tangents by a named method");
  auto arguments = std::make_shared<Arguments>();
  sub.add_option("INPUT", arguments->input, "the .glb or .gltf to read");
  sub.add_option("-o,--output", arguments->output, "the .glb to write");
  sub.add_option("--method", arguments->method, "see --list");
  sub.add_option("--sign", arguments->sign, "sign convention of w: gltf or raw")
      ->capture_default_str()
      ->check(CLI::IsMember({"gltf", "raw"}));
  sub.add_flag("--list", arguments->list, "name and explain the methods");
  add_common(sub, common, "darboux tangents in.glb -o out.glb --method angle");
  sub.callback([arguments, &common] { run(*arguments, common); });
}

}  // namespace darboux
