#include "text.h"

#include <cstdint>

namespace darboux {
namespace {

bool is_continuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
}

struct Character {
  std::uint32_t code;
  std::size_t bytes;  // 0: no UTF-8
};

// The first UTF-8 character of the text; surrogates and overlong forms are invalid.
Character first_character(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return {0, 0};
  std::uint32_t code = lead & (0x7Fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if (!is_continuation(text[i])) return {0, 0};
    code = code << 6 | (static_cast<unsigned char>(text[i]) & 0x3Fu);
  }
  const bool too_long = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
  if (too_long || (code >= 0xD800 && code < 0xE000) || code > 0x10FFFF) return {0, 0};
  return {code, bytes};
}

// Control characters, line separators, and characters that change the text direction.
bool is_control(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2066 && code <= 0x2069);
}

std::string_view trimmed_end(std::string_view text) {
  while (text.ends_with('\n') || text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

}  // namespace

std::string one_line(std::string_view text) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const Character c = first_character(text);
    const std::size_t bytes = c.bytes == 0 ? 1 : c.bytes;
    if (c.bytes == 0 || is_control(c.code))
      for (std::size_t i = 0; i < bytes; ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        result += {'\\', 'x', digits[byte >> 4], digits[byte & 15]};
      }
    else
      result += text.substr(0, bytes);
    text.remove_prefix(bytes);
  }
  return result;
}

std::string shortened(std::string text, std::size_t most) {
  constexpr std::string_view gap = "...";
  if (text.size() <= most) return text;
  std::size_t begin = (most - gap.size() + 1) / 2, end = text.size() - (most - gap.size()) / 2;
  while (begin > 0 && is_continuation(text[begin])) --begin;
  while (end < text.size() && is_continuation(text[end])) ++end;
  return text.replace(begin, end - begin, gap);
}

std::string message_name(std::string_view name) {
  return name.empty() ? "\"\"" : shortened(one_line(name), longest_name);
}

std::string message_line(std::string_view name, std::string_view text) {
  const std::string begin = message_name(name) + ": ";
  return begin + shortened(one_line(trimmed_end(text)), longest_message - begin.size());
}

std::string message_line(std::string_view text) {
  return shortened(one_line(trimmed_end(text)), longest_message);
}

}  // namespace darboux
