#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <darboux/error.h>
#include <darboux/io.h>

#include "base/text.h"

namespace darboux {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int error) {
  throw FileError(path, "cannot be written: " + expected_got("a file in a writable folder with room for it",
                                                             std::strerror(error)));
}

}  // namespace

OutputFile::OutputFile(const std::string& path) : path_(path) {
  if (path == "-") {
    path_ = "standard output";
    descriptor_ = ::dup(STDOUT_FILENO);
    if (descriptor_ < 0) fail(path_, errno);
    return;
  }
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status) || path.empty() || path.ends_with('/'))
    throw FileError(path.empty() ? "\"\"" : path, expected_got("the name of a file", "that of a folder"));
  const bool link = fs::is_symlink(fs::symlink_status(path, ignored));
  // /dev/stdout and the like may lead to a regular file, yet must not be replaced by one.
  const bool system_link = link && (path.starts_with("/dev/") || path.starts_with("/proc/"));
  if (system_link || (fs::exists(status) && !fs::is_regular_file(status))) {
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
    if (descriptor_ < 0) fail(path_, errno);
    return;
  }
  const fs::path target = link && fs::exists(status) ? fs::canonical(path) : fs::path(path);
  target_ = target.string();
  for (int attempt = 0; descriptor_ < 0; ++attempt) {
    const std::string name =
        ".darboux-" + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".tmp";
    temporary_ = (target.parent_path() / name).string();
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) {
      temporary_.clear();
      fail(path_, errno);
    }
  }
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::flush() {
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written >= 0)
      rest.remove_prefix(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      fail(path_, errno);
  }
  buffer_.clear();
}

void OutputFile::write(std::string_view content) {
  constexpr std::size_t most = 1 << 20;
  buffer_ += content;
  if (buffer_.size() >= most) flush();
}

void OutputFile::commit() {
  flush();
  if (!temporary_.empty() && ::fsync(descriptor_) != 0) fail(path_, errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(path_, errno);
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(path_, errno);
  temporary_.clear();
}

void write_file(const std::string& path, std::string_view content) {
  OutputFile file(path);
  file.write(content);
  file.commit();
}

}  // namespace darboux
