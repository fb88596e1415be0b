// Preloaded, it makes every file system one that knows no files without a name or, where DARBOUX_NO_NAMES is
// set, one that does and gives them none.
#include <cerrno>
#include <cstdarg>
#include <cstdlib>

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

int opened(const char* path, int flags, unsigned mode) {
  if ((flags & O_TMPFILE) != O_TMPFILE || std::getenv("DARBOUX_NO_NAMES") != nullptr)
    return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
  errno = EOPNOTSUPP;
  return -1;
}

unsigned mode_of(int flags, va_list rest) {
  return (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE ? va_arg(rest, unsigned) : 0;
}

}  // namespace

extern "C" int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const unsigned mode = mode_of(flags, rest);
  va_end(rest);
  return opened(path, flags, mode);
}

extern "C" int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const unsigned mode = mode_of(flags, rest);
  va_end(rest);
  return opened(path, flags, mode);
}

extern "C" int linkat(int from, const char* old_name, int to, const char* name, int flags) {
  if (std::getenv("DARBOUX_NO_NAMES") == nullptr)
    return static_cast<int>(::syscall(SYS_linkat, from, old_name, to, name, flags));
  errno = EPERM;
  return -1;
}
