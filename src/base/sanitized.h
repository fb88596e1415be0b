// Whether the address or the thread sanitizer is enabled in this build.
#pragma once

// g++ defines macros, clang has features.
#if defined(__SANITIZE_ADDRESS__)
#define DARBOUX_ADDRESS_SANITIZER
#elif defined(__SANITIZE_THREAD__)
#define DARBOUX_THREAD_SANITIZER
#elif defined(__clang__)
#if __has_feature(address_sanitizer)
#define DARBOUX_ADDRESS_SANITIZER
#elif __has_feature(thread_sanitizer)
#define DARBOUX_THREAD_SANITIZER
#endif
#endif

#if defined(DARBOUX_ADDRESS_SANITIZER) || defined(DARBOUX_THREAD_SANITIZER)
#define DARBOUX_SANITIZED
#endif

namespace darboux {

#ifdef DARBOUX_SANITIZED
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

}  // namespace darboux
