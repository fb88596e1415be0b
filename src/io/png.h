/// \file png.h
/// PNG images, through libpng.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace darboux::io {

/// Rows from the top, a texel red, green, blue; alpha is left out. The numbers as stored: no gamma is
/// applied.
struct Image {
  std::uint32_t width = 0, height = 0;
  int bits = 8;  ///< 8 or 16: the numbers go from 0 to 2^bits - 1
  std::vector<std::uint16_t> rgb;
};

/// Whether bytes begin as a PNG does.
bool is_png(std::string_view bytes);

/// Grey, palette and colour of all depths, interlaced too; of fewer than 8 bits scaled to 8. At most 2^26
/// texels. \param what the image, for messages \throws FileError
Image read_png(const std::string& file, const std::string& what, std::string_view bytes);

}  // namespace darboux::io
