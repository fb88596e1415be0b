// The list of methods.
#include <string>

#include <darboux/error.h>

#include "base/text.h"
#include "corner.h"

namespace darboux {
namespace {

constexpr FrameMethod methods[] = {
    {.name = "mikktspace",
     .summary = "what Blender, Substance, Unity, Unreal and glTF expect: triangles that share a smooth patch "
                "of texture are averaged by their angles; use it when a normal map was baked elsewhere",
     .formula = "t = unit(sum angle s'), s' = unit(dpdu) of a triangle, made perpendicular to the normal; b "
                "= sign n x t",
     .compute = compute_mikktspace,
     .single_precision = true,
     .at_poles = {.tangent = {2, 1}, .bitangent = {2, 1}},
     .source = "Mikkelsen2008",
     .cost = "linear, about 0.8 µs per triangle, most of it copies of the mesh"},
    {.name = "mikktspace-bitangent",
     .summary = "MikkTSpace with the second direction that it computes itself in place of the one built from "
                "normal and "
                "tangent; few engines use it",
     .formula = "t as mikktspace, b = unit(sum angle t'), t' = unit(dpdv) of a triangle, made perpendicular "
                "to the normal",
     .compute = compute_mikktspace_bitangent,
     .single_precision = true,
     .at_poles = {.tangent = {2, 1}, .bitangent = {1, 0.5}},
     .bitangent_chart = Chart::any,
     .source = "Mikkelsen2008",
     .cost = "linear, about 0.8 µs per triangle, most of it copies of the mesh"},
    {.name = "face",
     .summary = "each triangle on its own: the directions in which the texture's u and v grow on it; "
                "faceted, as with flat "
                "shading",
     .formula = "[p1-p0, p2-p0] = [T B] U, t = T/|T|, b = B/|B|",
     .compute = compute_face,
     .needs_normals = false,
     .direction = {1, 1},
     .at_poles = {.tangent = {1, 0}, .normal = {1, 0}},
     .bitangent_chart = Chart::any,
     .reach = 0,
     .source = "Lengyel2001",
     .cost = "linear, about 0.4 µs per triangle"},
    {.name = "average",
     .summary = "triangle tangents added up at each vertex, so that stretched ones count more, then made "
                "perpendicular to the normal (three.js, PlayCanvas and many textbooks)",
     .formula = "t = GramSchmidt(sum T), b = GramSchmidt(sum B)",
     .compute = compute_average,
     .source = "Lengyel2001",
     .cost = "linear, about 0.3 µs per triangle"},
    {.name = "unit",
     .summary = "triangle directions averaged at each vertex; every triangle counts the same",
     .formula = "t = GramSchmidt(sum T/|T|), b likewise",
     .compute = compute_unit,
     .source = "Max1999",
     .cost = "linear, about 0.4 µs per triangle"},
    {.name = "area",
     .summary = "triangle directions averaged at each vertex; large triangles count more: the safe choice on "
                "thin triangles",
     .formula = "t = GramSchmidt(sum area T/|T|), b likewise",
     .compute = compute_area,
     .source = "Max1999",
     .cost = "linear, about 0.4 µs per triangle"},
    {.name = "angle",
     .summary = "triangle directions averaged at each vertex, weighted by the angle the triangle has there",
     .formula = "t = GramSchmidt(sum angle T/|T|), b likewise",
     .compute = compute_angle,
     .at_poles = {.tangent = {2, 1}, .bitangent = {2, 1}},
     .source = "Max1999",
     .cost = "linear, about 0.6 µs per triangle"},
    {.name = "max",
     .summary = "triangle directions averaged at each vertex; those with short edges and a right angle there "
                "count more, as Max weights normals; poor on thin triangles",
     .formula = "t = GramSchmidt(sum sin(angle)/(|e1||e2|) T/|T|), b likewise",
     .compute = compute_max,
     .at_poles = {.tangent = {2, 0}, .bitangent = {2, 0}},
     .source = "Max1999",
     .cost = "linear, about 0.6 µs per triangle"},
    {.name = "fragment-gradient",
     .summary = "what a shader gets from solving for the gradients of u and v in the plane perpendicular to "
                "the smooth normal (tinyrenderer); on sheared uvs these are not the directions of the "
                "texture's axes",
     .formula = "A = (p1-p0; p2-p0; n), A i = (du1, du2, 0), A j = (dv1, dv2, 0), t = i/|i|, b = j/|j|",
     .compute = compute_fragment_gradient,
     .direction = {1, 1},
     .tangent_chart = Chart::orthogonal,
     .reach = 0,
     .source = "Sokolov2016",
     .cost = "linear, about 2 µs per triangle"},
    {.name = "fragment-solve",
     .summary = "what a shader gets from the triangle's own directions beside the smooth normal "
                "(tinyrenderer); not "
                "perpendicular to that normal",
     .formula = "T = E U^-1, t = T/|T|, b = B/|B|, n interpolated",
     .compute = compute_fragment_solve,
     .direction = {1, 1},
     .at_poles = {.tangent = {1, 0}},
     .bitangent_chart = Chart::any,
     .reach = 0,
     .source = "Sokolov2016",
     .cost = "linear, about 1.2 µs per triangle"},
    {.name = "procrustes",
     .summary = "the rotation that best lays the texture about a vertex onto the mesh there; right only "
                "where the texture is "
                "not stretched more one way than the other",
     .formula = "A = sum dp (du, dv)^T over the neighbours, [t b] = W V^T where A = W S V^T",
     .compute = compute_procrustes,
     .needs_normals = false,
     .at_poles = {.tangent = {0, 0}, .bitangent = {0, 0}, .normal = {1, 0}},
     .tangent_chart = Chart::conformal,
     .bitangent_chart = Chart::conformal,
     .source = "Choi2024",
     .cost = "linear, about 1.2 µs per triangle"},
    {.name = "quadratic",
     .summary = "a smooth curved patch laid through the neighbourhood of each vertex, and its own "
                "directions; needs a smooth "
                "mesh",
     .formula = "P(u, v) of degree 2 through the vertex, nearest to its neighbours in the mean square; t, b "
                "along its dpdu, "
                "dpdv",
     .compute = compute_quadratic,
     .needs_normals = false,
     .direction = {2, 2},
     .at_poles = {.bitangent = {2, 2}},
     .bitangent_chart = Chart::any,
     .reach = 2,
     .source = "Darboux",
     .cost = "linear, about 1.8 µs per triangle"},
    {.name = "cubic",
     .summary = "the same with a patch of degree 3: hundreds of times more accurate than averages on smooth "
                "meshes, an "
                "estimate of the truth",
     .formula = "as quadratic, of degree 3",
     .compute = compute_cubic,
     .needs_normals = false,
     .direction = {4, 3},
     .at_poles = {.tangent = {3, 3}, .bitangent = {3, 3}, .normal = {3, 2}},
     .bitangent_chart = Chart::any,
     .reach = 2,
     .source = "Darboux",
     .cost = "linear, about 2.8 µs per triangle"},
};

}  // namespace

std::span<const FrameMethod> frame_methods() {
  return methods;
}

const FrameMethod& find_frame_method(std::string_view name) {
  std::string known;
  for (const FrameMethod& method : methods) {
    if (method.name == name) return method;
    known += (known.empty() ? "" : ", ") + std::string(method.name);
  }
  throw ParameterError("method", expected_got("one of " + known, "'" + std::string(name) + "'"));
}

MeshFrames mesh_frames(const Mesh& mesh, const FrameMethod& method, int threads) {
  check_consistent(mesh, "mesh");
  check_finite(mesh, "mesh");
  if (threads < 0) throw ParameterError("threads", expected_got("0 (all) or more", std::to_string(threads)));
  if (mesh.uvs.empty() && !mesh.triangles.empty())
    throw MeshError("mesh", expected_got("one uv set for tangents", "no uvs"));
  if (method.needs_normals && mesh.normals.empty() && !mesh.triangles.empty())
    throw MeshError(
        "mesh",
        expected_got("normals for method '" + std::string(method.name) + "' ('face' needs none)", "none"));
  return method.compute(mesh, threads);
}

}  // namespace darboux
