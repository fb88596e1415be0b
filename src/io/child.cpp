#include "child.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <mutex>
#include <new>

#include <fcntl.h>
#include <poll.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/sanitized.h"
#include "confine.h"
#include "input.h"

namespace darboux::io {
namespace {

constexpr int out_of_memory = 3, not_confined = 4;  // exit status

// A child may share its processor with another process; one that never waits needs no more time than this.
std::chrono::seconds patience(const ChildLimits& limits) {
  return std::chrono::seconds(10) + std::chrono::seconds(2) * limits.seconds;
}

void limit(decltype(RLIMIT_CPU) resource, std::uint64_t most) {
  rlimit value{};
  if (::getrlimit(resource, &value) != 0 || value.rlim_cur <= most) return;
  value.rlim_cur = most;
  ::setrlimit(resource, &value);
}

std::uint64_t address_space() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

bool write_all(int descriptor, const void* from, std::size_t count) {
  const char* at = static_cast<const char*>(from);
  while (count > 0) {
    const ssize_t written = ::write(descriptor, at, count);
    if (written < 0 && errno != EINTR) return false;
    if (written < 0) continue;
    at += written;
    count -= static_cast<std::size_t>(written);
  }
  return true;
}

// Ends this process with its parent, however that ends.
void end_with(pid_t parent) {
#ifdef __linux__
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  if (::getppid() != parent) ::_exit(EXIT_FAILURE);  // it ended before
}

// Sends the length of the answer, then its bytes.
[[noreturn]] void run_child(int pipe, const std::function<std::string()>& work, const ChildLimits& limits) {
  for (int signal = 1; signal < NSIG; ++signal) ::signal(signal, SIG_DFL);
  if (const int nowhere = ::open("/dev/null", O_WRONLY); nowhere >= 0) {
    ::dup2(nowhere, STDOUT_FILENO);
    if (!sanitized) ::dup2(nowhere, STDERR_FILENO);  // keeps the sanitizer's reports
  }
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, limits.seconds);
  if (const std::uint64_t now = address_space(); now > 0) limit(RLIMIT_AS, now + limits.bytes);
  int status = EXIT_FAILURE;
  if (limits.confined && !confine_process()) ::_exit(not_confined);
  try {
    const std::string answer = work();
    const std::uint64_t size = answer.size();
    if (write_all(pipe, &size, sizeof size) && write_all(pipe, answer.data(), answer.size()))
      status = EXIT_SUCCESS;
  } catch (const std::bad_alloc&) {
    status = out_of_memory;
  } catch (...) {
  }
  ::_exit(status);
}

// Appends what arrives through the pipe; false if it does not end before the deadline.
bool read_until(std::chrono::steady_clock::time_point deadline, int pipe, std::string& bytes) {
  std::string buffer(std::size_t{1} << 16, '\0');
  while (true) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    pollfd waiting{pipe, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(left.count())) <= 0) continue;
    const ssize_t count = ::read(pipe, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return true;
    bytes.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

std::string why(int status, bool in_time, const ChildLimits& limits) {
  if (!in_time) return "does not answer within " + std::to_string(patience(limits).count()) + " seconds";
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    return "takes more than " + std::to_string(limits.seconds) + " seconds of processor time";
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
    return "is killed, as systems do that are short of memory or time";
  if (WIFSIGNALED(status)) return std::string("crashes (") + ::strsignal(WTERMSIG(status)) + ")";
  if (WEXITSTATUS(status) == out_of_memory)
    return "asks for more than " + std::to_string(limits.bytes >> 20) + " MiB";
  if (WEXITSTATUS(status) == not_confined)
    return "cannot be confined by this kernel (--no-sandbox reads the file without)";
  return "fails";
}

}  // namespace

std::string in_child(const std::function<std::string()>& work, const ChildLimits& limits) {
  Descriptor from_child;
  pid_t child = -1;
  {
    // No child may inherit the write end of another's pipe: its reader would wait for both.
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw ChildFailure("has no pipe to answer through");
    from_child.value = ends[0];
    const pid_t parent = ::getpid();
    child = ::fork();
    if (child == 0) {
      ::close(ends[0]);  // or it would wait for itself to read, were the parent gone
      end_with(parent);
      run_child(ends[1], work, limits);
    }
    ::close(ends[1]);
  }
  if (child < 0) throw ChildFailure("cannot have a process of its own");
  std::string bytes;
  const bool in_time =
      read_until(std::chrono::steady_clock::now() + patience(limits), from_child.value, bytes);
  if (!in_time) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  std::uint64_t size = 0;
  if (bytes.size() < sizeof size) throw ChildFailure(why(status, in_time, limits));
  std::memcpy(&size, bytes.data(), sizeof size);
  bytes.erase(0, sizeof size);
  if (bytes.size() != size) throw ChildFailure(why(status, in_time, limits));
  return bytes;
}

}  // namespace darboux::io
