// The contribution of each corner to the sums: passes the mesh to the lanes.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>

#include <darboux/instruction_set.h>

#include "connectivity.h"
#include "lanes.h"

namespace darboux {
namespace kernels {

extern const mikk::LaneKernels mikktspace_table_baseline;
#if defined(DARBOUX_WITH_AVX2)
extern const mikk::LaneKernels mikktspace_table_avx2;
#endif
#if defined(DARBOUX_WITH_AVX512)
extern const mikk::LaneKernels mikktspace_table_avx512;
#endif

}  // namespace kernels

namespace mikk {

const LaneKernels& lanes_of(InstructionSet set) {
  switch (set) {
#if defined(DARBOUX_WITH_AVX2)
    case InstructionSet::avx2:
      return kernels::mikktspace_table_avx2;
#endif
#if defined(DARBOUX_WITH_AVX512)
    case InstructionSet::avx512:
      return kernels::mikktspace_table_avx512;
#endif
    default:
      return kernels::mikktspace_table_baseline;
  }
}

void Connectivity::differentiate(bool lengths) {
  directions_ = reused<Directions>(scratch_, good_);
  orientation_ = memory_.take<Orientation>(good_);
  if (lengths) lengths_ = memory_.take<Lengths>(good_);
  const auto arc_cosine = [](float x) { return static_cast<float>(std::acos(static_cast<double>(x))); };
  std::atomic<bool> any = false;
  parallel_ranges(
      good_, threads_,
      [&](std::size_t begin, std::size_t end) {
        constexpr std::size_t most = 256;
        std::array<Index, 3 * most> vertices;
        for (std::size_t first = begin; first < end; first += most) {
          const std::size_t count = std::min(most, end - first);
          for (std::size_t k = 0; k < 3 * count; ++k) vertices[k] = source(3 * first + k);
          if (lanes_.differentiate({mesh_.positions.data(), mesh_.normals.data(), mesh_.uvs.data(),
                                    static_cast<Index>(mesh_.vertex_count() - 1), vertices.data(), count,
                                    range_.scale, range_.shrink_positions, range_.shrink_uvs, arc_cosine,
                                    directions_.data() + first, orientation_.data() + first,
                                    lengths ? lengths_.data() + first : nullptr}))
            any = true;
        }
      },
      least_triangles);
  any_ = any;
  // Both triangles of a quad get the orientation of the one with the larger uv area.
  if (mesh_.face_sizes.empty()) return;
  const auto area2 = [&](std::size_t t) {
    std::array<const float*, 3> uv;
    for (std::size_t k = 0; k < 3; ++k) uv[k] = &mesh_.uvs[2 * std::size_t{source(3 * t + k)}];
    return (uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) - (uv[1][1] - uv[0][1]) * (uv[2][0] - uv[0][0]);
  };
  for (std::size_t t = 0; t + 1 < good_; ++t)
    if (face(t) == face(t + 1)) {
      Orientation &a = orientation_[t], &b = orientation_[t + 1];
      if (a.preserves != b.preserves) {
        if (b.any != 0 || std::fabs(area2(t)) >= std::fabs(area2(t + 1)))
          b.preserves = a.preserves;
        else
          a.preserves = b.preserves;
      }
      ++t;
    }
}

void Connectivity::find_parts(std::span<const Index> corners, std::vector<Part>& parts) const {
  const std::size_t room = (corners.size() + parts_at_once - 1) / parts_at_once * parts_at_once;
  if (parts.size() < room) parts.resize(room);
  lanes_.find_parts(directions_.data(), corners.data(), corners.size(),
                    &mesh_.normals[3 * source(corners[0])], parts.data());
}

}  // namespace mikk
}  // namespace darboux
