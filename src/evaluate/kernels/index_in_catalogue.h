// The place of a surface in the catalogue, by the name of its header.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <tuple>

#include <darboux/catalogue.h>

#define DARBOUX_STRING_(text) #text
#define DARBOUX_STRING(text) DARBOUX_STRING_(text)
#define DARBOUX_JOIN_(a, b) a##_##b
#define DARBOUX_JOIN(a, b) DARBOUX_JOIN_(a, b)
#define DARBOUX_TABLE(isa) DARBOUX_JOIN(table, isa)
// The catalogue's type of a header.
#define DARBOUX_SURFACE_OF(header) \
  ::darboux::kernels::SurfaceAt<::darboux::kernels::index_in_catalogue(DARBOUX_STRING(header))>
#define DARBOUX_OF_SURFACE(header) DARBOUX_JOIN(DARBOUX_JOIN(table, header), DARBOUX_ISA)

namespace darboux::kernels {
namespace {

// "klein_bottle" is "klein-bottle" there. Does not compile for a header that the catalogue does not list.
template <class... X>
consteval std::size_t index_in(std::string_view header, SurfaceList<X...>) {
  constexpr std::array<std::string_view, sizeof...(X)> names{X::info.name...};
  for (std::size_t k = 0; k < names.size(); ++k) {
    bool same = names[k].size() == header.size();
    for (std::size_t i = 0; same && i < header.size(); ++i)
      same = names[k][i] == (header[i] == '_' ? '-' : header[i]);
    if (same) return k;
  }
  throw "this header of surfaces/ has no line in catalogue.h";
}

consteval std::size_t index_in_catalogue(std::string_view header) {
  return index_in(header, Catalogue{});
}

template <class... X>
std::tuple<X...> tuple_of(SurfaceList<X...>);

template <std::size_t index>
using SurfaceAt = std::tuple_element_t<index, decltype(tuple_of(Catalogue{}))>;

}  // namespace
}  // namespace darboux::kernels
