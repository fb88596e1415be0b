// TGA images, through stb.
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include <darboux/error.h>

#include "base/text.h"
#include "image_formats.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_TGA
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS (1 << 20)
#include <stb_image.h>
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

namespace darboux::io {
namespace {

constexpr std::size_t header_size = 18;

class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}
  std::size_t size() const { return bytes_.size(); }
  std::size_t u8(std::size_t at) const { return static_cast<unsigned char>(bytes_[at]); }
  std::size_t u16(std::size_t at) const { return u8(at) | u8(at + 1) << 8; }
  std::size_t u32(std::size_t at) const { return u16(at) | u16(at + 2) << 16; }
  std::string_view text(std::size_t at, std::size_t count) const { return bytes_.substr(at, count); }

 private:
  std::string_view bytes_;
};

// Whether all texels are present: stb fills in zeros for missing ones.
bool is_whole(const Bytes& bytes, std::size_t texels, std::size_t texel_bytes, bool run_length) {
  std::size_t at = header_size + bytes.u8(0);
  if (!run_length) return bytes.size() >= at && (bytes.size() - at) / texel_bytes >= texels;
  for (std::size_t done = 0; done < texels;) {
    if (at >= bytes.size()) return false;
    const std::size_t packet = bytes.u8(at), count = (packet & 127) + 1;
    at += 1 + texel_bytes * (packet >= 128 ? 1 : count);
    done += count;
  }
  return at <= bytes.size();
}

// The gamma of the extension area; 0 if there is none.
double gamma_of(const Bytes& bytes) {
  constexpr std::size_t footer = 26, gamma_at = 478;
  if (bytes.size() < header_size + footer) return 0;
  const std::size_t at = bytes.size() - footer;
  if (bytes.text(at + 8, 16) != "TRUEVISION-XFILE") return 0;
  const std::size_t area = bytes.u32(at);
  if (area == 0 || area + gamma_at + 4 > at) return 0;
  const std::size_t below = bytes.u16(area + gamma_at + 2);
  return below == 0 ? 0 : static_cast<double>(bytes.u16(area + gamma_at)) / static_cast<double>(below);
}

}  // namespace

std::string colour_tag_of_tga(std::string_view bytes) {
  const double gamma = gamma_of(Bytes(bytes));
  return gamma == 0 || gamma == 1 ? "" : "gamma " + rounded(gamma, 3);
}

Image image_of_tga(const std::string& file, std::string_view content, const ReadImageOptions& options) {
  const Bytes bytes(content);
  const auto fail = [&](const std::string& got) {
    throw FileError(file, expected_got("a TGA image of true colour, 24 or 32 bits", got));
  };
  if (bytes.size() < header_size) fail(std::to_string(bytes.size()) + " bytes");
  const std::size_t type = bytes.u8(2), bits = bytes.u8(16), width = bytes.u16(12), height = bytes.u16(14);
  if (type == 1 || type == 9 || bytes.u8(1) != 0) fail("one with a palette");
  if (type == 3 || type == 11) fail("a grey one");
  if (type != 2 && type != 10) fail("a file of type " + std::to_string(type));
  if (bits != 24 && bits != 32) fail(std::to_string(bits) + " bits");
  constexpr std::size_t from_right = 16;
  if ((bytes.u8(17) & from_right) != 0) fail("rows that run from right to left");
  check_image_size(file, width, height, 2 * bits / 8, bytes.size(), options);  // stb's and ours
  if (!is_whole(bytes, width * height, bits / 8, type == 10)) fail("a file that ends early");
  if (const std::string tag = colour_tag_of_tga(content); !tag.empty()) refuse_colour_tag(file, tag, options);
  int w = 0, h = 0, channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> texels(
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(content.data()),
                            static_cast<int>(content.size()), &w, &h, &channels, static_cast<int>(bits / 8)),
      stbi_image_free);
  if (!texels) fail(stbi_failure_reason());
  Image image(w, h, static_cast<int>(bits / 8), SampleType::u8);
  auto& samples = std::get<0>(image.samples);
  std::memcpy(samples.data(), texels.get(), samples.size());
  return image;
}

std::string tga_of(const Image& image) {
  std::string bytes;
  const auto append = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
  };
  if (stbi_write_tga_to_func(append, &bytes, image.width, image.height, image.channels,
                             std::get<0>(image.samples).data()) == 0)
    throw std::bad_alloc();
  return bytes;
}

}  // namespace darboux::io
