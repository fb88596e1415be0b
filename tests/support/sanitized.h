/// \file sanitized.h
/// What a build under a sanitizer cannot show: its runtime has an address space of terabytes, keeps what was
/// freed, replaces the allocator, and wants to be loaded before all other libraries.
#pragma once

#include <gtest/gtest.h>

namespace darboux::test {

#if defined(__has_feature)  // clang
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define DARBOUX_SANITIZED
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // g++
#define DARBOUX_SANITIZED
#endif

#ifdef DARBOUX_SANITIZED
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

}  // namespace darboux::test

/// Skips the rest of a test under a sanitizer, aloud. \param why it cannot hold there
#define DARBOUX_SKIP_IF_SANITIZED(why) \
  if (darboux::test::sanitized) GTEST_SKIP() << "under a sanitizer " << why
