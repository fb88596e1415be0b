// The kernels of one surface on one instruction set. CMake writes a source file for each header of surfaces/
// that includes this and expands DARBOUX_SURFACE_KERNELS for the header's name; DARBOUX_ISA names the
// instruction set.
#pragma once

#include <utility>

#include <darboux/catalogue.h>

#include "batch_loop.h"
#include "index_in_catalogue.h"

namespace darboux::kernels {
namespace {

// A catalogue's type over T.
template <class T, class X>
using OverT = decltype(darboux::rebind<T>(std::declval<const X&>()));

template <class X, class T, Variant variant>
constexpr Kernel<T> kernel_of() {
  return {&kernel<X, T, variant>, Batch<X, T, variant>::lanes == batch_size<T>,
          detail::HasCurveAlong<X, 1> || detail::HasNet<X>};
}

template <class T, class Surface>
constexpr std::array<Kernel<T>, 3> kernels_over() {
  using X = OverT<T, Surface>;
  // Frames without a closed form need all first partials: a long formula is compiled once for both. Not on
  // AVX-512, where a separate kernel for frames saves up to a fifth of the time.
  constexpr bool together = LongFormula<X, T> && !HasClosedFrame<X> && sizeof(Register<T>) < line;
  constexpr Variant frames = together ? Variant::first : Variant::frames;
  return {kernel_of<X, T, frames>(), kernel_of<X, T, Variant::first>(),
          kernel_of<X, T, Variant::everything>()};
}

template <class Surface>
constexpr SurfaceKernels kernels_of() {
  return {kernels_over<double, Surface>(), kernels_over<float, Surface>()};
}

}  // namespace
}  // namespace darboux::kernels

#define DARBOUX_SURFACE_KERNELS(header)                                                                 \
  namespace darboux::kernels {                                                                          \
  extern const SurfaceKernels DARBOUX_OF_SURFACE(header);                                               \
  constinit const SurfaceKernels DARBOUX_OF_SURFACE(header) = kernels_of<DARBOUX_SURFACE_OF(header)>(); \
  }
