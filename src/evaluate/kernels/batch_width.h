// How many points go through a formula at once.
#pragma once

#include "lanes.h"
#include "work.h"

namespace darboux::kernels {
namespace {

// Formulas that go to an order only are long, those of splines: they fill the registers by themselves.
template <class X, class T>
concept LongFormula = requires(const X& surface, const Lanes<T>& x) {
  surface.template jet_to<1>(x, x);
}
|| detail::HasCurveAlong<X, 0> || detail::HasCurveAlong<X, 1>;

// What goes through the formula at once. A line of two registers can be written past the caches from them;
// but that makes kernels slow to compile, so not where all attributes are, and not of four registers; and
// long formulas slow to run: those of splines take 1.5 times as long on AVX2.
template <class X, class T, Variant variant>
using Batch =
    Lanes<T, sizeof(Register<T>) * 2 == line && variant != Variant::everything && !LongFormula<X, T> ? 2 : 1>;

}  // namespace
}  // namespace darboux::kernels
