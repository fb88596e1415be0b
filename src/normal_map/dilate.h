/// \file dilate.h
/// Extends islands into the gutter between them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <darboux/normal_map.h>

namespace darboux::normal_map {

/// Copies the channels, except alpha, of the nearest covered texel to empty texels within `steps` steps. Of
/// several equally near ones, direct neighbours come before diagonal ones. \param wraps whether steps cross
/// the edges of the map, along u and v
/// \returns how many texels were filled. Cost: linear in the texels.
std::size_t dilate(Image& image, std::vector<TexelState>& states, int steps, std::array<bool, 2> wraps);

}  // namespace darboux::normal_map
