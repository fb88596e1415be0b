/// \file catalogue.h
/// The list of all surfaces. A surface in it has its command-line name, its tests, its rows in the reports.
#pragma once

#include <darboux/cylinder.h>
#include <darboux/sphere.h>
#include <darboux/torus.h>

namespace darboux {

/// A list of surface templates.
template <template <class> class... Surfaces>
struct SurfaceList {
  /// Calls f(Surface<double>{}), with default parameters, for each surface.
  template <class F>
  static void for_each(F&& f) {
    (f(Surfaces<double>{}), ...);
  }
};

using Catalogue = SurfaceList<Sphere,  //
                              Torus,   //
                              Cylinder>;

/// The same surface over another scalar, e.g. rebind<mp>(Torus{1.0, 0.4}): parameters are lifted.
template <class To, template <class> class Surface, class From>
Surface<To> rebind(const Surface<From>& surface) {
  Surface<To> result;
  if constexpr (HasParameters<Surface<From>>) {
    constexpr auto from = Surface<From>::parameters();
    constexpr auto to = Surface<To>::parameters();
    for (std::size_t i = 0; i < from.size(); ++i) to[i].of(result) = lift<To>(from[i].of(surface));
  }
  return result;
}

}  // namespace darboux
