// How many points go through a formula at once.
#pragma once

#include "lanes.h"
#include "work.h"

namespace darboux::kernels {
namespace {

// Formulas that can stop at an order of derivatives, those of splines, are long: one lane register at a time
// fills all registers.
template <class X, class T>
concept LongFormula = requires(const X& surface, const Lanes<T>& x) {
  surface.template jet_to<1>(x, x);
}
|| detail::HasCurveAlong<X, 0> || detail::HasCurveAlong<X, 1>;

// The points that go through the formula at once. If two registers fill a cache line, both go together, so
// that the line can be written from them past the caches. That makes kernels slow to compile, so it is not
// done for four registers or where all attributes are computed; nor for long formulas, which it makes slow to
// run: those of splines take 1.5 times as long on AVX2.
template <class X, class T, Variant variant>
using Batch =
    Lanes<T, sizeof(Register<T>) * 2 == line && variant != Variant::everything && !LongFormula<X, T> ? 2 : 1>;

}  // namespace
}  // namespace darboux::kernels
