// How much of a call is done at once.
#pragma once

#include <cstddef>

#include "evaluate/kernels/work.h"

namespace darboux::evaluation {

using kernels::batch_size;
using kernels::group_size;

// The most points in a kernel call, plus fewer than batch_size<T> where a last call would otherwise get fewer
// than that.
constexpr std::size_t block_points = 1024;
template <class T>
constexpr std::size_t block_room = block_points + batch_size<T> + group_size<T>;
// Columns of a grid whose sines are taken at once.
template <class T>
constexpr std::size_t most_columns = 4096 / sizeof(T);

// Rows of a grid that are shorter go through a kernel together, about so many of their points at once.
template <class T>
constexpr std::size_t joined_rows_below = 2048 / sizeof(T);
template <class T>
constexpr std::size_t joined_points = 2560 / sizeof(T);

}  // namespace darboux::evaluation
