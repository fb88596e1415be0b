#include "flat_normal_maps.h"

#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>

#include <darboux/error.h>

#include "io/files.h"
#include "io/read_png.h"
#include "normal_map/flat.h"

namespace darboux {
namespace {

using io::JsonCursor;

// Stops at the first texel that is not flat.
bool is_flat(const std::string& file, const std::string& name, std::string_view bytes, bool two_channels,
             double scale) {
  bool flat = true;
  io::read_png(file, name, bytes, [&](std::span<const std::uint16_t> rgb, int bits) {
    const double most = (1 << bits) - 1;
    for (std::size_t i = 0; flat && i + 2 < rgb.size(); i += 3) {
      const auto component = [&](std::size_t k) { return 2 * rgb[i + k] / most - 1; };
      flat = normal_map::is_flat({component(0), component(1), component(2)}, scale, two_channels);
    }
    return flat;
  });
  return flat;
}

// A key for the bytes of an image: several images may share them.
std::string bytes_name(const JsonCursor& image) {
  return image.has("uri") ? image.at("uri").text()
                          : "bufferView " + std::to_string(image.at("bufferView").integer());
}

// The extensions that reference an image in addition to, or instead of, the texture's own.
constexpr const char* other_images[] = {"KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif",
                                        "MSFT_texture_dds"};

}  // namespace

FlatNormalMaps::Answer FlatNormalMaps::of(const io::FrameReader& reader) {
  if (!reader.texture) return {false, "the texture has no index"};
  if (reader.scale_animated) return {false, "its scale is animated"};
  const JsonCursor root = file_.root();
  const std::string name = "texture " + std::to_string(*reader.texture);
  if (!root.has("textures") || *reader.texture >= root.at("textures").size())
    return {false, name + " is not there"};
  const JsonCursor texture = root.at("textures").at(*reader.texture);
  const double scale = std::fmax(std::fabs(reader.scale), 1);
  bool any = false;
  const auto look_at = [&](const JsonCursor& owner) {
    any = true;
    return of_image(owner.at("source"), reader.two_channels, scale);
  };
  for (const char* extension : other_images)
    if (const auto other = texture.extension(extension); other && other->has("source"))
      if (Answer answer = look_at(*other); !answer.flat) return answer;
  if (texture.has("source"))
    if (Answer answer = look_at(texture); !answer.flat) return answer;
  return any ? Answer{true, {}} : Answer{false, name + " has no image"};
}

const FlatNormalMaps::Answer& FlatNormalMaps::of_image(const JsonCursor& index, bool two_channels,
                                                       double scale) {
  const JsonCursor image = file_.element("images", index);
  const std::string name = "image " + std::to_string(index.integer());
  const auto [place, is_new] = known_.try_emplace({bytes_name(image), two_channels, scale});
  Answer& answer = place->second;
  if (!is_new) return answer;
  try {
    const std::string bytes = io::image_bytes(file_, image, buffers_);
    if (io::is_png(bytes))
      answer.flat = is_flat(file_.path, name, bytes, two_channels, scale);
    else
      answer.note = name + " is not a PNG, so that its texels are not looked at";
  } catch (const FileError& e) {
    answer.note = name + " cannot be read: " + e.what();
  }
  return answer;
}

}  // namespace darboux
