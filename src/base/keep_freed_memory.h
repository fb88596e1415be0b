// Keeps freed memory for the next use.
#pragma once

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace darboux {

// By default glibc gives arrays of large meshes back to the system, and gets others from it,
// page by page and cleared: a twentieth of the time of a verdict. The largest arrays still go back, so that
// the peak stays.
inline void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 25);
  mallopt(M_TRIM_THRESHOLD, 1 << 28);
#endif
}

}  // namespace darboux
