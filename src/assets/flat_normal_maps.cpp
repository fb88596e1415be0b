#include "flat_normal_maps.h"

#include <cmath>

#include <darboux/error.h>

#include "io/files.h"
#include "io/png.h"

namespace darboux {
namespace {

using io::JsonCursor;

bool is_flat(const io::Image& image, bool two_channels) {
  const double most = (1 << image.bits) - 1, step = 1.0 / 255;
  constexpr double rounding = 1e-12;
  for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
    const auto component = [&](std::size_t k) { return 2 * image.rgb[i + k] / most - 1; };
    if (std::fabs(component(0)) > step + rounding || std::fabs(component(1)) > step + rounding) return false;
    if (!two_channels && component(2) < 1 - 2 * step - rounding) return false;
  }
  return true;
}

// The extensions that name an image beside, or instead of, the texture's own.
constexpr const char* other_images[] = {"KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif",
                                        "MSFT_texture_dds"};

}  // namespace

FlatNormalMaps::Answer FlatNormalMaps::of_texture(std::size_t index, bool two_channels) {
  const JsonCursor root = file_.root();
  const std::string name = "texture " + std::to_string(index);
  if (!root.has("textures") || index >= root.at("textures").size()) return {false, name + " is not there"};
  const JsonCursor texture = root.at("textures").at(index);
  bool any = false;
  const auto look_at = [&](const JsonCursor& owner) {
    any = true;
    return of_image(owner.at("source"), two_channels);
  };
  for (const char* extension : other_images)
    if (const auto other = texture.extension(extension); other && other->has("source"))
      if (Answer answer = look_at(*other); !answer.flat) return answer;
  if (texture.has("source"))
    if (Answer answer = look_at(texture); !answer.flat) return answer;
  return any ? Answer{true, {}} : Answer{false, name + " has no image"};
}

const FlatNormalMaps::Answer& FlatNormalMaps::of_image(const JsonCursor& index, bool two_channels) {
  const JsonCursor image = file_.element("images", index);
  const auto [place, is_new] = known_.try_emplace({index.integer(), two_channels});
  Answer& answer = place->second;
  if (!is_new) return answer;
  const std::string name = "image " + std::to_string(index.integer());
  try {
    const std::string bytes = io::image_bytes(file_, image);
    if (io::is_png(bytes))
      answer.flat = is_flat(io::read_png(file_.path, name, bytes), two_channels);
    else
      answer.note = name + " is not a PNG, so that its texels are not looked at";
  } catch (const FileError& e) {
    answer.note = name + " cannot be read: " + e.what();
  }
  return answer;
}

}  // namespace darboux
