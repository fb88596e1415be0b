#include "png.h"

#include <csetjmp>
#include <cstddef>
#include <cstring>
#include <memory>

#include <png.h>

#include <darboux/error.h>

#include "base/text.h"

namespace darboux::io {
namespace {

constexpr std::uint64_t most_texels = std::uint64_t{1} << 26;

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
  int bits = 0;
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
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  header.bits = png_get_bit_depth(png, info);
  header.row_bytes = png_get_rowbytes(png, info);
  return true;
}

bool read_rows(png_structp png, Source& source, png_bytepp rows) {
  if (setjmp(source.failed) != 0) return false;
  png_read_image(png, rows);
  return true;
}

}  // namespace

bool is_png(std::string_view bytes) {
  return bytes.starts_with("\x89PNG\r\n\x1a\n");
}

Image read_png(const std::string& file, const std::string& what, std::string_view bytes) {
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
  if (std::uint64_t{header.width} * header.height > most_texels)
    fail("one of " + std::to_string(header.width) + " x " + std::to_string(header.height) + ", more than " +
         std::to_string(most_texels) + " texels");
  std::vector<unsigned char> pixels(header.row_bytes * header.height);
  std::vector<png_bytep> rows(header.height);
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = pixels.data() + y * header.row_bytes;
  if (!read_rows(reader.png, source, rows.data())) fail(source.message);
  Image image{header.width, header.height, header.bits, {}};
  image.rgb.reserve(std::size_t{3} * header.width * header.height);
  if (header.bits == 16)
    for (std::size_t i = 0; i + 1 < pixels.size(); i += 2)  // most significant byte first
      image.rgb.push_back(static_cast<std::uint16_t>(pixels[i] << 8 | pixels[i + 1]));
  else
    image.rgb.assign(pixels.begin(), pixels.end());
  return image;
}

}  // namespace darboux::io
