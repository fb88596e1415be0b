#pragma once

#include <cstdlib>

namespace darboux::test {

/// Of the repetitions of a law a run takes one in this many: all of them where DARBOUX_LONG_TESTS is set in
/// the environment (tests/nightly.sh), a third at a landing, a tenth in slow builds. The first ones, by the
/// same seeds.
inline int thinning() {
#ifdef DARBOUX_SHORT_TESTS
  return 10;
#else
  static const bool is_long = std::getenv("DARBOUX_LONG_TESTS") != nullptr;
  return is_long ? 1 : 3;
#endif
}

/// Whether a run takes combination 0, 1, ... of nested loops: one in thinning(), out of step with the inner
/// ones.
inline bool is_taken(int index) {
  return (index + index / thinning()) % thinning() == 0;
}

}  // namespace darboux::test
