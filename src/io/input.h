/// \file input.h
/// Reading in pieces: the bytes of a file, and the lines of a text. Memory does not grow with the file.
#pragma once

#include <cstdint>
#include <optional>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

namespace darboux::io {

/// A file descriptor that is closed with its owner.
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
  /// \param kind what is expected, "CSV file of u,v" \throws FileError when it cannot be opened
  InputBytes(const std::string& path, std::string kind);

  const std::string& path() const { return path_; }
  /// Bytes of a regular file from where it stood on.
  std::optional<std::uint64_t> size() const { return size_; }
  /// Bytes taken from it.
  std::uint64_t taken() const { return filled_ - static_cast<std::uint64_t>(egptr() - gptr()); }
  std::optional<double> share() const;
  /// Up to `count` bytes, fewer only at the end.
  std::size_t take(char* to, std::size_t count) {
    return static_cast<std::size_t>(sgetn(to, static_cast<std::streamsize>(count)));
  }
  /// To be called at the end. \throws FileError when it was not the end, but an error
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

/// The lines of a text in UTF-8. Empty lines and those that begin with # are passed over.
class Lines {
 public:
  /// \param expected what messages say was expected: "lines like 0.25,0.5"
  Lines(InputBytes& bytes, std::string expected) : bytes_(bytes), expected_(std::move(expected)) {}

  /// The next line, false at the end. \throws FileError for a line of more than 65536 bytes, so that a file
  /// without line ends is not read whole, a carriage return within one, and UTF-16 \param comments are lines
  /// too
  bool next(bool comments = false);
  /// It, without blanks at its ends, nor a byte order mark.
  std::string_view text() const { return text_; }
  /// Of the line in the file, from 1.
  std::uint64_t number() const { return number_; }
  /// \throws FileError "FILE:LINE: expected lines like 0.25,0.5, got GOT"
  [[noreturn]] void fail(const std::string& got) const;

 private:
  InputBytes& bytes_;
  std::string expected_, line_;
  std::string_view text_;
  std::uint64_t number_ = 0;
};

/// Without blanks, tabs and carriage returns at its ends.
std::string_view trimmed(std::string_view text);

/// The whole text, but for blanks at its ends, as a double, whatever the locale. NaN and infinities are
/// numbers here; what is beyond the range of double is none.
std::optional<double> parse_number(std::string_view text);

/// What separates the fields of a table whose first line this is: a semicolon, a comma, or else blanks and
/// tabs, as ' '.
char separator_of(std::string_view line);

/// The fields of a line between `separator`, or between runs of blanks and tabs where it is a blank.
void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields);

/// The same of a row of a table: without the quotes about fields.
void split_row(std::string_view line, char separator, std::vector<std::string_view>& fields);

}  // namespace darboux::io
