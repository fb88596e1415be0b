// Fits through uvs for callers that know the signs of the mesh's triangles, in the sense of triangle_signs().
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <darboux/fit_mesh.h>

namespace darboux {

enum class UvMaps { plain, affine, any };  // flips and swaps; affine maps; the first, then the others

// Of some kinds under some maps, where fit_any_surface() is that of all under any: the first of
// fitted_kinds() among `kinds` that fits, else the nearest; nothing where none could start. \throws
// UndeterminedError as fit_any_surface() does
std::optional<MeshFit> fit_kinds(const Mesh& mesh, const std::optional<Eigen::Isometry3d>& placement,
                                 std::span<const std::string_view> kinds, UvMaps maps,
                                 std::span<const signed char> signs);

// fit_surface(), and the rms_relative up to which it fits.
struct DeclaredFit {
  MeshFit fit;
  double limit;
};
DeclaredFit fit_declared(const Mesh& mesh, const SurfaceSpecification& given,
                         const std::optional<Eigen::Isometry3d>& placement,
                         std::span<const signed char> signs);
DeclaredFit fit_declared(const Mesh& mesh, const AnySurface& exact,
                         const std::optional<Eigen::Isometry3d>& placement,
                         std::span<const signed char> signs);
// truths() of fit_mesh.h, for these signs.
std::vector<Truth> truths(const Mesh& mesh, const MeshFit& fit, std::span<const signed char> signs);

}  // namespace darboux
