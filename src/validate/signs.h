// Which sign convention the stored w follow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh_under_test.h"

namespace darboux {

struct SignCount {
  std::size_t raw = 0, gltf = 0;
};

// Of the whole mesh and of each island, over the corners of triangles with uv area. A normal more than 80
// degrees from its triangle leaves open what w means there: the triangle's winding, or the side on which w
// times n × t must lie. So do triangles whose dpdu go all round their vertex.
class Signs {
 public:
  Signs(const MeshUnderTest& under_test, std::span<const VertexChecks> checks);

  const SignCount& all() const { return all_; }
  std::span<const SignCount> islands() const { return islands_; }
  bool raw() const { return all_.raw > all_.gltf; }
  // Whether the corner of v in triangle t has another sign than its island.
  bool wrong(std::uint32_t t, std::uint32_t v) const;
  Handedness handedness() const;

 private:
  void count();
  // Triangles without area in space, or as far as their uvs are known in uv, take no part: nothing is seen of
  // them.
  bool counts(std::uint32_t t) const;
  bool counts(std::uint32_t t, std::uint32_t v) const;
  // Where both signs hold half the island, the mesh's convention decides.
  bool raw_in(const SignCount& island) const {
    return island.raw == island.gltf ? raw() : island.raw > island.gltf;
  }

  const MeshUnderTest& under_test_;
  std::span<const VertexChecks> checks_;
  SignCount all_;
  std::vector<SignCount> islands_;
  std::vector<bool> all_round_;  // as OwnDirections has them; empty: none
};

}  // namespace darboux
