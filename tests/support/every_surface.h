// Typed tests over the catalogue.
#pragma once

#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/catalogue.h>

namespace darboux {

/// What gtest shows of a surface.
inline void PrintTo(const AnySurface& surface, std::ostream* out) {
  *out << surface.specification();
}

}  // namespace darboux

namespace darboux::test {

template <class List>
struct SurfaceTypes;
template <class... Surfaces>
struct SurfaceTypes<SurfaceList<Surfaces...>> {
  using type = ::testing::Types<Surfaces...>;
};
/// The catalogue for TYPED_TEST_SUITE.
using EveryCatalogueSurface = SurfaceTypes<Catalogue>::type;

/// Names the typed tests by surface.
struct SurfaceNames {
  template <class X>
  static std::string GetName(int) {
    return std::string(X::info.name);
  }
};

}  // namespace darboux::test
