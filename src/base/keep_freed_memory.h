// Keeps freed memory for the next use.
#pragma once

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace darboux {

// By default glibc returns the arrays of large meshes to the system and gets new ones from it, page by page
// and cleared: a tenth of the time of a verdict. Large free space at the end of the heap is still returned.
inline void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, 1 << 28);
#endif
}

}  // namespace darboux
