#include <algorithm>
#include <iostream>

#include <darboux/compare.h>
#include <darboux/io.h>

#include "base/counted.h"
#include "base/text.h"
#include "command.h"

namespace darboux {
namespace {

struct CompareArguments {
  std::string a, b;
  double max_angle = 0;
};

std::vector<NamedMesh> named(const Asset& asset) {
  std::vector<NamedMesh> result;
  for (const Primitive& p : asset.primitives) result.push_back({p.mesh, p.primitive, p.name, &p.data});
  return result;
}

// A pair of primitives as reported. Counts are of corners.
struct Pair {
  const Primitive &a, &b;
  MeshComparison result;
};

double share(std::size_t count, std::size_t of) {
  return static_cast<double>(count) / static_cast<double>(of);
}

// ---- for scripts ------------------------------------------------------------------------------------------

Json unmatched_json(const Unmatched& u) {
  return {{"not_finite", u.not_finite}, {"position", u.position},
          {"triangle", u.triangle},     {"uv", u.uv},
          {"normal", u.normal},         {"uv_and_normal", u.uv_and_normal}};
}

Json tangent_json(const Vec4<double>& t) {
  return {number(t.x), number(t.y), number(t.z), number(t.w)};
}

Json worst_json(const Pair& pair) {
  const WorstTangent& w = *pair.result.worst;
  const Mesh &a = pair.a.data, &b = pair.b.data;
  Json json{{"vertex", w.vertex_a}, {"vertex_b", w.vertex_b}, {"deg", number(w.deg)}};
  if (!a.uvs.empty()) {
    json["u"] = number(a.uvs[w.vertex_a].x);
    json["v"] = number(a.uvs[w.vertex_a].y);
  }
  json["position"] = array(a.positions[w.vertex_a]);
  json["tangent_a"] = tangent_json(a.tangents[w.vertex_a]);
  json["tangent_b"] = tangent_json(b.tangents[w.vertex_b]);
  return json;
}

Json pair_json(const Pair& pair) {
  const auto& [a, b, r] = pair;
  const bool tangents = r.tangents_a && r.tangents_b && r.matched > 0;
  Json json{{"mesh", a.mesh},
            {"primitive", a.primitive},
            {"name", a.name},
            {"mesh_b", b.mesh},
            {"primitive_b", b.primitive},
            {"corners", r.corners_a},
            {"corners_b", r.corners_b},
            {"matched", r.matched},
            {"unmatched", unmatched_json(r.unmatched_a)},
            {"unmatched_b", unmatched_json(r.unmatched_b)},
            {"matched_with_v_flipped", r.matched_with_v_flipped},
            {"texcoord", {a.texcoord, b.texcoord}},
            {"tangents", {r.tangents_a, r.tangents_b}},
            {"equal_bits", nullptr},
            {"equal_directions", nullptr},
            {"no_direction", r.no_direction},
            {"tangent_deg", nullptr},
            {"sign", nullptr},
            {"opposite_signs", r.opposite_signs},
            {"conventions", nullptr},
            {"worst", nullptr},
            {"same", r.same}};
  if (tangents) {
    json["equal_bits"] = number(share(r.equal_bits, r.matched));
    json["equal_directions"] = number(share(r.equal_directions, r.matched));
  }
  if (r.tangent_deg) json["tangent_deg"] = statistics_json(*r.tangent_deg);
  if (r.sign != SignAgreement::none) json["sign"] = name_in(sign_agreement_names, r.sign);
  if (r.a_is_raw) json["conventions"] = {*r.a_is_raw ? "raw" : "gltf", *r.a_is_raw ? "gltf" : "raw"};
  if (r.worst) json["worst"] = worst_json(pair);
  return json;
}

Json left_over_json(const std::vector<std::size_t>& left_over, const Asset& asset) {
  Json json = Json::array();
  for (const std::size_t i : left_over) {
    const Primitive& p = asset.primitives[i];
    json.push_back(
        {{"mesh", p.mesh}, {"primitive", p.primitive}, {"name", p.name}, {"corners", p.data.corners()}});
  }
  return json;
}

// ---- text -------------------------------------------------------------------------------------------

// Prints "100 %" only if count equals all.
std::string percent(std::size_t count, std::size_t of) {
  const std::string text = rounded(100 * share(count, of), 3);
  return (text == "100" && count < of ? "99.9" : text) + " %";
}

void print_unmatched(const char* file, const char* other, const Unmatched& u) {
  if (u.total() == 0) return;
  std::string text;
  const auto add = [&](std::size_t count, const std::string& why) {
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + why;
  };
  add(u.not_finite, "hold NaN or infinity");
  add(u.position, std::string("at positions that ") + other + " does not have");
  add(u.triangle, std::string("in triangles that ") + other + " does not have, or has fewer of");
  add(u.uv, "at the same positions but other uvs");
  add(u.normal, "at the same positions but other normals");
  add(u.uv_and_normal, "at the same positions but other uvs and normals");
  std::cout << "    unmatched in " << file << ": " << text << '\n';
}

void print_worst(const Pair& pair) {
  const WorstTangent& w = *pair.result.worst;
  const Mesh& a = pair.a.data;
  const Vec3<double>& p = a.positions[w.vertex_a];
  std::cout << rounded(w.deg, 3) << " max at vertex " << w.vertex_a << " of a";
  if (!a.uvs.empty())
    std::cout << ", uv " << rounded(a.uvs[w.vertex_a].x, 6) << " " << rounded(a.uvs[w.vertex_a].y, 6);
  std::cout << ", position " << rounded(p.x, 6) << " " << rounded(p.y, 6) << " " << rounded(p.z, 6);
}

void print_tangents(const Pair& pair) {
  const MeshComparison& r = pair.result;
  if (!r.tangents_a || !r.tangents_b) {
    std::cout << "    "
              << (r.tangents_a   ? "b has no"
                  : r.tangents_b ? "a has no"
                                 : "neither has")
              << " tangents: nothing to compare\n";
    return;
  }
  if (r.matched == 0) return;
  std::cout << "    bit-equal at " << percent(r.equal_bits, r.matched) << " of "
            << counted(r.matched, "corner");
  if (r.equal_directions > r.equal_bits)
    std::cout << ", but for the sign at " << percent(r.equal_directions, r.matched);
  std::cout << '\n';
  if (r.worst) {
    std::cout << "    tangents differ by " << rounded(r.tangent_deg->rms, 3) << " deg rms, ";
    print_worst(pair);
    std::cout << '\n';
  }
  if (r.sign == SignAgreement::opposite) {
    std::cout << "    signs opposite everywhere";
    if (r.a_is_raw) std::cout << (*r.a_is_raw ? " (a writes raw, b gltf)" : " (a writes gltf, b raw)");
    std::cout << '\n';
  } else if (r.sign == SignAgreement::mixed) {
    std::cout << "    signs opposite at " << counted(r.opposite_signs, "corner") << '\n';
  } else if (r.sign == SignAgreement::same && !r.same) {
    std::cout << "    signs the same everywhere\n";
  }
  if (r.no_direction > 0)
    std::cout << "    tangents that are zero or not finite, in a or in b, at "
              << counted(r.no_direction, "corner") << '\n';
}

// Whether neither has tangents and everything else is equal.
bool compares_nothing(const Pair& pair) {
  const MeshComparison& r = pair.result;
  return !r.tangents_a && !r.tangents_b && r.matched == r.corners_a && r.matched == r.corners_b;
}

const char* verdict(bool same, bool nothing) {
  return same ? "same" : nothing ? "nothing compared" : "not the same";
}

void print_pair(const Pair& pair) {
  const auto& [a, b, r] = pair;
  std::cout << "  " << primitive_text(a);
  if (a.mesh != b.mesh || a.primitive != b.primitive) std::cout << " against " << primitive_text(b);
  std::cout << ": " << verdict(r.same, compares_nothing(pair)) << ", ";
  if (r.matched == r.corners_a && r.matched == r.corners_b)
    std::cout << (r.matched == 1 ? "the " : "all ") << counted(r.matched, "corner") << " matched\n";
  else
    std::cout << counted(r.matched, "corner") << " matched of " << r.corners_a << " in a and " << r.corners_b
              << " in b\n";
  print_unmatched("a", "b", r.unmatched_a);
  print_unmatched("b", "a", r.unmatched_b);
  if (a.data.uvs.empty() != b.data.uvs.empty())
    std::cout << "    " << (a.data.uvs.empty() ? "a" : "b") << " has no uvs\n";
  if (a.data.normals.empty() != b.data.normals.empty())
    std::cout << "    " << (a.data.normals.empty() ? "a" : "b") << " has no normals\n";
  if (r.matched_with_v_flipped > r.matched)
    std::cout << "    with v flipped in b (1 - v) " << counted(r.matched_with_v_flipped, "corner")
              << " would match\n";
  if (a.texcoord != b.texcoord && a.texcoord >= 0 && b.texcoord >= 0)
    std::cout << "    uvs are those of TEXCOORD_" << a.texcoord << " in a, TEXCOORD_" << b.texcoord
              << " in b: the sets that their materials' normal maps name\n";
  print_tangents(pair);
}

void print_left_over(const char* file, const std::vector<std::size_t>& left_over, const Asset& asset) {
  for (const std::size_t i : left_over)
    std::cout << "  " << primitive_text(asset.primitives[i]) << " of " << file << " has no counterpart, "
              << counted(asset.primitives[i].data.corners(), "corner") << '\n';
}

void print_skipped(const char* file, const Asset& asset) {
  for (const SkippedPrimitive& s : asset.skipped)
    std::cout << "  " << primitive_text(s.mesh, s.primitive) << " of " << file
              << " not compared: " << s.reason << '\n';
}

// --------------------------------------------------------------------------------------------------

void run_compare(const CompareArguments& arguments, Common& common) {
  if (!(arguments.max_angle >= 0 && arguments.max_angle <= 180))
    throw ParameterError("--max-angle", expected_got("0 <= degrees <= 180", shortest(arguments.max_angle)));
  const Asset a = read_asset(arguments.a, common.read), b = read_asset(arguments.b, common.read);
  const std::vector<NamedMesh> pieces_a = named(a), pieces_b = named(b);
  const MeshPairs found = pair_meshes(pieces_a, pieces_b);
  bool same = !found.pairs.empty() && found.only_a.empty() && found.only_b.empty();
  std::vector<Pair> pairs;
  Progress progress("compare", common);
  for (const auto& [i, j] : found.pairs) {
    const Primitive &p = a.primitives[i], &q = b.primitives[j];
    pairs.push_back({p, q, compare(p.data, q.data, {arguments.max_angle})});
    same = same && pairs.back().result.same;
    progress.update(share(pairs.size(), found.pairs.size()));
  }
  if (!same) common.exit_status = 1;
  if (common.json) {
    Json list = Json::array();
    for (const Pair& pair : pairs) list.push_back(pair_json(pair));
    return print_json({{"files", {arguments.a, arguments.b}},
                       {"max_angle_deg", number(arguments.max_angle)},
                       {"pairs", list},
                       {"only_a", left_over_json(found.only_a, a)},
                       {"only_b", left_over_json(found.only_b, b)},
                       {"skipped_a", skipped_json(a.skipped)},
                       {"skipped_b", skipped_json(b.skipped)},
                       {"same", same}});
  }
  const bool nothing = std::all_of(pairs.begin(), pairs.end(), compares_nothing) && found.only_a.empty() &&
                       found.only_b.empty();
  std::cout << verdict(same, nothing)
            << (same && arguments.max_angle > 0 ? " within " + rounded(arguments.max_angle, 6) + " deg" : "")
            << ": a = " << one_line(arguments.a) << ", b = " << one_line(arguments.b) << '\n';
  if (common.quiet) return;
  for (const Pair& pair : pairs) print_pair(pair);
  print_left_over("a", found.only_a, a);
  print_left_over("b", found.only_b, b);
  if (a.primitives.empty() && b.primitives.empty()) std::cout << "  neither holds triangles to compare\n";
  print_skipped("a", a);
  print_skipped("b", b);
}

}  // namespace

void add_compare(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand("compare", "Compare the tangents of two mesh files, corner by corner");
  auto arguments = std::make_shared<CompareArguments>();
  sub.add_option("A", arguments->a,
                 "a mesh: " + joined({asset_extensions().begin(), asset_extensions().end()}))
      ->required();
  sub.add_option("B", arguments->b, "another mesh")->required();
  sub.add_option("--max-angle", arguments->max_angle,
                 "largest angle, in degrees, between tangents that count as the same; their signs must "
                 "agree. 0: only the same bits")
      ->capture_default_str();
  add_read_options(sub, common);
  add_common(sub, common, "darboux compare a.glb b.glb");
  sub.callback([arguments, &common] { run_compare(*arguments, common); });
}

}  // namespace darboux
