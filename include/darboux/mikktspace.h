/// \file mikktspace.h
/// MikkTSpace, the tangent standard that glTF specifies, bit for bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace darboux {

/// A mesh as input of MikkTSpace. A view: nothing is copied.
struct MikkMesh {
  std::span<const float> positions;  ///< x, y, z of each vertex
  std::span<const float> normals;    ///< x, y, z of each vertex, unit
  std::span<const float> uvs;        ///< u, v of each vertex
  /// The vertex index of each corner, face after face. Empty: corner i is vertex i.
  std::span<const std::uint32_t> corners;
  /// Corners of each face, 3 or 4; empty: all faces are triangles.
  std::span<const std::uint8_t> face_sizes;

  std::size_t vertex_count() const { return positions.size() / 3; }
  std::size_t corner_count() const { return corners.empty() ? vertex_count() : corners.size(); }
};

namespace mikk {
class Memory;
}

/// Reusable work memory of mikktspace(), for programs that call it often. Pass it in MikkOptions: a call then
/// allocates only if the memory is too small, and for small lists. It grows to the needs of the largest call,
/// and shrinks only by release(). Small meshes benefit most.
///
/// Not thread-safe: use it in one call at a time. Results do not depend on earlier calls, nor on whether they
/// threw. A moved-from MikkMemory is empty, and can be used like a new one.
class MikkMemory {
 public:
  MikkMemory();
  MikkMemory(MikkMemory&& other) noexcept;
  MikkMemory& operator=(MikkMemory&& other) noexcept;
  ~MikkMemory();

  /// The reserved bytes. The system counts only pages that calls have written to.
  std::size_t bytes() const;
  void release();  ///< returns all of it to the system

  struct OfCall;  ///< of the implementation

 private:
  std::unique_ptr<mikk::Memory> memory_;
};

struct MikkOptions {
  /// In degrees, 0 to 180: a triangle is averaged only with triangles of its group whose directions differ by
  /// less. 180, MikkTSpace's default: with all of them.
  float angular_threshold = 180;
  /// false: as in the original, which leaves the last run of edges unsorted, so some triangles at the last
  /// vertices do not find their neighbours. true: all edges are sorted; results may differ from the original.
  bool sort_all_edges = false;
  float unserved_sign = -1;      ///< w of a corner without a usable triangle; -1 as in the original
  int threads = 1;               ///< 0: all; the bits do not depend on it
  MikkMemory* memory = nullptr;  ///< reused between calls; null: allocated and freed by the call
};

/// The complete result of MikkTSpace for a corner.
struct MikkTangent {
  float t[3] = {1, 0, 0},
        b[3] = {0, 1, 0};            ///< unit, but for what mikktspace() says of rounding; b is not n × t
  float t_length = 1, b_length = 1;  ///< averaged lengths of the derivatives by u and v; see mikktspace()
  float sign = -1;                   ///< raw: 1 where the uvs wind as the triangle does
  bool served = false;  ///< false: no triangle gives a direction; the values above are placeholders
};

/// Computes MikkTSpace's tangents in single precision, bit for bit as the original. [Mikkelsen2008]
///
/// Vertices with equal position, normal and uv count as one. For a triangle with edges d1, d2 and their uv
/// differences (u1, v1), (u2, v2), let p = ±unit(v2 d1 - v1 d2) and q = ±unit(u1 d2 - u2 d1), with + where
/// the uvs wind as the triangle does. At a vertex, triangles form a group when they share edges (traversed in
/// opposite directions) and their uvs wind alike. With n the vertex's normal and x' = unit(x - (n·x) n), all
/// corners of a group get t = unit(Σ angle p') and b = unit(Σ angle q'), where angle is that between the
/// triangle's two edges at the vertex, both projected by '. Triangles without uv area join any group and
/// contribute nothing. Triangles with two corners at the same position take the tangents of the first other
/// triangle at the vertex. A corner without a usable triangle has t = (1, 0, 0), b = (0, 1, 0) and sign -1.
/// Quads are cut along the diagonal that is shorter in uv.
///
/// If a position or uv exceeds 2^28, or all are below 2^-28, each triangle is first scaled by a power of two
/// to prevent overflow and underflow, which occur in the original. Where the original has neither, this
/// changes no bit.
///
/// t and b are unit and perpendicular to the normal, or zero if their sum is zero, with these exceptions, as
/// in the original. If p or q is parallel to n up to rounding, p' or q' is a unit vector whose direction is
/// rounding error; it may even be parallel to n. If a non-zero vector to be normalised has no component above
/// 2^-75, its square underflows to 0: t or b has infinities or NaN. If it has no component above 2^-126, it
/// is not normalised. If it has none above 2^-63, its square has few bits: the length of t or b is 0.7 to
/// 1.23. Each case needs a normal or direction with components that are not zero but at most 2^-36 of the
/// others, or sums that cancel down to such vectors.
///
/// The lengths are sum(angle |dpdu|) / sum(angle), and likewise for dpdv; zero if the angles are, and never
/// negative. If |dpdu| or the sum of angle |dpdu| exceeds the range of float, 3.4e38, the length is infinite;
/// if a triangle with infinite |dpdu| has an angle of 0 at the corner, it is NaN. |dpdu| is computed in
/// single precision: if the uv area cancels to rounding, it is up to 2^25 times too large.
///
/// The sign is raw; glTF's w is its negative. The bits do not depend on the order of the vertices of an
/// indexed mesh, nor on threads. Cost: linear in the triangles. It is quadratic in the number of triangles at
/// one vertex if their directions are not all within 84 degrees of one of them, or if the threshold is below
/// 180; and in vertices crafted to have equal hashes. Memory beyond input and output: about 60 bytes per
/// triangle if triangles share most vertices by index, 72 if they share them by equal values instead, 120 if
/// they share none; from half a megabyte on rounded up to pages of 2 MB.
///
/// \param tangent4 x, y, z of t and the raw sign, four numbers per corner
/// \throws MeshError for attributes of unequal length, faces of other than three or four corners, indices out
/// of range, numbers that are not finite, a normal with a component beyond ±2^28; ParameterError for an
/// option out of its range, a tangent4 of another length, or where DARBOUX_ISA names none of
/// instruction_sets()
void mikktspace(const MikkMesh& mesh, std::span<float> tangent4, const MikkOptions& options = {});
/// The same, with bitangents and lengths per corner.
std::vector<MikkTangent> mikktspace(const MikkMesh& mesh, const MikkOptions& options = {});

}  // namespace darboux
