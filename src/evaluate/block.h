// Block sizes of a call.
#pragma once

#include <cstddef>

#include "evaluate/kernels/work.h"

namespace darboux::evaluation {

using kernels::batch_size;
using kernels::group_size;

// The maximum number of points in a kernel call. The last call may get up to batch_size<T> - 1 more, if the
// rest would be smaller than batch_size<T>.
constexpr std::size_t block_points = 1024;
template <class T>
constexpr std::size_t block_room = block_points + batch_size<T> + group_size<T>;
// The number of grid columns whose sines are computed at once.
template <class T>
constexpr std::size_t most_columns = 4096 / sizeof(T);

// Shorter rows of a grid go through a kernel together, about this many of their points at a time.
template <class T>
constexpr std::size_t joined_rows_below = 2048 / sizeof(T);
template <class T>
constexpr std::size_t joined_points = 2560 / sizeof(T);

}  // namespace darboux::evaluation
