// Numbers as text, independent of the locale, and other parts of messages.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace darboux {

/// The shortest decimal text that reads back to the same double: "0.1", "1e-300", "nan".
inline std::string shortest(double x) {
  if (std::isnan(x)) return "nan";
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, x).ptr};
}

/// A number with `digits` significant digits, for people: "1.2e-05", "0.48".
inline std::string rounded(double x, int digits) {
  if (std::isnan(x)) return "nan";
  char buffer[40];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, x, std::chars_format::general, digits).ptr};
}

/// A standard deviation of an angle in degrees, as text; NaN and more than half a turn are shown as unknown.
inline std::string deviation_text(double x, int digits, const char* unit = "") {
  return x <= 180 ? rounded(x, digits) + unit : "an unknown angle";
}

/// The name of an enumerator; the names in the order of the enumeration.
template <class E, std::size_t N>
constexpr std::string_view name_in(const std::array<std::string_view, N>& names, E e) {
  return names[static_cast<std::size_t>(e)];
}

/// "a, b, c"
inline std::string joined(const std::vector<std::string>& names, std::string_view between = ", ") {
  std::string text;
  for (const std::string& name : names) text.append(text.empty() ? "" : between).append(name);
  return text;
}

/// Padded with blanks to `width` bytes.
inline std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text;
}

/// The form of error messages: "expected 0 < radius < inf, got -2".
inline std::string expected_got(std::string_view expected, std::string_view got) {
  return "expected " + std::string(expected) + ", got " + std::string(got);
}

/// In lower case, ASCII only.
inline std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

/// Safe on one line of a terminal: UTF-8 in which control characters, those that change the text direction,
/// and invalid bytes are escaped: \xFF.
std::string one_line(std::string_view text);

/// At most `most` bytes, `most` >= 3, of UTF-8: in longer text "..." replaces the middle.
std::string shortened(std::string text, std::size_t most);

/// The maximum in bytes, of messages and of the names in them. With "darboux: " in front, a message has at
/// most 500.
inline constexpr std::size_t longest_message = 480, longest_name = 200;

/// A name at the beginning of a message: one line, shortened; "" if it is empty.
std::string message_name(std::string_view name);

/// "NAME: TEXT", or TEXT alone: one line, shortened, without trailing blanks.
std::string message_line(std::string_view name, std::string_view text);
std::string message_line(std::string_view text);

}  // namespace darboux
