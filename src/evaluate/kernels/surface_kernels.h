// The kernels of one surface on one instruction set. CMake writes a source file for each header of surfaces/
// that defines DARBOUX_SURFACE as the header's name and includes this; DARBOUX_ISA names the instruction set.
#include <tuple>
#include <utility>

#include <darboux/catalogue.h>

#include "index_in_catalogue.h"
#include "kernel.h"

namespace darboux::kernels {
namespace {

// A catalogue's type over T.
template <class T, class X>
using OverT = decltype(darboux::rebind<T>(std::declval<const X&>()));

template <class... X>
std::tuple<X...> tuple_of(SurfaceList<X...>);

using Surface = std::tuple_element_t<index_in_catalogue(DARBOUX_STRING(DARBOUX_SURFACE)),
                                     decltype(tuple_of(Catalogue{}))>;

template <class T>
constexpr std::array<Kernel<T>, 3> kernels_over() {
  using X = OverT<T, Surface>;
  if constexpr (detail::in_lanes<X>)
    return {&kernel<X, T, Variant::frames>, &kernel<X, T, Variant::first>,
            &kernel<X, T, Variant::everything>};
  else
    return {};
}

}  // namespace

extern const SurfaceKernels DARBOUX_OF_SURFACE(DARBOUX_SURFACE);
constinit const SurfaceKernels DARBOUX_OF_SURFACE(DARBOUX_SURFACE){kernels_over<double>(),
                                                                   kernels_over<float>()};

}  // namespace darboux::kernels
