/// \file colour_map.h
/// The colour map for errors.
#pragma once

#include <array>
#include <string>

#include <darboux/vector.h>

namespace darboux {

/// Colours at equal steps from zero to the limit, interpolated linearly in linear RGB; above the limit, the
/// last colour.
using ColourMap = std::array<Vec3<float>, 17>;

/// Viridis in linear RGB: monotonic in lightness, readable by colour-blind people and in black and white. By
/// the polynomials of degree 6 that M. Zucker fitted to it (shadertoy.com/view/WlfXRN, in the public domain).
const ColourMap& viridis();

/// The grey for values that were not compared.
inline constexpr Vec3<float> not_compared{0.2f, 0.2f, 0.2f};

/// The colour of an error; not_compared for NaN. \param limit that has the last colour
Vec3<float> colour_of(float error, double limit);

/// "#1f968b"
std::string css_colour(const Vec3<float>& linear);

}  // namespace darboux
