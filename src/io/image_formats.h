/// \file image_formats.h
/// One function per format, each wrapping its library.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <darboux/image_files.h>

namespace darboux::io {

/// Bounds what a file of so many bytes may claim: its texels, and the memory they take. \throws FileError
void check_image_size(const std::string& file, std::uint64_t width, std::uint64_t height,
                      std::uint64_t texel_bytes, std::uint64_t file_bytes, const ReadImageOptions& options);

/// Refuses a file that claims more than `ratio` times its bytes, which no compression gives. \throws
/// FileError
void check_compression(const std::string& file, std::uint64_t raw_bytes, std::uint64_t bytes,
                       std::uint64_t ratio);

/// \throws FileError for a file that says its numbers are not linear
void refuse_colour_tag(const std::string& file, const std::string& tag, const ReadImageOptions& options);

/// Whether bytes begin as an EXR does.
bool is_exr(std::string_view bytes);

// \throws FileError
Image image_of_png(const std::string& file, std::string_view bytes, const ReadImageOptions& options);
Image image_of_tga(const std::string& file, std::string_view bytes, const ReadImageOptions& options);
std::string colour_tag_of_png(const std::string& file, std::string_view bytes);
std::string colour_tag_of_tga(std::string_view bytes);
Image image_of_exr(const std::string& file, std::string_view bytes, const ReadImageOptions& options);

/// \throws FileError
void write_png(OutputFile& file, const std::string& path, const Image& image);
std::string tga_of(const Image& image);
std::string exr_of(const std::string& path, const Image& image);

}  // namespace darboux::io
