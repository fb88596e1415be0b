// Which sign convention the stored w follows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mesh_under_test.h"

namespace darboux {

struct SignCount {
  std::size_t raw = 0, gltf = 0;
};

// Signs of the whole mesh and of each island, over the corners of triangles with uv area. Corners where w is
// ambiguous do not count: the normal is more than 80 degrees from the triangle (the winding of the uvs and
// the side of dpdv then give opposite signs), or the dpdu of the vertex's triangles go all round it.
class Signs {
 public:
  Signs(const MeshUnderTest& under_test, std::span<const VertexChecks> checks);

  const SignCount& all() const { return all_; }
  std::span<const SignCount> islands() const { return islands_; }
  bool raw() const { return all_.raw > all_.gltf; }
  // Whether the corner of v in triangle t has another sign than its island.
  bool wrong(std::uint32_t t, std::uint32_t v) const;
  Handedness handedness() const;
  // The number of corners in islands whose corners all have the sign against the mesh's convention.
  std::size_t in_opposite_islands() const;
  // A text: how many islands have which sign.
  std::string islands_text() const;

 private:
  void count();
  // Judges no sign at vertices where w is ambiguous: a triangle that has no uv area, or is more than 80
  // degrees from the normal, may have given its sign to all corners. Applies only if at most one corner in a
  // hundred is affected, so that such triangles do not fail a mesh.
  void open_few();
  // Triangles do not count if they have no area in space, or none in uv beyond single-precision rounding:
  // they are not visible.
  bool counts(std::uint32_t t) const;
  bool counts(std::uint32_t t, std::uint32_t v) const;
  // Whether the normal is at most 80 degrees from the triangle.
  bool faces(std::uint32_t t, std::uint32_t v) const;
  // How the triangle's uvs wind; where the tangents are MikkTSpace's of quads, how its quad's do.
  int raw_sign(std::uint32_t t, std::uint32_t v) const;
  // Where both signs hold half the island, the mesh's convention decides.
  bool raw_in(const SignCount& island) const {
    return island.raw == island.gltf ? raw() : island.raw > island.gltf;
  }

  const MeshUnderTest& under_test_;
  std::span<const VertexChecks> checks_;
  SignCount all_;
  std::vector<SignCount> islands_;
  std::vector<bool> all_round_;  // as OwnDirections has them; empty: none
  std::vector<bool> open_;       // vertices where no sign is wrong; empty: none
};

}  // namespace darboux
