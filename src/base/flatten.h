// All calls in a function with this attribute are inlined. With the address sanitizer that would take minutes
// to compile.
#pragma once

#if defined(__SANITIZE_ADDRESS__)
#define DARBOUX_FLATTEN
#else
#define DARBOUX_FLATTEN [[gnu::flatten]]
#endif
