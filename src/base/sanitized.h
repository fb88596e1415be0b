// Whether this build is watched by the address or the thread sanitizer.
#pragma once

namespace darboux {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // g++
#define DARBOUX_SANITIZED
#elif defined(__clang__)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define DARBOUX_SANITIZED
#endif
#endif

#ifdef DARBOUX_SANITIZED
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

}  // namespace darboux
