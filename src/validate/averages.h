// What of a mesh is beyond a recognised surface, and yet what its own triangles tell: they may be coarse.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "accurate.h"
#include "mesh_under_test.h"

namespace darboux {

class Averages {
 public:
  Averages() = default;  // nothing is
  // Nothing is of a declared surface either, which is held to.
  Averages(const MeshUnderTest& under_test, const Accurate& accurate, std::span<const VertexChecks> checks,
           std::span<const std::uint32_t> corners_of);

  // Whether the tangent of v is an average of the dpdu of its triangles of that sign, or these go all round
  // it; of either sign for 0.
  bool tangent(std::uint32_t v, int sign) const;
  // Whether the normal of v is an average of its triangles'.
  bool normal(std::uint32_t v) const { return !normals_.empty() && normals_[v]; }
  // Whether at least half of the corners whose normals are beyond are such: no mistake need explain them.
  bool explain_normals() const { return explain_normals_; }

 private:
  std::vector<bool> tangents_;  // by sign as OwnDirections has them; empty: none
  std::vector<bool> normals_;   // empty: none
  bool explain_normals_ = false;
};

}  // namespace darboux
