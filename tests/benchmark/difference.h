/// \file difference.h
/// How the tangents of one maker differ from another's on a torus.
#pragma once

#include <cstddef>
#include <vector>

#include "torus_file.h"

namespace darboux::bench {

/// Over the corners of a mesh; angles in degrees, 180 for what has no direction (zero, infinity, NaN).
struct Difference {
  std::size_t corners = 0;
  std::size_t same_bits = 0;    ///< of all four numbers
  std::size_t other_signs = 0;  ///< of w
  std::size_t far = 0;          ///< angles above 0.1 degree
  double largest = 0;           ///< angle to the other's
  double from_dpdu = 0,
         rms_from_dpdu = 0;  ///< angle to the torus's dpdu, the largest and the root of the mean square
};

/// \param ours, theirs x, y, z of the tangent and the sign w of each corner of the torus
/// \throws std::runtime_error where they are not as many
Difference difference(const std::vector<float>& ours, const std::vector<float>& theirs,
                      const MeshArrays& torus);

}  // namespace darboux::bench
