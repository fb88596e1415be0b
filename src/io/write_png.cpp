#include "write_png.h"

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <exception>
#include <new>
#include <vector>

#include <png.h>

#include <darboux/error.h>
#include <darboux/io.h>

#include "base/text.h"
#include "image_formats.h"
#include "png_failure.h"

namespace darboux::io {
namespace {

// The state seen by libpng's callbacks.
struct Target {
  OutputFile& file;
  PngFailure failure{};
  std::exception_ptr exception{};  // of on_write
};

void on_write(png_structp png, png_bytep bytes, std::size_t count) {
  Target& target = *static_cast<Target*>(png_get_io_ptr(png));
  try {
    target.file.write({reinterpret_cast<const char*>(bytes), count});
    return;
  } catch (...) {
    target.exception = std::current_exception();
  }
  png_error(png, "the file cannot be written");
}

void on_flush(png_structp) {}

// The steps that libpng may leave by longjmp, so they own nothing.
bool write_header(png_structp png, png_infop info, Target& target, const Image& image) {
  if (setjmp(target.failure.jump) != 0) return false;
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height),
               image.type() == SampleType::u16 ? 16 : 8,
               image.channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  return true;
}

bool write_row(png_structp png, Target& target, png_const_bytep row) {
  if (setjmp(target.failure.jump) != 0) return false;
  png_write_row(png, row);
  return true;
}

bool write_end(png_structp png, Target& target) {
  if (setjmp(target.failure.jump) != 0) return false;
  png_write_end(png, nullptr);
  return true;
}

}  // namespace

void write_png(OutputFile& file, const std::string& path, const Image& image) {
  Target target{.file = file};
  struct Png {
    png_structp png = nullptr;
    png_infop info = nullptr;
    Png() = default;
    Png(const Png&) = delete;
    Png& operator=(const Png&) = delete;
    ~Png() { png_destroy_write_struct(&png, &info); }
  } writer;
  writer.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &target.failure, on_png_error, on_png_warning);
  if (writer.png) writer.info = png_create_info_struct(writer.png);
  if (!writer.info) throw std::bad_alloc();
  png_set_write_fn(writer.png, &target, on_write, on_flush);
  const auto expect = [&](bool done) {
    if (done) return;
    if (target.exception) std::rethrow_exception(target.exception);
    throw FileError(path, expected_got("a PNG image to be written", target.failure.message));
  };
  expect(write_header(writer.png, writer.info, target, image));
  const std::size_t width = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
  std::vector<png_byte> bytes(2 * width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    if (image.type() == SampleType::u8) {
      expect(write_row(writer.png, target, std::get<0>(image.samples).data() + y * width));
      continue;
    }
    const std::uint16_t* row = std::get<1>(image.samples).data() + y * width;
    for (std::size_t i = 0; i < width; ++i) {  // most significant byte first
      bytes[2 * i] = static_cast<png_byte>(row[i] >> 8);
      bytes[2 * i + 1] = static_cast<png_byte>(row[i] & 255);
    }
    expect(write_row(writer.png, target, bytes.data()));
  }
  expect(write_end(writer.png, target));
}

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
