// Normals and tangents that exceed the limit of a recognised surface but are averages over their own
// triangles: the mesh may be too coarse.
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
  Averages() = default;  // nothing is an average
  // Nothing counts as an average where the surface is declared: the mesh must follow it.
  Averages(const MeshUnderTest& under_test, const Accurate& accurate, std::span<const VertexChecks> checks,
           std::span<const std::uint32_t> corners_of);

  // Whether the tangent of v is an average of the dpdu of its triangles of that sign (0: either sign), or
  // these go all round it.
  bool tangent(std::uint32_t v, int sign) const;
  // Whether the normal of v is an average of its triangles', or at most half as far from one as from
  // the surface's.
  bool normal(std::uint32_t v) const { return !normals_.empty() && normals_[v]; }
  // Whether at least half of the corners whose normals exceed the limit have such averages: then no mistake
  // is looked for.
  bool explain_normals() const { return explain_normals_; }

 private:
  std::vector<bool> tangents_;  // by vertex and sign, as in OwnDirections; empty: none
  std::vector<bool> normals_;   // empty: none
  bool explain_normals_ = false;
};

}  // namespace darboux
