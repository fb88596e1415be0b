#include <algorithm>
#include <cmath>
#include <iostream>

#include <darboux/file_tangents.h>

#include "base/counted.h"
#include "base/text.h"
#include "command.h"

namespace darboux {
namespace {

struct TangentsArguments {
  std::string input, output, method = FileTangentOptions{}.method, sign = "gltf", only;
  bool list = false, drop_idle = false;
};

const char* error_left(double order) {
  // In steps of half an order.
  constexpr const char* words[] = {
      "the same error",         "0.7 of the error",       "half the error",
      "0.35 of the error",      "a quarter of the error", "0.18 of the error",
      "an eighth of the error", "0.09 of the error",      "a sixteenth of the error"};
  return words[std::clamp(static_cast<int>(std::lround(2 * order)), 0, 8)];
}

std::string errors_left(const ExpectedOrders& orders) {
  if (orders.regular == orders.jittered) return error_left(orders.regular);
  return std::string(error_left(orders.regular)) + " on regular grids, " + error_left(orders.jittered) +
         " on irregular meshes";
}

const char* chart_name(Chart chart) {
  return chart == Chart::any ? "any" : chart == Chart::orthogonal ? "orthogonal" : "conformal";
}

std::string uvs_it_suits(Chart chart) {
  if (chart == Chart::any) return "all, sheared and stretched ones too";
  return std::string(chart == Chart::orthogonal ? "those that are not sheared"
                                                : "those that are neither sheared nor stretched") +
         "; on others an error stays, however fine the mesh";
}

// "    label    text", broken between words before column 100.
void print_paragraph(const std::string& label, std::string_view text) {
  constexpr std::size_t indent = 14, width = 100;
  std::string line = "    " + label;
  line.resize(indent, ' ');
  for (const std::string& word : split(text, ' ')) {
    if (line.size() + word.size() > width) {
      std::cout << line.substr(0, line.find_last_not_of(' ') + 1) << '\n';
      line.assign(indent, ' ');
    }
    line += word + ' ';
  }
  std::cout << line.substr(0, line.find_last_not_of(' ') + 1) << '\n';
}

void list_methods(const Common& common) {
  if (common.json) {
    Json all = Json::array();
    for (const FrameMethod& m : frame_methods())
      all.push_back({{"name", m.name},
                     {"summary", m.summary},
                     {"formula", m.formula},
                     {"needs_normals", m.needs_normals},
                     {"order_regular", m.direction.regular},
                     {"order_jittered", m.direction.jittered},
                     {"order_poles_regular", m.at_poles.tangent.regular},
                     {"order_poles_jittered", m.at_poles.tangent.jittered},
                     {"order_poles_bitangent_regular", m.at_poles.bitangent.regular},
                     {"order_poles_bitangent_jittered", m.at_poles.bitangent.jittered},
                     {"tangent_charts", chart_name(m.tangent_chart)},
                     {"bitangent_charts", chart_name(m.bitangent_chart)},
                     {"single_precision", m.single_precision},
                     {"source", m.source},
                     {"cost", m.cost}});
    return print_json({{"methods", all}});
  }
  std::cout
      << "Each method gives every corner of every triangle a tangent, the direction in which u grows, and a\n"
         "sign for the bitangent. 'accuracy' is what is left of the error, against the smooth surface that\n"
         "the mesh stands for, when its triangles are made half as wide; borders and seams count as\n"
         "irregular. Not sure? Take "
      << FileTangentOptions{}.method << ": normal maps are baked for it, and glTF names it.\n";
  for (const FrameMethod& m : frame_methods()) {
    std::cout << '\n' << m.name << '\n';
    print_paragraph("what", m.summary);
    print_paragraph("formula", m.formula);
    print_paragraph("accuracy",
                    errors_left(m.direction) + "; beside poles " + errors_left(m.at_poles.tangent));
    print_paragraph("uvs", uvs_it_suits(m.tangent_chart));
    print_paragraph("source", m.source);
    print_paragraph("cost", m.cost);
  }
}

Json primitive_json(const PrimitiveTangents& p) {
  return {{"mesh", p.mesh},
          {"primitive", p.primitive},
          {"name", p.name},
          {"corners", p.corners},
          {"old_vertices", p.old_vertices},
          {"vertices", p.vertices},
          {"morph_targets", p.morph_targets},
          {"degenerate_triangles", p.degenerate_triangles},
          {"degenerate_uv_triangles", p.degenerate_uv_triangles},
          {"fallback_corners", p.fallback_corners}};
}

void print_text(const DroppedIdle& dropped, std::ostream& out) {
  for (const SkippedPrimitive& p : dropped.primitives)
    out << primitive_text(p.mesh, p.primitive) << ": TANGENT dropped: " << p.reason << '\n';
  if (!dropped.bytes_kept.empty())
    out << "the bytes of dropped tangents stay in the file: " << dropped.bytes_kept << '\n';
  else if (dropped.bytes > 0)
    out << "dropped tangents make the buffers smaller by " << dropped.bytes << " bytes\n";
}

void print_text(const FileTangents& result, std::ostream& out) {
  for (const PrimitiveTangents& p : result.primitives) {
    out << primitive_text(p.mesh, p.primitive) << ": " << counted(p.corners, "corner") << ", "
        << counted(p.vertices, "vertex", "vertices");
    if (p.vertices != p.old_vertices)
      out << " (" << p.old_vertices << " before: those whose corners have several tangents were split)";
    if (p.morph_targets != 0) out << ", " << counted(p.morph_targets, "morph target");
    if (p.fallback_corners != 0)
      out << "; at " << counted(p.fallback_corners, "corner")
          << " the method has no direction: an arbitrary one was written";
    out << '\n';
  }
  for (const SkippedPrimitive& s : result.skipped)
    out << primitive_text(s.mesh, s.primitive) << " left alone: " << s.reason << '\n';
}

void run_tangents(const TangentsArguments& arguments, Common& common) {
  if (arguments.list) return list_methods(common);
  if (arguments.input.empty())
    throw ParameterError("tangents", expected_got("a .glb or .gltf to read, or --list", "neither"));
  if (arguments.output.empty()) throw ParameterError("tangents", expected_got("-o OUT.glb", "none"));
  check_glb_name(arguments.output);
  const bool to_stdout = is_standard_output(arguments.output);
  if (to_stdout && common.json)
    throw ParameterError("-", expected_got("one of -o - and --json for standard output", "both"));
  FileTangentOptions options;
  options.method = find_frame_method(arguments.method).name;
  options.sign = sign_conventions.of(arguments.sign);
  options.only_needed = !arguments.only.empty();
  options.threads = common.threads;
  if (arguments.drop_idle && !options.only_needed)
    throw ParameterError("--drop-idle",
                         expected_got("--only needed beside it, as it drops what others get", "none"));
  FileTangents result;
  DroppedIdle dropped;
  std::vector<std::string> kept;
  {
    Progress progress("tangents", common);
    options.progress = [&](double share) { progress.update(share); };
    GltfDocument document = GltfDocument::load(arguments.input, common.read);
    if (arguments.drop_idle) dropped = drop_idle_tangents(document);
    result = add_tangents(document, options);
    kept = document.save_glb(arguments.output);
  }
  if (!common.quiet)
    for (const std::string& image : kept) std::cerr << message_line(arguments.input, image) << '\n';
  // Tangents were requested, and none could be made.
  const bool none = result.primitives.empty() && (!options.only_needed || result.incapable != 0);
  if (none) common.exit_status = 1;
  if (common.json) {
    Json primitives = Json::array();
    for (const PrimitiveTangents& p : result.primitives) primitives.push_back(primitive_json(p));
    Json report{{"file", arguments.output},
                {"method", options.method},
                {"sign", arguments.sign},
                {"primitives", primitives},
                {"skipped", skipped_json(result.skipped)}};
    if (arguments.drop_idle) {
      report["dropped"] = skipped_json(dropped.primitives);
      report["dropped_bytes"] = dropped.bytes;
      report["bytes_kept"] = dropped.bytes_kept.empty() ? Json() : Json(dropped.bytes_kept);
    }
    print_json(report);
    return;
  }
  std::ostream& out = to_stdout || common.quiet ? std::cerr : std::cout;
  if (!common.quiet) {
    print_text(dropped, out);
    print_text(result, out);
  }
  if (none)
    out << (to_stdout ? "standard output" : arguments.output) << ": no tangents were added: no primitive"
        << (options.only_needed ? " that needs them" : "")
        << " has the triangles, normals and uvs that they need\n";
  else if (!to_stdout && !common.quiet)
    out << arguments.output << '\n';
}

}  // namespace

void add_tangents(CLI::App& app, Common& common) {
  CLI::App& sub =
      *app.add_subcommand("tangents", "Write a glTF file with tangents by MikkTSpace or another method");
  auto arguments = std::make_shared<TangentsArguments>();
  sub.add_option("INPUT", arguments->input, "the .glb or .gltf to read; export other formats as .glb first");
  sub.add_option("-o,--output", arguments->output, "the .glb to write");
  sub.add_option("--method", arguments->method, "the method; --list explains them")->capture_default_str();
  sub.add_option("--sign", arguments->sign, "sign convention of w: gltf or raw")
      ->capture_default_str()
      ->check(sign_conventions.check());
  sub.add_option(
         "--only", arguments->only,
         "needed: leave primitives unchanged whose materials read no tangents (no normal map, no anisotropy)")
      ->check(CLI::IsMember({"needed"}));
  sub.add_flag("--drop-idle", arguments->drop_idle,
               "with --only needed: remove tangents that nothing reads, and their bytes");
  sub.add_flag("--list", arguments->list, "list and explain the methods");
  add_read_options(sub, common);
  add_common(sub, common, "darboux tangents in.glb -o out.glb");
  sub.callback([arguments, &common] { run_tangents(*arguments, common); });
}

}  // namespace darboux
