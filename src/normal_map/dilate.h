/// \file dilate.h
/// Islands grow into the gutter between them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <darboux/normal_map.h>

namespace darboux::normal_map {

/// Gives empty texels within so many steps of a covered one its channels, but for alpha. Of several that are
/// equally near, those beside and above come first. \param wraps across the map's edges, along u and v
/// \returns how many texels were filled. Cost: linear in the texels.
std::size_t dilate(Image& image, std::vector<TexelState>& states, int steps, std::array<bool, 2> wraps);

}  // namespace darboux::normal_map
