#include "read_png.h"

#include <algorithm>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <new>
#include <vector>

#include <png.h>

#include <darboux/error.h>

#include "base/text.h"
#include "image_formats.h"
#include "png_failure.h"

namespace darboux::io {
namespace {

constexpr std::uint64_t most_texels = std::uint64_t{1} << 28, most_interlaced = std::uint64_t{1} << 24;

// The state seen by libpng's callbacks.
struct Source {
  std::string_view bytes;
  PngFailure failure{};
};

void on_read(png_structp png, png_bytep to, std::size_t count) {
  Source& source = *static_cast<Source*>(png_get_io_ptr(png));
  if (count > source.bytes.size()) png_error(png, "the image ends early");
  std::memcpy(to, source.bytes.data(), count);
  source.bytes.remove_prefix(count);
}

struct Header {
  PngHeader seen;
  int passes = 1, channels = 3;
  std::size_t row_bytes = 0;
  char tag[32] = "";
};

void note_colour_tag(png_structp png, png_infop info, Header& header) {
  png_fixed_point gamma = PNG_FP_1;
  png_get_gAMA_fixed(png, info, &gamma);
  if (png_get_valid(png, info, PNG_INFO_iCCP) != 0)
    std::strcpy(header.tag, "iCCP");
  else if (png_get_valid(png, info, PNG_INFO_sRGB) != 0)
    std::strcpy(header.tag, "sRGB");
  else if (gamma != PNG_FP_1)
    std::snprintf(header.tag, sizeof header.tag, "gAMA %d.%05d", gamma / PNG_FP_1, gamma % PNG_FP_1);
}

// The steps that libpng may leave by longjmp, so they own nothing.
bool read_header(png_structp png, png_infop info, Source& source, bool keep_alpha, Header& header) {
  if (setjmp(source.failure.jump) != 0) return false;
  png_read_info(png, info);
  header.seen.width = png_get_image_width(png, info);
  header.seen.height = png_get_image_height(png, info);
  const int type = png_get_color_type(png, info);
  header.seen.palette = type == PNG_COLOR_TYPE_PALETTE;
  header.seen.grey = (type & PNG_COLOR_MASK_COLOR) == 0;
  header.seen.alpha = (type & PNG_COLOR_MASK_ALPHA) != 0 || png_get_valid(png, info, PNG_INFO_tRNS) != 0;
  note_colour_tag(png, info, header);
  png_set_expand(png);
  if (!keep_alpha) png_set_strip_alpha(png);
  png_set_gray_to_rgb(png);
  header.passes = png_set_interlace_handling(png);
  png_read_update_info(png, info);
  header.seen.bits = png_get_bit_depth(png, info);
  header.channels = png_get_channels(png, info);
  header.row_bytes = png_get_rowbytes(png, info);
  return true;
}

bool read_row(png_structp png, Source& source, png_bytep row) {
  if (setjmp(source.failure.jump) != 0) return false;
  png_read_row(png, row, nullptr);
  return true;
}

bool read_end(png_structp png, Source& source) {
  if (setjmp(source.failure.jump) != 0) return false;
  png_read_end(png, nullptr);
  return true;
}

void read_rows(const std::string& file, const std::string& what, std::string_view bytes, bool keep_alpha,
               const std::function<void(const PngHeader&)>& on_header, const TakeRow& take);

}  // namespace

bool is_png(std::string_view bytes) {
  return bytes.starts_with("\x89PNG\r\n\x1a\n");
}

void read_png(const std::string& file, const std::string& what, std::string_view bytes, const TakeRow& take) {
  read_rows(file, what, bytes, false, {}, take);
}

void read_png(const std::string& file, const std::string& what, std::string_view bytes,
              const std::function<void(const PngHeader&)>& on_header, const TakeRow& take) {
  read_rows(file, what, bytes, true, on_header, take);
}

namespace {

void read_rows(const std::string& file, const std::string& what, std::string_view bytes, bool keep_alpha,
               const std::function<void(const PngHeader&)>& on_header, const TakeRow& take) {
  Source source{.bytes = bytes};
  const auto fail = [&](const std::string& got) {
    throw FileError(file, (what.empty() ? "" : what + ": ") + expected_got("a PNG image", got));
  };
  struct Png {
    png_structp png = nullptr;
    png_infop info = nullptr;
    Png() = default;
    Png(const Png&) = delete;
    Png& operator=(const Png&) = delete;
    ~Png() { png_destroy_read_struct(&png, &info, nullptr); }
  } reader;
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source.failure, on_png_error, on_png_warning);
  if (reader.png) reader.info = png_create_info_struct(reader.png);
  if (!reader.info) throw std::bad_alloc();
  png_set_read_fn(reader.png, &source, on_read);
  Header header;
  if (!read_header(reader.png, reader.info, source, keep_alpha, header)) fail(source.failure.message);
  const PngHeader& seen = header.seen;
  header.seen.colour_tag = header.tag;
  const bool interlaced = header.passes > 1;
  if (const std::uint64_t most = interlaced ? most_interlaced : most_texels;
      std::uint64_t{seen.width} * seen.height > most)
    fail("one of " + std::to_string(seen.width) + " x " + std::to_string(seen.height) + ", more than " +
         std::to_string(most) + " texels");
  if (on_header) on_header(seen);
  // In interlaced images each pass writes some texels of every row.
  std::vector<unsigned char> pixels(header.row_bytes * (interlaced ? seen.height : 1));
  const auto row = [&](std::size_t y) { return pixels.data() + (interlaced ? y * header.row_bytes : 0); };
  for (int pass = 0; interlaced && pass < header.passes; ++pass)
    for (std::size_t y = 0; y < seen.height; ++y)
      if (!read_row(reader.png, source, row(y))) fail(source.failure.message);
  std::vector<std::uint16_t> rgb(static_cast<std::size_t>(header.channels) * seen.width);
  for (std::size_t y = 0; y < seen.height; ++y) {
    if (!interlaced && !read_row(reader.png, source, row(y))) fail(source.failure.message);
    const unsigned char* bytes_of_row = row(y);
    for (std::size_t i = 0; i < rgb.size(); ++i)  // most significant byte first
      rgb[i] = seen.bits == 16
                   ? static_cast<std::uint16_t>(bytes_of_row[2 * i] << 8 | bytes_of_row[2 * i + 1])
                   : bytes_of_row[i];
    if (!take(rgb, seen.bits)) return;
  }
  if (on_header && !read_end(reader.png, source)) fail(source.failure.message);
}

}  // namespace

std::string colour_tag_of_png(const std::string& file, std::string_view bytes) {
  std::string tag;
  read_png(
      file, "", bytes, [&](const PngHeader& header) { tag = header.colour_tag; },
      [](std::span<const std::uint16_t>, int) { return false; });
  return tag;
}

Image image_of_png(const std::string& file, std::string_view bytes, const ReadImageOptions& options) {
  Image image;
  std::size_t done = 0;
  read_png(
      file, "", bytes,
      [&](const PngHeader& header) {
        if (header.palette || header.grey)
          throw FileError(file, expected_got("a PNG image of red, green and blue",
                                             header.palette ? "one with a palette" : "a grey one"));
        if (!header.colour_tag.empty()) refuse_colour_tag(file, header.colour_tag, options);
        const std::uint64_t texel_bytes = (header.alpha ? 4u : 3u) * static_cast<unsigned>(header.bits / 8);
        check_image_size(file, header.width, header.height, texel_bytes, bytes.size(), options);
        constexpr std::uint64_t deflate = 1032;  // times, at most
        check_compression(file, std::uint64_t{header.width} * header.height * texel_bytes, bytes.size(),
                          deflate);
        image = Image(static_cast<int>(header.width), static_cast<int>(header.height), header.alpha ? 4 : 3,
                      header.bits == 16 ? SampleType::u16 : SampleType::u8);
      },
      [&](std::span<const std::uint16_t> row, int) {
        std::visit([&](auto& samples) { std::copy(row.begin(), row.end(), samples.begin() + done); },
                   image.samples);
        done += row.size();
        return true;
      });
  return image;
}

}  // namespace darboux::io
