#pragma once

#include <algorithm>
#include <cstdlib>

namespace darboux::test {

#ifdef DARBOUX_SHORT_TESTS
inline constexpr bool slow_build = true;
#else
inline constexpr bool slow_build = false;
#endif

/// Of the repetitions of a law a run takes one in this many: all of them where DARBOUX_LONG_TESTS is set in
/// the environment (tests/nightly.sh long), one in `at_landing` at a landing, a tenth in slow builds.
inline int thinning(int at_landing = 6) {
  if (slow_build) return 10;
  static const bool is_long = std::getenv("DARBOUX_LONG_TESTS") != nullptr;
  return is_long ? 1 : at_landing;
}

/// Of nested loops of at least three turns the combinations whose indices have such a sum: a third, but each
/// turn of each loop. Of a single loop a third of its turns, always the same: long runs take the others. What
/// a combination draws does not depend on those that are left out.
inline bool is_taken(int sum_of_indices) {
  return sum_of_indices % std::min(thinning(), 3) == 0;
}

}  // namespace darboux::test
