/// \file image_files.h
/// Images that hold numbers, not colours: PNG, TGA and EXR. Target darboux::io.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <darboux/image.h>
#include <darboux/io.h>

namespace darboux {

struct ReadImageOptions {
  /// Whether to ignore the colour tags of the file. If false, a file whose tags say that its numbers are not
  /// linear is rejected: numbers are never converted silently.
  bool drop_colour_tags = false;
  /// The limit for the memory of the decoded texels, in bytes. Empty: as ReadOptions::max_memory.
  std::optional<std::uint64_t> max_memory{};
};

/// Reads an image: PNG or EXR, detected by content, or TGA, detected by extension.
///   PNG  8 and 16 bits, with alpha or not, interlaced too (then of at most 2^24 texels). A chunk sRGB, iCCP,
///        or gAMA of other than 1 is a colour tag.
///   TGA  true colour, 24 and 32 bits, run-length encoded or not. A gamma of other than 1 in its extension
///        area is a colour tag.
///   EXR  channels R, G, B and A, half, float or uint, of the first part; read as f32, NaN and infinities as
///        they are.
/// At most 2^28 texels, of PNG and EXR no more than compression can make of the file's bytes, and no more
/// than options.max_memory: all are checked before memory is taken. \throws FileError for palettes, grey
/// images, TGA of 16 bits, colour tags, truncated files
Image read_image(const std::string& path, const ReadImageOptions& options = {});

/// The same from the bytes of an image. \param name used in messages and for the extension
Image read_image(const std::string& name, std::string_view bytes, const ReadImageOptions& options = {});

/// The colour tag of a file, such as "sRGB" or "gAMA 0.45455"; empty if it is linear or absent.
/// \throws FileError as read_image()
std::string image_colour_tag(const std::string& path);
std::string image_colour_tag(const std::string& name, std::string_view bytes);

/// The sample types that a file of this name can hold, the finest last. \throws ParameterError for an
/// extension that is none of .png .tga .exr
std::span<const SampleType> image_types(const std::string& path);

/// Writes an image, whole or not at all, without colour tags; EXR as float, ZIP-compressed.
/// \throws FileError when it cannot be written \throws ParameterError for a type that is none of
/// image_types(), no texels, channels other than 3 or 4, or samples other than width * height * channels
void write_image(const std::string& path, const Image& image);

/// The same into a file that was opened beforehand; commits it. \param path its name
void write_image(OutputFile& file, const std::string& path, const Image& image);

}  // namespace darboux
