/// \file eval_attributes.h
/// The attributes that `eval` can write: those of batches, and the forms, computed point by point.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <darboux/any_surface.h>
#include <darboux/attributes.h>

namespace darboux {

struct EvalAttribute {
  std::string_view name;
  std::size_t components;
  std::vector<std::string_view> columns;  ///< suffixes of the name in a CSV header, one per column
  std::size_t row;                        ///< JSON: length of inner lists; 0: no inner lists
  std::optional<Attribute> batch;         ///< empty: computed from the sample, by compute
  /// From a sample of the surface, to `components` numbers.
  void (*compute)(const AnySurface&, const Sample<double>&, double* to);
};

/// All: those of attributes.h in their order, then dndu, dndv, first_form (E, F, G), second_form (L, M, N),
/// christoffel (Γ^u_uu, Γ^u_uv, Γ^u_vv, the same of Γ^v), condition (1 / sine of the angle between dpdu
/// and dpdv: the factor by which a frame computed from them amplifies their rounding errors). NaN where
/// undefined.
std::span<const EvalAttribute> eval_attributes();

}  // namespace darboux
