// The claim of a question about a normal or a tangent.
#pragma once

#include <cstdint>

namespace darboux {

// How a surface is known.
enum class Basis : std::uint8_t {
  declared,
  recognised,
  recognised_unsided  // a plane: its outside is unknown
};

enum class Claim : std::uint8_t {
  none,    // undecided
  within,  // within the limit
  beyond   // beyond it
};

}  // namespace darboux
