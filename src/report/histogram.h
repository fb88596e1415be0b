/// \file histogram.h
/// How often which error occurs, as a picture.
#pragma once

#include <span>
#include <string>

namespace darboux {

/// An SVG element for a page: angles and counts on logarithmic axes, bars in the colours of the errors, a
/// line at the limit. NaN are left out; nothing at all gives an empty text. \param what is counted: "tangent
/// errors"
std::string histogram_svg(std::span<const float> errors_deg, double limit_deg, const std::string& what);

}  // namespace darboux
