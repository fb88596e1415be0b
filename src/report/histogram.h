/// \file histogram.h
/// A histogram of errors as a picture.
#pragma once

#include <span>
#include <string>

namespace darboux {

/// An SVG element for a page: angles and counts on logarithmic axes, bars in the colours of the errors, a
/// line at the limit. NaN are excluded; without any value the text is empty. \param what the counted
/// quantity: "tangent errors"
std::string histogram_svg(std::span<const float> errors_deg, double limit_deg, const std::string& what);

}  // namespace darboux
