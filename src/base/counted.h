// Counts with their nouns, as text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace darboux {

/// "1 vertex", "2 vertices"
inline std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return std::to_string(count) + ' ' + std::string(count == 1 ? one : many);
}

/// "1 corner", "2 corners"
inline std::string counted(std::size_t count, std::string_view one) {
  return counted(count, one, std::string(one) + 's');
}

}  // namespace darboux
