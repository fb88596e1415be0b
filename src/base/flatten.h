// A function with this has all it calls inlined; instrumented, that would take minutes to compile.
#pragma once

#if defined(__SANITIZE_ADDRESS__)
#define DARBOUX_FLATTEN
#else
#define DARBOUX_FLATTEN [[gnu::flatten]]
#endif
