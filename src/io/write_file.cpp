#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <darboux/error.h>
#include <darboux/io.h>

#include "base/text.h"
#include "unfinished.h"

namespace darboux {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int error) {
  throw FileError(path, "cannot be written: " + expected_got("a file in a writable folder with room for it",
                                                             std::strerror(error)));
}

// The descriptor of this process to which a path refers, if any.
std::optional<int> descriptor_named(const std::string& path) {
  if (path == "-" || path == "/dev/stdout") return STDOUT_FILENO;
  if (path == "/dev/stderr") return STDERR_FILENO;
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!path.starts_with(folder)) continue;
    const char *const first = path.data() + folder.size(), *const end = path.data() + path.size();
    int number = -1;
    const auto [last, error] = std::from_chars(first, end, number);
    if (error == std::errc{} && last == end && number >= 0) return number;
  }
  return std::nullopt;
}

// The target of symbolic links, whether or not it exists; stops at the name of a descriptor.
std::string followed(std::string path) {
  std::error_code error;
  for (int links = 0; links < 40 && !descriptor_named(path); ++links) {
    const fs::path to = fs::read_symlink(path, error);
    if (error) break;
    path = (fs::path(path).parent_path() / to).string();
  }
  return path;
}

// Calls `make` with hidden, unused names beside the target until one is free. \returns the name, registered
// as unfinished; or none, with the reason in errno
template <class F>
std::string make_temporary(const std::string& target, const F& make) {
  static std::size_t count = 0;  // Uninterrupted guards it
  while (true) {
    const std::string name =
        ".darboux-" + std::to_string(::getpid()) + "-" + std::to_string(count++) + ".tmp";
    std::string path = (fs::path(target).parent_path() / name).string();
    io::add_unfinished(path);
    if (make(path.c_str()) >= 0) return path;
    const int error = errno;
    io::drop_unfinished(path);
    errno = error;
    if (error != EEXIST) return {};
  }
}

// The name under which the system shows an open file, by which it can be linked to other names.
std::string name_in_proc(int descriptor) {
  return "/proc/self/fd/" + std::to_string(descriptor);
}

// A file without a name, which leaves nothing behind if it is abandoned; -1 if the file system does not
// support that.
int open_without_name(const std::string& target) {
#ifdef O_TMPFILE
  const fs::path folder = fs::path(target).parent_path();
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (descriptor < 0 || ::access(name_in_proc(descriptor).c_str(), F_OK) == 0) return descriptor;
  ::close(descriptor);
#else
  static_cast<void>(target);
#endif
  return -1;
}

// Copies mode and, where permitted, owner and group.
void keep_attributes(int descriptor, const struct stat& old) {
  struct stat now {};
  ::fstat(descriptor, &now);
  mode_t mode = old.st_mode & 07777;
  if ((now.st_uid != old.st_uid || now.st_gid != old.st_gid) &&
      ::fchown(descriptor, old.st_uid, old.st_gid) != 0)
    // Not permitted: the file belongs to the writer, as a new file would. Another group gets no more rights
    // than everybody had, and nobody gets the rights of another owner.
    mode = (mode & 0707) | (mode & 0070 & (mode << 3));
  ::fchmod(descriptor, mode);
}

// Writes everything. \returns 0, or the error number
int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written >= 0)
      bytes.remove_prefix(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      return errno;
  }
  return 0;
}

// Copies a file to another and syncs it to disk. \returns 0, or the error number
int copy_bytes(int from, int to) {
  std::string buffer(std::size_t{1} << 20, '\0');
  for (off_t at = 0;;) {
    const ssize_t count = ::pread(from, buffer.data(), buffer.size(), at);
    if (count < 0 && errno != EINTR) return errno;
    if (count == 0) return ::fsync(to) == 0 ? 0 : errno;
    if (count < 0) continue;
    const auto bytes = static_cast<std::size_t>(count);
    if (const int error = write_all(to, std::string_view(buffer).substr(0, bytes)); error != 0) return error;
    at += count;
  }
}

}  // namespace

bool is_standard_output(const std::string& path) {
  return descriptor_named(followed(path)) == STDOUT_FILENO;
}

OutputFile::OutputFile(const std::string& path) : path_(path) {
  const std::string target = followed(path);
  if (const std::optional<int> named = descriptor_named(target)) {
    if (*named == STDOUT_FILENO) path_ = "standard output";
    descriptor_ = ::fcntl(*named, F_DUPFD_CLOEXEC, 0);
    if (descriptor_ < 0) fail(path_, errno);
    return;
  }
  struct stat old {};
  const bool exists = ::stat(target.c_str(), &old) == 0;
  if (path.empty() || target.ends_with('/') || (exists && S_ISDIR(old.st_mode)))
    throw FileError(path.empty() ? "\"\"" : path, expected_got("the name of a file", "that of a folder"));
  if (!exists && errno != ENOENT) fail(path_, errno);
  if (exists && !S_ISREG(old.st_mode)) {
    descriptor_ = ::open(target.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail(path_, errno);
    return;
  }
  // A folder may permit replacing a read-only file. That is not what its owner wanted.
  if (exists && ((old.st_mode & 0222) == 0 || ::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0))
    throw FileError(
        path, "cannot be replaced: " + expected_got("a file that may be written to", "a read-only one"));
  target_ = target;
  descriptor_ = open_without_name(target_);
  if (descriptor_ < 0) {
    const io::Uninterrupted uninterrupted;
    temporary_ = make_temporary(target_, [&](const char* name) {
      return descriptor_ = ::open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    });
  }
  if (descriptor_ < 0) fail(path_, errno);
  if (exists) keep_attributes(descriptor_, old);
}

bool OutputFile::is_written_in_place() const {
  struct stat status {};
  return target_.empty() && ::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (temporary_.empty()) return;
  const io::Uninterrupted uninterrupted;
  ::unlink(temporary_.c_str());
  io::drop_unfinished(temporary_);
}

void OutputFile::flush() {
  if (const int error = write_all(descriptor_, buffer_); error != 0) fail(path_, error);
  buffer_.clear();
}

void OutputFile::write(std::string_view content) {
  constexpr std::size_t most = 1 << 20;
  if (content.size() < most) buffer_ += content;
  if (content.size() >= most || buffer_.size() >= most) flush();
  if (content.size() < most) return;
  if (const int error = write_all(descriptor_, content); error != 0) fail(path_, error);
}

void OutputFile::commit() {
  flush();
  if (!target_.empty()) {
    if (::fsync(descriptor_) != 0) fail(path_, errno);
    give_name();
  }
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(path_, errno);
}

void OutputFile::rename_temporary() {
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(path_, errno);
  io::drop_unfinished(std::exchange(temporary_, {}));
}

bool OutputFile::link_name() {
  const io::Uninterrupted uninterrupted;  // nothing but SIGKILL comes between two names
  const std::string unnamed = name_in_proc(descriptor_);
  const auto link_to = [&](const char* name) {
    return ::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW);
  };
  if (link_to(target_.c_str()) == 0) return true;
  if (errno != EEXIST) return false;
  temporary_ = make_temporary(target_, link_to);
  if (temporary_.empty()) return false;
  rename_temporary();
  return true;
}

void OutputFile::copy_to_temporary() {
  struct stat old {};
  ::fstat(descriptor_, &old);
  const int from = std::exchange(descriptor_, -1);
  {
    const io::Uninterrupted uninterrupted;
    temporary_ = make_temporary(target_, [&](const char* name) {
      return descriptor_ = ::open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    });
  }
  int error = descriptor_ < 0 ? errno : 0;
  if (error == 0) {
    keep_attributes(descriptor_, old);
    error = copy_bytes(from, descriptor_);
  }
  ::close(from);
  if (error != 0) fail(path_, error);
}

void OutputFile::give_name() {
  if (temporary_.empty()) {
    if (link_name()) return;
    copy_to_temporary();  // some file systems have files without a name, and give them none
  }
  const io::Uninterrupted uninterrupted;
  rename_temporary();
}

void write_file(const std::string& path, std::string_view content) {
  OutputFile file(path);
  file.write(content);
  file.commit();
}

}  // namespace darboux
