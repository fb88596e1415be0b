#include <algorithm>
#include <array>
#include <variant>

#include <darboux/error.h>
#include <darboux/image_files.h>
#include <darboux/io.h>

#include "base/extension.h"
#include "base/text.h"
#include "budget.h"
#include "files.h"
#include "image_formats.h"
#include "read_png.h"

namespace darboux {
namespace io {

void check_image_size(const std::string& file, std::uint64_t width, std::uint64_t height,
                      std::uint64_t texel_bytes, std::uint64_t file_bytes, const ReadImageOptions& options) {
  constexpr std::uint64_t most_texels = std::uint64_t{1} << 28, longest = 1 << 20;
  if (width < 1 || height < 1 || width > longest || height > longest || width * height > most_texels)
    throw FileError(file, expected_got("an image of 1 to " + std::to_string(most_texels) + " texels",
                                       std::to_string(width) + " x " + std::to_string(height)));
  Budget({.max_memory = options.max_memory}, file_bytes)
      .take(width * height * texel_bytes, FilePlace{file},
            "an image of " + std::to_string(width) + " x " + std::to_string(height));
}

void check_compression(const std::string& file, std::uint64_t raw_bytes, std::uint64_t bytes,
                       std::uint64_t ratio) {
  if (raw_bytes / ratio > bytes)
    throw FileError(file, expected_got("an image of at most " + std::to_string(ratio) + " times its bytes",
                                       std::to_string(raw_bytes) + " from " + std::to_string(bytes)));
}

void refuse_colour_tag(const std::string& file, const std::string& tag, const ReadImageOptions& options) {
  if (!options.drop_colour_tags)
    throw FileError(file, expected_got("linear numbers, as normal maps hold them, or --drop-colour-tags",
                                       "an image that says it is not linear (" + tag + ")"));
}

}  // namespace io

Image read_image(const std::string& path, const ReadImageOptions& options) {
  io::expect_regular_file(path);
  return read_image(path, io::read_file(path), options);
}

Image read_image(const std::string& name, std::string_view bytes, const ReadImageOptions& options) {
  if (io::is_png(bytes)) return io::image_of_png(name, bytes, options);
  if (io::is_exr(bytes)) return io::image_of_exr(name, bytes, options);
  if (extension_of(name) == ".tga") return io::image_of_tga(name, bytes, options);
  throw FileError(name, expected_got("a PNG, TGA or EXR image",
                                     bytes.starts_with("\xff\xd8\xff") ? "a JPEG" : "something else"));
}

std::string image_colour_tag(const std::string& path) {
  io::expect_regular_file(path);
  return image_colour_tag(path, io::read_file(path));
}

std::string image_colour_tag(const std::string& name, std::string_view bytes) {
  if (io::is_png(bytes)) return io::colour_tag_of_png(name, bytes);
  return extension_of(name) == ".tga" ? io::colour_tag_of_tga(bytes) : "";
}

std::span<const SampleType> image_types(const std::string& path) {
  static constexpr std::array png{SampleType::u8, SampleType::u16}, tga{SampleType::u8, SampleType::u8},
      exr{SampleType::f32, SampleType::f32};
  const std::string extension = extension_of(path);
  if (extension == ".png") return png;
  if (extension == ".tga") return std::span(tga).first(1);
  if (extension == ".exr") return std::span(exr).first(1);
  throw ParameterError(path,
                       expected_got("a name that ends in .png, .tga or .exr", io::in_quotes(extension)));
}

void write_image(OutputFile& file, const std::string& path, const Image& image) {
  const auto types = image_types(path);
  if (std::find(types.begin(), types.end(), image.type()) == types.end())
    throw ParameterError(path, expected_got(types.back() == SampleType::f32  ? "32-bit floats"
                                            : types.back() == SampleType::u8 ? "8 bits"
                                                                             : "8 or 16 bits",
                                            image.type() == SampleType::f32   ? "32-bit floats"
                                            : image.type() == SampleType::u16 ? "16 bits"
                                                                              : "8 bits"));
  const std::size_t count = std::visit([](const auto& s) { return s.size(); }, image.samples);
  if (image.width < 1 || image.height < 1 || (image.channels != 3 && image.channels != 4) ||
      count != image.texels() * static_cast<std::size_t>(image.channels))
    throw ParameterError(
        path, expected_got("width * height * channels samples, of 3 or 4 channels",
                           std::to_string(count) + " for " + std::to_string(image.width) + " x " +
                               std::to_string(image.height) + " of " + std::to_string(image.channels)));
  const std::string extension = extension_of(path);
  if (extension == ".png")
    io::write_png(file, path, image);
  else
    file.write(extension == ".tga" ? io::tga_of(image) : io::exr_of(path, image));
  file.commit();
}

void write_image(const std::string& path, const Image& image) {
  image_types(path);
  OutputFile file(path);
  write_image(file, path, image);
}

}  // namespace darboux
