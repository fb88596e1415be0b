// MikkTSpace's tangents of a mesh, as a reference.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <darboux/mesh.h>

namespace darboux {

// Blender and others run MikkTSpace on quads, where the halves share one winding and one set of weights, and
// cut the quads into triangles afterwards. quads: two successive triangles are one face if quad_of() says so.
enum class MikktspaceFaces : std::uint8_t { triangles, quads };

// MikkTSpace's tangent and raw sign of each corner. w = 0 where no triangle gives it one, or MikkTSpace's
// result is not a direction (zero, infinite, NaN). Nearly all corners of a vertex have the same tangent,
// which is stored once; the other corners are listed.
class MikktspaceReference {
 public:
  struct Other {
    std::size_t corner;
    std::uint32_t vertex;
    Vec4<float> tangent;
  };

  MikktspaceReference() = default;
  // \param of_corner one per corner of the mesh
  MikktspaceReference(const Mesh& mesh, std::span<const Vec4<float>> of_corner,
                      MikktspaceFaces faces = MikktspaceFaces::triangles);

  bool empty() const { return of_vertex_.empty(); }
  MikktspaceFaces faces() const { return faces_; }
  // The tangent of all corners of the vertex except those in others(); w = 0 at vertices that no triangle
  // uses.
  const Vec4<float>& of_vertex(std::uint32_t vertex) const { return of_vertex_[vertex]; }
  std::span<const Other> others() const { return others_; }  // corners in ascending order
  // \param vertex that of the corner
  const Vec4<float>& at(std::size_t corner, std::uint32_t vertex) const;
  // \param part a mesh of some of the triangles \param vertices, triangles their indices in the whole
  MikktspaceReference restricted_to(const Mesh& part, std::span<const std::uint32_t> vertices,
                                    std::span<const std::uint32_t> triangles) const;

 private:
  MikktspaceFaces faces_ = MikktspaceFaces::triangles;
  std::vector<Vec4<float>> of_vertex_;
  std::vector<bool> has_others_;
  std::vector<Other> others_;
};

inline Vec3<double> direction_of(const Vec4<float>& tangent) {
  return {tangent.x, tangent.y, tangent.z};
}

// MikkTSpace's tangents under the given uvs. Triangles with numbers that are not finite are left out.
MikktspaceReference mikktspace_reference(const Mesh& mesh, std::span<const Vec2<double>> uvs, int threads,
                                         MikktspaceFaces faces, bool sort_all_edges = false);

// The number of corners where the stored tangent has the reference's direction, up to rounding.
std::size_t stored_corners(const Mesh& mesh, const MikktspaceReference& reference);

// The reference of triangles, unless that of quads gives more of the stored tangents, and at least half of
// them.
MikktspaceReference mikktspace_reference(const Mesh& mesh, std::span<const Vec2<double>> uvs, int threads);

}  // namespace darboux
