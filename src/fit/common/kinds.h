// What every fit knows of kinds of surface.
#pragma once

#include <string>
#include <string_view>

#include <darboux/any_surface.h>

namespace darboux::fit {

// Evidence that decides between two kinds, on the scale of the Bayesian information criterion: odds of
// exp(5).
inline constexpr double margin = 10;

// "a sphere", "an ellipsoid"
std::string with_article(std::string_view kind);

// Whether a surface of the kind may have 0 for this parameter: not where that makes it another kind.
bool may_be_zero(std::string_view kind, const ParameterValue& parameter);

}  // namespace darboux::fit
