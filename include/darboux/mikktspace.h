/// \file mikktspace.h
/// Tangents as MikkTSpace makes them, the standard that glTF names, to the bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace darboux {

/// A mesh as MikkTSpace sees it. Nothing is copied.
struct MikkMesh {
  std::span<const float> positions;  ///< x, y, z of each vertex
  std::span<const float> normals;    ///< x, y, z of each vertex, unit
  std::span<const float> uvs;        ///< u, v of each vertex
  /// The vertex of each corner, face after face; empty: corner i is vertex i, and all vertices are corners.
  std::span<const std::uint32_t> corners;
  /// Corners of each face, 3 or 4; empty: all faces are triangles.
  std::span<const std::uint8_t> face_sizes;

  std::size_t vertex_count() const { return positions.size() / 3; }
  std::size_t corner_count() const { return corners.empty() ? vertex_count() : corners.size(); }
};

namespace mikk {
class Memory;
}

/// Work memory of mikktspace(), for programs that call it often. Pass it in MikkOptions: a
/// call works in it, and allocates only where it is too small, and for small lists. It grows to what the
/// largest call needs and shrinks only by release(). Small meshes gain most.
///
/// Not thread-safe: use it in one call at a time. Results do not depend on earlier calls, nor on whether they
/// threw. A moved-from MikkMemory is empty, and can be used like a new one.
class MikkMemory {
 public:
  MikkMemory();
  MikkMemory(MikkMemory&& other) noexcept;
  MikkMemory& operator=(MikkMemory&& other) noexcept;
  ~MikkMemory();

  /// The bytes that are reserved. The system counts only those that calls have written to.
  std::size_t bytes() const;
  void release();  ///< gives all of it back to the system

  struct OfCall;  ///< of the implementation

 private:
  std::unique_ptr<mikk::Memory> memory_;
};

struct MikkOptions {
  /// In degrees, 0 to 180: a triangle is averaged only with those of its group whose directions differ by
  /// less. 180: with all of them, MikkTSpace's default.
  float angular_threshold = 180;
  /// false: as the original, which leaves the last run of its edges unsorted, so that some triangles at the
  /// last vertices miss their neighbours. true: all edges are sorted; bits may differ from the original's.
  bool sort_all_edges = false;
  float unserved_sign = -1;      ///< w of a corner that no triangle serves; -1 as the original
  int threads = 1;               ///< 0: all; the bits do not depend on it
  MikkMemory* memory = nullptr;  ///< kept from call to call; null: the call takes its own and gives it back
};

/// All that MikkTSpace tells of a corner.
struct MikkTangent {
  float t[3] = {1, 0, 0},
        b[3] = {0, 1, 0};            ///< unit, but for what mikktspace() says of rounding; b is not n × t
  float t_length = 1, b_length = 1;  ///< of the derivatives in u and v, averaged; see mikktspace()
  float sign = -1;                   ///< raw: 1 where the uvs wind as the triangle does
  bool served = false;  ///< false: no triangle gives a direction; the values above are placeholders
};

/// MikkTSpace's tangents, bit for bit those of the original in single precision. [Mikkelsen2008]
///
/// Vertices with equal position, normal and uv count as one. For a triangle with edges d1, d2 and their uv
/// differences (u1, v1), (u2, v2), let p = ±unit(v2 d1 - v1 d2) and q = ±unit(u1 d2 - u2 d1), with + where
/// the uvs wind as the triangle does. At a vertex, triangles form a group when they share edges (traversed in
/// opposite directions) and their uvs wind alike. With n the vertex's normal and x' = unit(x - (n·x) n), all
/// corners of a group get t = unit(Σ angle p') and b = unit(Σ angle q'), where angle is that between the
/// triangle's two edges at the vertex, both projected by '. Triangles whose uvs have no area join any group
/// and add nothing; those with two corners in one place take the tangents of the first other triangle at the
/// vertex; a corner that nothing serves has t = (1, 0, 0), b = (0, 1, 0) and the sign -1. Quads are cut along
/// the shorter diagonal in the uvs.
///
/// Where a position or uv is beyond 2^28, or all are below 2^-28, each triangle is multiplied by a power of
/// two first, so that nothing overflows or vanishes as it does in the original. Where nothing would overflow
/// or vanish in the original, that changes no bit.
///
/// t and b are unit and perpendicular to the normal, or zero where their sum is, except in these cases, as in
/// the original. Where p or q is along n to rounding, p' or q' is rounding: unit, of any direction, even
/// along n. If a non-zero vector that is to be made unit has no component above 2^-75, its square is 0: t or
/// b gets infinities or NaN. With no component above 2^-126 it is left as short as it is. With none above
/// 2^-63 its square has few bits: t or b is 0.7 to 1.23 long. Each case needs a normal or direction with
/// components that are not zero but at most 2^-36 of the others, or sums that cancel down to such vectors.
///
/// The lengths are sum(angle |dpdu|) / sum(angle) and the same of dpdv, zero where the angles are, and never
/// negative. Where |dpdu| or angle |dpdu| summed is beyond float's range, above 3.4e38, the length is
/// infinite; where a triangle of infinite |dpdu| has an angle of 0 at the corner, it is NaN. |dpdu| is as
/// single precision has it: of a uv area that cancels to rounding, up to 2^25 times too large.
///
/// The sign is raw; glTF's w is its negative. The bits do not depend on the order of the vertices of an
/// indexed mesh, nor on threads. Cost: linear in the triangles. It is quadratic in the triangles at one
/// vertex if their directions are not all within 84 degrees of one of them, or if the threshold is below 180;
/// and in vertices crafted to share one hash. Memory beyond input and output: about 60 bytes per triangle if
/// triangles share most vertices by index, 72 if they share them by equal values instead, 120 if they share
/// none; from half a megabyte on rounded up to pages of 2 MB.
///
/// \param tangent4 x, y, z of t and the raw sign, four numbers per corner
/// \throws MeshError for attributes of unequal length, faces of other than three or four corners, indices out
/// of range, numbers that are not finite, a normal with a component beyond ±2^28; ParameterError for an
/// option out of its range, a tangent4 of another length, or where DARBOUX_ISA names none of
/// instruction_sets()
void mikktspace(const MikkMesh& mesh, std::span<float> tangent4, const MikkOptions& options = {});
/// The same with bitangents and lengths, of each corner.
std::vector<MikkTangent> mikktspace(const MikkMesh& mesh, const MikkOptions& options = {});

}  // namespace darboux
