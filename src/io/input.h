/// \file input.h
/// Streaming input: the bytes of a file, and the lines of a text. Memory does not grow with the file.
#pragma once

#include <cstdint>
#include <optional>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

namespace darboux::io {

/// Owns a file descriptor, and closes it on destruction.
struct Descriptor {
  int value = -1;
  Descriptor() = default;
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor();
};

/// A file, pipe or standard input ("-") as a stream buffer that counts its bytes. An error ends the stream;
/// finish() reports it.
class InputBytes final : public std::streambuf {
 public:
  /// \param kind the expected kind of file, for messages: "CSV file of u,v" \throws FileError if it cannot be
  /// opened
  InputBytes(const std::string& path, std::string kind);

  const std::string& path() const { return path_; }
  /// The remaining bytes of a regular file, from its position when opened.
  std::optional<std::uint64_t> size() const { return size_; }
  /// The number of bytes consumed.
  std::uint64_t taken() const { return filled_ - static_cast<std::uint64_t>(egptr() - gptr()); }
  std::optional<double> share() const;
  /// Up to `count` bytes, fewer only at the end.
  std::size_t take(char* to, std::size_t count) {
    return static_cast<std::size_t>(sgetn(to, static_cast<std::streamsize>(count)));
  }
  /// Call this at the end of the stream. \throws FileError if it ended because of an error
  void finish() const;

 protected:
  int_type underflow() override;

 private:
  std::string path_, kind_;
  std::vector<char> buffer_;
  Descriptor descriptor_;
  int error_ = 0;
  std::uint64_t filled_ = 0;
  std::optional<std::uint64_t> size_;
};

/// The lines of a UTF-8 text. Empty lines and lines that begin with # are skipped.
class Lines {
 public:
  /// \param expected what messages say was expected: "lines like 0.25,0.5"
  Lines(InputBytes& bytes, std::string expected) : bytes_(bytes), expected_(std::move(expected)) {}

  /// Advances to the next line; false at the end. \throws FileError for a line of more than 65536 bytes (so a
  /// file without line ends is not read completely), a carriage return within a line, and UTF-16 \param
  /// comments whether comment lines count as lines
  bool next(bool comments = false);
  /// The current line, without leading and trailing blanks and without a byte order mark.
  std::string_view text() const { return text_; }
  /// The number of the line in the file, from 1.
  std::uint64_t number() const { return number_; }
  /// \throws FileError "FILE:LINE: expected lines like 0.25,0.5, got GOT"
  [[noreturn]] void fail(const std::string& got) const;

 private:
  InputBytes& bytes_;
  std::string expected_, line_;
  std::string_view text_;
  std::uint64_t number_ = 0;
};

/// The text without leading and trailing blanks, tabs and carriage returns.
std::string_view trimmed(std::string_view text);

/// Parses the whole text, except for leading and trailing blanks, as a double, independent of the locale. NaN
/// and infinities are accepted; numbers beyond the range of double are not.
std::optional<double> parse_number(std::string_view text);

/// The field separator of a table with this first line: a semicolon, else a comma, else ' ' for blanks and
/// tabs.
char separator_of(std::string_view line);

/// Splits a line at `separator`; if that is a blank, at runs of blanks and tabs.
void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields);

/// The same for a row of a table; quotes around fields are removed.
void split_row(std::string_view line, char separator, std::vector<std::string_view>& fields);

}  // namespace darboux::io
