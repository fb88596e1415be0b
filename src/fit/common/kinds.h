// Properties of kinds of surface that every fit needs.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <darboux/any_surface.h>

namespace darboux::fit {

// Evidence that decides between two kinds, on the scale of the Bayesian information criterion: odds of
// exp(5).
inline constexpr double margin = 10;

// "a sphere", "an ellipsoid"
std::string with_article(std::string_view kind);

// Whether the k-th parameter of such a surface may be 0: not if that makes it another kind.
bool may_be_zero(const AnySurface& surface, std::size_t k);

}  // namespace darboux::fit
