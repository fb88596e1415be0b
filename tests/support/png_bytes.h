// PNG files of given texels, written with libpng.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <png.h>

namespace darboux::test {

struct PngLayout {
  int bits = 8;
  int colour_type = PNG_COLOR_TYPE_RGB;
  bool interlaced = false;
};

// \param samples rows from the top, all channels of a texel together; of PNG_COLOR_TYPE_PALETTE indices
// \param palette red, green, blue of each
inline std::string png_bytes(std::uint32_t width, std::uint32_t height,
                             const std::vector<std::uint16_t>& samples, const PngLayout& layout = {},
                             const std::vector<std::uint8_t>& palette = {}) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep from, std::size_t n) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<const char*>(from), n);
      },
      nullptr);
  png_set_IHDR(png, info, width, height, layout.bits, layout.colour_type,
               layout.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  std::vector<png_color> colours;
  for (std::size_t i = 0; i + 2 < palette.size(); i += 3)
    colours.push_back({palette[i], palette[i + 1], palette[i + 2]});
  if (!colours.empty()) png_set_PLTE(png, info, colours.data(), static_cast<int>(colours.size()));
  png_write_info(png, info);
  std::vector<std::uint8_t> data;
  for (const std::uint16_t sample : samples) {
    if (layout.bits == 16) data.push_back(static_cast<std::uint8_t>(sample >> 8));
    data.push_back(static_cast<std::uint8_t>(sample & 255));
  }
  std::vector<png_bytep> rows;
  for (std::uint32_t y = 0; y < height; ++y) rows.push_back(data.data() + y * (data.size() / height));
  png_write_image(png, rows.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

}  // namespace darboux::test
