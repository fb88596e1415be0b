#include "read_png.h"

#include <csetjmp>
#include <cstddef>
#include <cstring>
#include <new>
#include <vector>

#include <png.h>

#include <darboux/error.h>

#include "base/text.h"

namespace darboux::io {
namespace {

constexpr std::uint64_t most_texels = std::uint64_t{1} << 28, most_interlaced = std::uint64_t{1} << 24;

// What libpng's callbacks see.
struct Source {
  std::string_view bytes;
  std::jmp_buf failed;
  char message[128] = "";
};

Source& source_of(void* pointer) {
  return *static_cast<Source*>(pointer);
}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  Source& source = source_of(png_get_error_ptr(png));
  std::strncpy(source.message, message, sizeof source.message - 1);
  std::longjmp(source.failed, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep to, std::size_t count) {
  Source& source = source_of(png_get_io_ptr(png));
  if (count > source.bytes.size()) png_error(png, "the image ends early");
  std::memcpy(to, source.bytes.data(), count);
  source.bytes.remove_prefix(count);
}

struct Header {
  png_uint_32 width = 0, height = 0;
  int bits = 0, passes = 1;
  std::size_t row_bytes = 0;
};

// The steps that libpng may leave by longjmp: they own nothing.
bool read_header(png_structp png, png_infop info, Source& source, Header& header) {
  if (setjmp(source.failed) != 0) return false;
  png_read_info(png, info);
  header.width = png_get_image_width(png, info);
  header.height = png_get_image_height(png, info);
  png_set_expand(png);
  png_set_strip_alpha(png);
  png_set_gray_to_rgb(png);
  header.passes = png_set_interlace_handling(png);
  png_read_update_info(png, info);
  header.bits = png_get_bit_depth(png, info);
  header.row_bytes = png_get_rowbytes(png, info);
  return true;
}

bool read_row(png_structp png, Source& source, png_bytep row) {
  if (setjmp(source.failed) != 0) return false;
  png_read_row(png, row, nullptr);
  return true;
}

}  // namespace

bool is_png(std::string_view bytes) {
  return bytes.starts_with("\x89PNG\r\n\x1a\n");
}

void read_png(const std::string& file, const std::string& what, std::string_view bytes, const TakeRow& take) {
  Source source{.bytes = bytes, .failed = {}};
  const auto fail = [&](const std::string& got) {
    throw FileError(file, what + ": " + expected_got("a PNG image", got));
  };
  struct Png {
    png_structp png = nullptr;
    png_infop info = nullptr;
    Png() = default;
    Png(const Png&) = delete;
    Png& operator=(const Png&) = delete;
    ~Png() { png_destroy_read_struct(&png, &info, nullptr); }
  } reader;
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, on_error, on_warning);
  if (reader.png) reader.info = png_create_info_struct(reader.png);
  if (!reader.info) throw std::bad_alloc();
  png_set_read_fn(reader.png, &source, on_read);
  Header header;
  if (!read_header(reader.png, reader.info, source, header)) fail(source.message);
  const bool interlaced = header.passes > 1;
  if (const std::uint64_t most = interlaced ? most_interlaced : most_texels;
      std::uint64_t{header.width} * header.height > most)
    fail("one of " + std::to_string(header.width) + " x " + std::to_string(header.height) + ", more than " +
         std::to_string(most) + " texels");
  // Of interlaced images each pass writes some texels of every row.
  std::vector<unsigned char> pixels(header.row_bytes * (interlaced ? header.height : 1));
  const auto row = [&](std::size_t y) { return pixels.data() + (interlaced ? y * header.row_bytes : 0); };
  for (int pass = 0; interlaced && pass < header.passes; ++pass)
    for (std::size_t y = 0; y < header.height; ++y)
      if (!read_row(reader.png, source, row(y))) fail(source.message);
  std::vector<std::uint16_t> rgb(std::size_t{3} * header.width);
  for (std::size_t y = 0; y < header.height; ++y) {
    if (!interlaced && !read_row(reader.png, source, row(y))) fail(source.message);
    const unsigned char* bytes_of_row = row(y);
    for (std::size_t i = 0; i < rgb.size(); ++i)  // most significant byte first
      rgb[i] = header.bits == 16
                   ? static_cast<std::uint16_t>(bytes_of_row[2 * i] << 8 | bytes_of_row[2 * i + 1])
                   : bytes_of_row[i];
    if (!take(rgb, header.bits)) return;
  }
}

}  // namespace darboux::io
