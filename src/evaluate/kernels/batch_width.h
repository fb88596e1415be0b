// How many points go through a formula at once.
#pragma once

#include "lanes.h"
#include "work.h"

namespace darboux::kernels {
namespace {

// What goes through the formula at once. A line of two registers can be written past the caches from them;
// but that makes kernels slow to compile, so not where all attributes are, and not of four registers.
template <class T, Variant variant>
using Batch = Lanes<T, sizeof(Register<T>) * 2 == line && variant != Variant::everything ? 2 : 1>;

template <Variant variant>
constexpr bool writes_lines = Batch<double, variant>::lanes == batch_size<double>;

}  // namespace
}  // namespace darboux::kernels
