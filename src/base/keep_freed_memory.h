// Keeps freed memory for the next use.
#pragma once

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace darboux {

// By default glibc gives arrays of large meshes back to the system, and gets others from it, page by page and
// cleared: a tenth of the time of a verdict. What is free at the end of the heap still goes back where it is
// much.
inline void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, 1 << 28);
#endif
}

}  // namespace darboux
