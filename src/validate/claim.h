// What a question claims of a normal or a tangent.
#pragma once

#include <cstdint>

namespace darboux {

// How a surface is known.
enum class Basis : std::uint8_t {
  declared,
  recognised,
  recognised_unsided  // a plane: which side is out nobody knows
};

enum class Claim : std::uint8_t {
  none,    // it cannot tell
  within,  // within the limit
  beyond   // beyond it
};

}  // namespace darboux
