/// \file csv_text.h
/// Formats numbers and statuses for rows of text.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include <darboux/surface.h>

namespace darboux {

/// The names of the bits that are set.
template <class Use>
void for_each_status(Status status, Use use) {
  if (status == Status::regular) return use("regular");
  for (std::size_t k = 0; k < status_names.size(); ++k)
    if (has(status, static_cast<Status>(1u << k))) use(status_names[k]);
}

/// Appends the shortest text of x that reads back to the same bits.
inline void append_shortest(std::string& text, double x) {
  if (std::isnan(x)) {
    text += "nan";
    return;
  }
  std::array<char, 32> digits;
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), x).ptr);
}

/// "dpdu_zero|limit_frame"
inline void append_joined_status(std::string& text, Status status) {
  const char* separator = "";
  for_each_status(status, [&](std::string_view name) {
    text += separator;
    text += name;
    separator = "|";
  });
}

}  // namespace darboux
