/// \file read_png.h
/// PNG images, through libpng.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace darboux::io {

/// Whether the bytes have the PNG signature.
bool is_png(std::string_view bytes);

/// Receives a row of texels, red, green, blue: the numbers as stored, 0 to 2^bits - 1, without gamma
/// correction and without alpha. \returns whether to continue
using TakeRow = std::function<bool(std::span<const std::uint16_t> rgb, int bits)>;

/// Reads the rows from the top, for grey, palette and colour images of all depths; fewer than 8 bits are
/// scaled to 8. At most 2^28 texels; 2^24 for interlaced images, which are kept in memory. \param what the
/// image, for messages
/// \throws FileError
void read_png(const std::string& file, const std::string& what, std::string_view bytes, const TakeRow& take);

/// The header of a PNG.
struct PngHeader {
  std::uint32_t width = 0, height = 0;
  int bits = 0;  ///< of a channel, 8 or 16 once decoded
  bool palette = false, grey = false, alpha = false;
  std::string colour_tag;  ///< a chunk that says the numbers are not linear: "sRGB", "gAMA 0.45455"; or empty
};

/// The same, but passes the header first, and includes alpha (four numbers per texel) if there is one. An
/// exception of on_header ends reading. The file is read to its end.
void read_png(const std::string& file, const std::string& what, std::string_view bytes,
              const std::function<void(const PngHeader&)>& on_header, const TakeRow& take);

}  // namespace darboux::io
