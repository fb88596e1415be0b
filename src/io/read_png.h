/// \file read_png.h
/// PNG images, through libpng.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace darboux::io {

/// Whether bytes begin as a PNG does.
bool is_png(std::string_view bytes);

/// A row of texels, red, green, blue: the numbers as stored, 0 to 2^bits - 1; no gamma is applied, alpha is
/// left out. \returns whether the next is wanted
using TakeRow = std::function<bool(std::span<const std::uint16_t> rgb, int bits)>;

/// Gives the rows from the top, of grey, palette and colour of all depths; of fewer than 8 bits scaled to 8.
/// At most 2^28 texels, of interlaced images, which are held whole, 2^24. \param what the image, for messages
/// \throws FileError
void read_png(const std::string& file, const std::string& what, std::string_view bytes, const TakeRow& take);

/// What the header of a PNG says.
struct PngHeader {
  std::uint32_t width = 0, height = 0;
  int bits = 0;  ///< of a channel, 8 or 16 once decoded
  bool palette = false, grey = false, alpha = false;
  std::string colour_tag;  ///< a chunk that says the numbers are not linear: "sRGB", "gAMA 0.45455"; or empty
};

/// The same with what the header says first, and with alpha, four numbers per texel, where there is one: what
/// on_header throws ends it. The file is read to its end.
void read_png(const std::string& file, const std::string& what, std::string_view bytes,
              const std::function<void(const PngHeader&)>& on_header, const TakeRow& take);

}  // namespace darboux::io
