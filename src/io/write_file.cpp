#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <darboux/error.h>
#include <darboux/io.h>

namespace darboux {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int error) {
  throw FileError(path, std::string("cannot be written (") + std::strerror(error) +
                            "), permitted is a file in a writable folder with room for it");
}

/// Writes all of `content` and closes the descriptor. Returns 0 or the errno of what went wrong.
int write_and_close(int descriptor, std::string_view content, bool sync) {
  int error = 0;
  while (!content.empty() && error == 0) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written >= 0)
      content.remove_prefix(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      error = errno;
  }
  if (sync && error == 0 && ::fsync(descriptor) != 0) error = errno;
  if (::close(descriptor) != 0 && error == 0) error = errno;
  return error;
}

void write_directly(const std::string& path, std::string_view content) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  const int error = descriptor < 0 ? errno : write_and_close(descriptor, content, false);
  if (error != 0) fail(path, error);
}

void write_and_rename(const std::string& path, const fs::path& target, std::string_view content) {
  std::string temporary;
  int descriptor = -1;
  for (int attempt = 0; descriptor < 0; ++attempt) {
    const std::string name =
        ".darboux-" + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".tmp";
    temporary = (target.parent_path() / name).string();
    descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno != EEXIST) fail(path, errno);
  }
  int error = write_and_close(descriptor, content, true);
  if (error == 0 && std::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    fail(path, error);
  }
}

}  // namespace

void write_file(const std::string& path, std::string_view content) {
  if (path == "-") {
    errno = 0;
    if (std::fwrite(content.data(), 1, content.size(), stdout) != content.size() || std::fflush(stdout) != 0)
      fail("standard output", errno);
    return;
  }
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status) || path.empty() || path.ends_with('/'))
    throw FileError(path.empty() ? "\"\"" : path, "is a folder, permitted is the name of a file");
  const bool link = fs::is_symlink(fs::symlink_status(path, ignored));
  // /dev/stdout and the like may lead to a regular file, yet must not be replaced by one.
  const bool system_link = link && (path.starts_with("/dev/") || path.starts_with("/proc/"));
  if (system_link || (fs::exists(status) && !fs::is_regular_file(status)))
    write_directly(path, content);
  else
    write_and_rename(path, link && fs::exists(status) ? fs::canonical(path) : fs::path(path), content);
}

}  // namespace darboux
