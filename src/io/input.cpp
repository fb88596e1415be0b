#include "input.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <darboux/error.h>

#include "base/text.h"

namespace darboux::io {

Descriptor::~Descriptor() {
  if (value >= 0) ::close(value);
}

InputBytes::InputBytes(const std::string& path, std::string kind)
    : path_(path == "-" ? "standard input" : path), kind_(std::move(kind)), buffer_(std::size_t{1} << 18) {
  if (path == "-") {
    descriptor_.value = ::dup(STDIN_FILENO);
  } else {
    std::error_code error;
    if (std::filesystem::is_directory(path, error))
      throw FileError(path, expected_got("a " + kind_, "a folder"));
    descriptor_.value = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  }
  if (descriptor_.value < 0)
    throw FileError(path_, "cannot be opened: " + expected_got("a readable " + kind_, std::strerror(errno)));
  struct stat status {};
  if (::fstat(descriptor_.value, &status) == 0 && S_ISREG(status.st_mode)) {
    const auto at = std::max<off_t>(::lseek(descriptor_.value, 0, SEEK_CUR), 0);
    size_ = static_cast<std::uint64_t>(std::max<off_t>(status.st_size - at, 0));
  }
}

std::optional<double> InputBytes::share() const {
  if (!size_ || *size_ == 0) return std::nullopt;
  return std::min(1.0, static_cast<double>(taken()) / static_cast<double>(*size_));
}

void InputBytes::finish() const {
  if (error_ != 0)
    throw FileError(
        path_, "cannot be read to its end: " + expected_got("a readable " + kind_, std::strerror(error_)));
}

InputBytes::int_type InputBytes::underflow() {
  if (gptr() < egptr()) return traits_type::to_int_type(*gptr());
  ssize_t count = -1;
  do count = ::read(descriptor_.value, buffer_.data(), buffer_.size());
  while (count < 0 && errno == EINTR);
  if (count <= 0) {
    if (count < 0) error_ = errno;
    return traits_type::eof();
  }
  filled_ += static_cast<std::uint64_t>(count);
  setg(buffer_.data(), buffer_.data(), buffer_.data() + count);
  return traits_type::to_int_type(*gptr());
}

bool Lines::next(bool comments) {
  constexpr std::size_t longest = 65536;
  constexpr int end = InputBytes::traits_type::eof();
  do {
    line_.clear();
    ++number_;
    int c = bytes_.sbumpc();
    if (c == end) return false;
    for (; c != '\n' && c != end; c = bytes_.sbumpc()) {
      if (line_.size() == longest) fail("a line of more than 65536 characters");
      line_.push_back(static_cast<char>(c));
    }
    text_ = line_;
    if (number_ == 1) {
      if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
      if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF"))
        throw FileError(bytes_.path(), expected_got("UTF-8 or ASCII", "UTF-16"));
    }
    text_ = trimmed(text_);
  } while (text_.empty() || (text_[0] == '#' && !comments));
  if (text_.find('\r') != std::string_view::npos)
    fail("a carriage return within a line, the line end of old Macs");
  return true;
}

void Lines::fail(const std::string& got) const {
  throw FileError(bytes_.path() + ":" + std::to_string(number_), expected_got(expected_, got));
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

std::optional<double> parse_number(std::string_view text) {
  text = trimmed(text);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

char separator_of(std::string_view line) {
  char separator = ' ';
  for (const char c : {',', ';'})
    if (line.find(c) != std::string_view::npos) separator = c;
  return separator;
}

void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  if (separator != ' ') {
    for (std::size_t end = line.find(separator); end != std::string_view::npos; end = line.find(separator)) {
      fields.push_back(trimmed(line.substr(0, end)));
      line.remove_prefix(end + 1);
    }
    fields.push_back(trimmed(line));
    return;
  }
  for (line = trimmed(line); !line.empty(); line = trimmed(line)) {
    fields.push_back(line.substr(0, line.find_first_of(" \t\r")));
    line.remove_prefix(fields.back().size());
  }
}

void split_row(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  split_fields(line, separator, fields);
  for (std::string_view& field : fields)
    if (field.size() > 1 && field.front() == '"' && field.back() == '"')
      field = trimmed(field.substr(1, field.size() - 2));
}

}  // namespace darboux::io
