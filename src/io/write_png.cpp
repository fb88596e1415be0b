#include "write_png.h"

#include <new>

#include <png.h>

#include <darboux/error.h>

#include "base/text.h"

namespace darboux::io {

std::string png_of(int width, int height, std::span<const std::uint8_t> rgb) {
  if (width < 1 || height < 1 ||
      rgb.size() / 3 / static_cast<std::size_t>(width) != static_cast<std::size_t>(height))
    throw ParameterError("PNG", expected_got("an image of at least one pixel with 3 numbers each",
                                             std::to_string(width) + " x " + std::to_string(height) +
                                                 " with " + std::to_string(rgb.size())));
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb.data(), 0, nullptr) == 0)
    throw std::bad_alloc();  // nothing else can fail in memory
  bytes.resize(size);
  return bytes;
}

}  // namespace darboux::io
