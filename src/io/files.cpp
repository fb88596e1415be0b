#include "files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <darboux/error.h>
#include <darboux/io.h>

#include "base/base64.h"
#include "base/text.h"
#include "input.h"

namespace darboux::io {
namespace {

// The value of each base64 character, 255 for all others.
constexpr std::array<std::uint8_t, 256> base64_values() {
  std::array<std::uint8_t, 256> values{};
  values.fill(255);
  for (std::size_t i = 0; i < base64_alphabet.size(); ++i)
    values[static_cast<unsigned char>(base64_alphabet[i])] = static_cast<std::uint8_t>(i);
  return values;
}

std::string decode_base64(const std::string& file, const std::string& name, std::string_view text) {
  static constexpr auto values = base64_values();
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::uint8_t value = values[static_cast<unsigned char>(text[i])];
    if (value == 255)
      throw FileError(file,
                      name + ": " +
                          expected_got("a data URI of A-Z a-z 0-9 + / and = at the end",
                                       in_quotes(text.substr(i, 1)) + " at position " + std::to_string(i)));
    bits = bits << 6 | value;
    if (i % 4 == 1) bytes += static_cast<char>(bits >> 4);
    if (i % 4 == 2) bytes += static_cast<char>(bits >> 2);
    if (i % 4 == 3) bytes += static_cast<char>(bits);
  }
  if (text.size() % 4 == 1)
    throw FileError(
        file, name + ": " + expected_got("a data URI of base64 in whole bytes", "one that is cut short"));
  return bytes;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// A % that begins no valid escape stands for itself: some exporters do not escape.
std::string decode_percent(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool escape =
        uri[i] == '%' && i + 2 < uri.size() && hex_digit(uri[i + 1]) >= 0 && hex_digit(uri[i + 2]) >= 0;
    text += escape ? static_cast<char>(hex_digit(uri[i + 1]) * 16 + hex_digit(uri[i + 2])) : uri[i];
    if (escape) i += 2;
  }
  return text;
}

bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  return colon != std::string_view::npos && uri.substr(0, colon).find('/') == std::string_view::npos;
}

// Whether an existing file lies outside a folder and its subfolders, after symbolic links are resolved.
bool lies_outside(const std::filesystem::path& path, const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::path file = std::filesystem::canonical(path, error);
  if (error) return false;
  const std::filesystem::path root = std::filesystem::canonical(folder, error);
  return error || std::mismatch(root.begin(), root.end(), file.begin(), file.end()).first != root.end();
}

}  // namespace

void expect_regular_file(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    throw FileError(path, path == "-"
                              ? expected_got("the name of a file", "-: write standard input to a file first")
                              : expected_got("a readable file", "no file of this name"));
  if (std::filesystem::is_directory(status)) throw FileError(path, expected_got("a file", "a folder"));
  if (!error && !std::filesystem::is_regular_file(status))
    throw FileError(path, expected_got("a regular file", "a device or a pipe: write it to a file first"));
}

std::string read_file(const std::string& path) {
  expect_regular_file(path);
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw FileError(path, "cannot be opened: " + expected_got("a readable file", std::strerror(errno)));
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  std::string bytes(error ? 0 : size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream || error) throw FileError(path, expected_got("a readable file", "an error before its end"));
  return bytes;
}

Piece map_file(const std::string& path) {
  expect_regular_file(path);
  Descriptor file;
  file.value = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (file.value < 0 || ::fstat(file.value, &status) != 0 || status.st_size <= 0)
    return Piece::of(read_file(path));
#ifdef MAP_POPULATE
  constexpr int flags = MAP_PRIVATE | MAP_POPULATE;  // nearly all of it will be read
#else
  constexpr int flags = MAP_PRIVATE;
#endif
  const auto size = static_cast<std::size_t>(status.st_size);
  void* const bytes = ::mmap(nullptr, size, PROT_READ, flags, file.value, 0);
  if (bytes == MAP_FAILED) return Piece::of(read_file(path));
  return {{static_cast<const char*>(bytes), size},
          std::shared_ptr<const void>(bytes, [size](void* mapped) { ::munmap(mapped, size); })};
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 80;
  return '"' + shortened(one_line(text), longest) + '"';
}

bool is_data_uri(std::string_view uri) {
  constexpr std::string_view scheme = "data:";
  if (uri.size() < scheme.size()) return false;
  for (std::size_t i = 0; i < scheme.size(); ++i)
    if (std::tolower(static_cast<unsigned char>(uri[i])) != scheme[i]) return false;
  return true;
}

std::string file_of_uri(const std::string& base, const std::string& uri) {
  if (is_data_uri(uri)) return "";
  return (std::filesystem::path(base).parent_path() / decode_percent(uri)).string();
}

std::string load_uri(const std::string& base, const std::string& name, const std::string& uri,
                     const ReadOptions& options) {
  const auto refuse = [&] {
    throw FileError(base, name + ": " + expected_got("a relative path or a base64 data URI", in_quotes(uri)));
  };
  if (is_data_uri(uri)) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string::npos || !std::string_view(uri).substr(0, comma).ends_with(";base64")) refuse();
    return decode_base64(base, name, std::string_view(uri).substr(comma + 1));
  }
  const std::string relative = decode_percent(uri);
  if (relative.empty() || has_scheme(uri) || relative.front() == '/' || relative.front() == '\\' ||
      relative.find('\0') != std::string::npos)
    refuse();
  const std::filesystem::path folder = std::filesystem::path(base).parent_path(),
                              path = file_of_uri(base, uri);
  std::error_code none;
  // An asset that is itself a link may refer to either folder: content-addressed stores consist of links.
  if (!options.allow_outside && lies_outside(path, folder.empty() ? "." : folder) &&
      lies_outside(path, std::filesystem::canonical(base, none).parent_path()))
    throw OutsideError(base,
                       name + ": " +
                           expected_got("a file in the folder of this one, unless --allow-outside is given",
                                        in_quotes(uri) + ", which leads out of it"));
  try {
    return read_file(path.string());
  } catch (const FileError& error) {
    throw FileError(base, name + ": " + error.what());
  }
}

std::string make_data_uri(std::string_view media_type, std::string_view bytes) {
  return "data:" + std::string(media_type) + ";base64," + base64(bytes);
}

}  // namespace darboux::io
