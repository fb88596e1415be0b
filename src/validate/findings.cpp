#include "findings.h"

#include <algorithm>
#include <vector>

#include "base/counted.h"

namespace darboux {
namespace {

using enum Severity;

constexpr std::array kinds{
    FindingKind{"TANGENT_NOT_FINITE", error, "tangents hold NaN or infinity",
                "look for a division by a zero length or uv area in the exporter"},
    FindingKind{"TANGENT_ZERO", error, "tangents are zero, so the normal map has no direction here",
                "store any unit vector perpendicular to the normal; remove triangles without area"},
    FindingKind{"TANGENT_NOT_UNIT", error, "tangents are not of unit length",
                "normalise before writing; undo scale in quantised data"},
    FindingKind{"TANGENT_INVALID_SIGN", error, "w of the tangent is neither +1 nor -1",
                "write the sign itself, not a product or an interpolated value"},
    FindingKind{"TANGENT_NOT_ORTHOGONAL", error, "tangents are not perpendicular to the normal",
                "project, t - (t.n) n, then normalise"},
    FindingKind{"TANGENT_HANDEDNESS", error,
                "w differs from the rest of its uv island: the normal map is mirrored here",
                "compute w from the sign of the uv area; split vertices where uvs are mirrored"},
    FindingKind{"TANGENT_ANGLE", error, "tangents point away from the true direction by more than the limit",
                "check whether the tangents belong to another uv set, or were computed before the uvs or "
                "normals changed; if the mesh is too coarse for the limit, refine it or raise --max-angle"},
    FindingKind{"NORMAL_NOT_FINITE", error, "normals hold NaN or infinity",
                "look for triangles without area"},
    FindingKind{"NORMAL_NOT_UNIT", error, "normals are not of unit length", "normalise before writing"},
    FindingKind{"NORMAL_ANGLE", error, "normals point away from the true direction by more than the limit",
                "transform normals by the inverse transpose; recompute after deforming"},
    FindingKind{"POSITION_NOT_FINITE", error, "positions hold NaN or infinity", "repair the source"},
    FindingKind{"UV_NOT_FINITE", error, "uvs hold NaN or infinity", "repair the source"},
    FindingKind{"SURFACE_MISMATCH", error, "the declared surface does not fit the positions at their uvs",
                "correct the declaration, or the mesh"},
    FindingKind{"TANGENT_NOT_MIKKTSPACE", warning, "tangents differ from MikkTSpace's by more than the limit",
                "bake and render with the same tangents: darboux tangents writes MikkTSpace's"},
    FindingKind{"TANGENT_AXES", warning, "tangents look as if u and v were swapped or negated",
                "swap or negate the axes where the tangents or uvs are written"},
    FindingKind{"TANGENT_UV_SET", warning, "tangents follow another uv set",
                "compute them from the set that the normal texture reads"},
    FindingKind{
        "TANGENT_STALE", warning, "tangents are those of the mesh before its positions were transformed",
        "transform tangents by M, normals by its inverse transpose, w by the sign of its determinant"},
    FindingKind{"NORMAL_STALE", warning,
                "normals were not transformed with the positions, or were transformed as positions are",
                "transform normals by the inverse transpose of the map"},
    FindingKind{"TANGENT_HANDEDNESS_CONVENTION", warning,
                "w is MikkTSpace's raw sign, and glTF's is its opposite",
                "negate w in glTF files; readers of the raw convention leave it as it is"},
    FindingKind{
        "BINORMAL_AGAINST_V", warning,
        "binormals point towards decreasing v; in this format they usually point towards increasing v",
        "negate the binormals, unless the normal map's green channel points down (DirectX)"},
    FindingKind{
        "HANDEDNESS_MIXED", warning,
        "w follows neither sign convention throughout; the smaller part is counted",
        "compute w in every part from the sign of the uv area; split vertices at a seam where uvs jump back "
        "inside triangles"},
    FindingKind{"VERTEX_ACROSS_MIRROR", warning,
                "vertices are shared by triangles whose uvs wind differently: one w cannot serve both",
                "split vertices where uvs are mirrored"},
    FindingKind{
        "NORMALS_OPPOSE_WINDING", warning,
        "triangles are wound clockwise, seen from the side that their normals point to",
        "reverse the winding (a baked mirror flips it) or negate the normals; nothing, if leaves or cards "
        "use the normals of the whole on purpose"},
    FindingKind{
        "INDICES_LEFT_OVER", warning,
        "the last indices do not make a whole triangle (counted in indices); only whole triangles are judged",
        "write three indices per triangle"},
    FindingKind{
        "UV_SET_MISSING", warning,
        "the material reads a normal or anisotropy map at a uv set that the mesh lacks: viewers differ",
        "export that uv set, or let the material name one that the mesh has"},
    FindingKind{"REFERENCES_DISAGREE", warning,
                "the surface's frames differ from those of the mesh's own positions and uvs",
                "look for ripples, or declare another surface"},
    FindingKind{"REFERENCE_UNCERTAIN", info,
                "the reference is too uncertain to tell whether these angles exceed the limit",
                "declare what you know (--surface with parameters, --placement), or raise --max-angle"},
    FindingKind{"BITANGENT_NOT_ORTHOGONAL", info,
                "u and v are not orthogonal on this surface: w cross(n, t) cannot follow v, which is a limit "
                "of the format",
                "nothing, where baker and renderer both take w cross(n, t)"},
    FindingKind{"POLE_TANGENT", info,
                "tangents at a pole differ from the limit frame at their own u by more than allowed; no "
                "direction there is right for every texture",
                "nothing; a separate vertex per column is best"},
    FindingKind{"NORMALS_INWARD", info,
                "normals and winding are opposite to the surface's normal, as for a sphere seen from inside; "
                "they were compared with the inward normal",
                "nothing, if the mesh is meant to be seen from that side"},
    FindingKind{
        "FACETED", info,
        "normals are those of the triangles (flat shading), and neighbouring triangles face other ways",
        "nothing, if that is intended"},
    FindingKind{"TANGENT_TEXTURE_TRANSFORM", info,
                "tangents follow the uvs after KHR_texture_transform, and are judged by them", "nothing"},
    FindingKind{"TANGENT_UV_SET_USED", info,
                "the material names no uv set of the mesh for tangents; they follow another set than the "
                "first, and are "
                "judged by it",
                "nothing"},
    FindingKind{"TANGENT_MISSING", info, "the mesh stores no tangents",
                "add them: darboux tangents in.glb -o out.glb; export other formats as .glb first"},
    FindingKind{"NORMAL_MISSING", info, "the mesh stores no normals: neither they nor bitangents are judged",
                "add normals, or compute them when the mesh is loaded"},
    FindingKind{"UV_MISSING", info, "the mesh has no uvs, so tangents cannot be judged", "unwrap it"},
    FindingKind{
        "UV_WITHOUT_AREA", info,
        "no triangle has area in uv: tangents are not judged, and have no visible effect under a normal map",
        "nothing, where the material reads one texel; else unwrap it"},
    FindingKind{"SURFACE_UNKNOWN", info, "no kind of surface that can be recognised fits",
                "nothing; if you know the surface, declare it (--surface)"},
    FindingKind{
        "BUDGET_SPENT", info,
        "recognition of surfaces exceeded its time budget (--budget); parts not yet compared count as "
        "unknown",
        "raise --budget, or declare the surface"},
    FindingKind{"CREASE_SHARED", info,
                "vertices are shared by two surfaces that meet at an angle: no normal or tangent is right "
                "for both; these vertices are not judged",
                "nothing, if the edge should look round; otherwise split the vertices"},
    FindingKind{
        "PARTS_TOO_MANY", info,
        "the mesh falls into more than 256 parts, of which the largest 256 were compared with surfaces",
        "nothing, or give each surface a primitive of its own"},
    FindingKind{"PARTS_IN_BRIEF", info,
                "after a dozen parts without a known surface, the others were compared with spheres, "
                "cylinders, cones and tori only (counted in parts)",
                "nothing, or declare the surface (--surface)"},
    FindingKind{"TRIANGLES_MISSING", info, "the primitive has no triangle (counted in primitives)",
                "nothing to judge"},
    FindingKind{"VERTEX_UNREFERENCED", info,
                "no triangle uses these vertices (counted in vertices); they are not judged",
                "leave them out"},
    FindingKind{
        "MORPH_TARGETS_NOT_JUDGED", info,
        "the mesh is judged with all morph weights 0; its targets are not judged (counted in targets)",
        "nothing, or let darboux tangents write the tangents of the targets too"},
    FindingKind{"NODE_MIRRORED", info,
                "nodes mirror the mesh (counted in nodes): renderers must flip w and the winding",
                "check that the renderer flips w and the winding"},
    FindingKind{"NODE_SCALE_NOT_UNIFORM", info,
                "nodes scale the mesh unevenly (counted in nodes): renderers must transform tangents by M, "
                "normals by its inverse transpose",
                "check that the renderer transforms normals by the inverse transpose"},
    FindingKind{
        "UNDETERMINED", warning,
        "neither a surface nor the triangles could judge the stored frames (counted in meshes and parts)",
        "declare the surface, or let the triangles judge: --surface, --reference"},
};
static_assert(kinds.size() == static_cast<std::size_t>(Code::undetermined) + 1);

}  // namespace

std::span<const FindingKind> finding_kinds() {
  return kinds;
}

Finding finding(Code code, std::size_t count, const std::string& more) {
  const auto place = static_cast<std::size_t>(code);
  const FindingKind& kind = kinds[place];
  return {kind.code, kind.severity, count, std::string(kind.message) + more, kind.to_do, place};
}

std::optional<Code> code_named(std::string_view name) {
  const auto kind =
      std::find_if(kinds.begin(), kinds.end(), [&](const FindingKind& k) { return k.code == name; });
  if (kind == kinds.end()) return std::nullopt;
  return static_cast<Code>(kind - kinds.begin());
}

Finding warning(Code code, std::size_t count, const std::string& more) {
  Finding result = finding(code, count, more);
  result.severity = Severity::warning;
  return result;
}

void add(MeshReport& report, Finding finding) {
  if (finding.count == 0) return;
  const auto behind = std::find_if(report.findings.begin(), report.findings.end(),
                                   [&](const Finding& f) { return f.severity < finding.severity; });
  report.findings.insert(behind, std::move(finding));
}

void compare_conventions(std::span<const NamedReport> parts) {
  const auto opposing = [](const MeshReport& report) {
    std::size_t count = 0;
    for (const Finding& f : report.findings)
      count += code_of(f) == Code::normals_oppose_winding ? f.count : 0;
    return 2 * count > report.corners;
  };
  std::vector<NamedReport> raw, gltf;
  std::size_t raw_corners = 0, gltf_corners = 0;
  for (const NamedReport& part : parts) {
    const HandednessConvention convention = part.report->handedness.convention;
    if ((convention != HandednessConvention::raw && convention != HandednessConvention::gltf) ||
        opposing(*part.report))
      continue;
    const bool is_raw = convention == HandednessConvention::raw;
    (is_raw ? raw : gltf).push_back(part);
    (is_raw ? raw_corners : gltf_corners) += part.report->corners;
  }
  if (raw.empty() || gltf.empty()) return;
  const bool few_are_raw = raw_corners <= gltf_corners;
  const std::vector<NamedReport>&few = few_are_raw ? raw : gltf, &most = few_are_raw ? gltf : raw;
  constexpr std::size_t most_named = 8;
  std::string names;
  for (std::size_t i = 0; i < std::min(few.size(), most_named); ++i)
    names += (i == 0 ? "" : ", ") + few[i].name;
  if (few.size() > most_named) names += " and " + std::to_string(few.size() - most_named) + " more";
  const std::string text = (few_are_raw ? ": raw in " : ": glTF's in ") + names +
                           (few_are_raw ? "; glTF's in " : "; raw in ") + counted(most.size(), "other part") +
                           " of the file";
  for (const NamedReport& part : few)
    add(*part.report, finding(Code::handedness_mixed, part.report->corners, text));
}

}  // namespace darboux
