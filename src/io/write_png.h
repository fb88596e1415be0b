/// \file write_png.h
/// PNG images, through libpng.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace darboux::io {

/// A PNG of 8 bits per channel. \param rgb rows from the top, red, green, blue, encoded as sRGB; 3 * width *
/// height of them
std::string png_of(int width, int height, std::span<const std::uint8_t> rgb);

}  // namespace darboux::io
