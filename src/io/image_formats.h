/// \file image_formats.h
/// Readers and writers of image formats; each wraps a library.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <darboux/image_files.h>

namespace darboux::io {

/// Checks the number of texels declared by a file, and the memory they take, against the limits. \throws
/// FileError
void check_image_size(const std::string& file, std::uint64_t width, std::uint64_t height,
                      std::uint64_t texel_bytes, std::uint64_t file_bytes, const ReadImageOptions& options);

/// Rejects a file that declares more than `ratio` times its bytes, which no compression achieves. \throws
/// FileError
void check_compression(const std::string& file, std::uint64_t raw_bytes, std::uint64_t bytes,
                       std::uint64_t ratio);

/// \throws FileError for a file that says its numbers are not linear
void refuse_colour_tag(const std::string& file, const std::string& tag, const ReadImageOptions& options);

/// Whether the bytes have the signature of an EXR file.
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
