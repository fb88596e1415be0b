// Preloaded, it makes one call fail, as DARBOUX_FAULT says: its kind, a colon, and which of them, from 1.
// Allocations are counted once for each stack they come from: "new" is that of C++ and looks at all callers,
// "own" is the same, but looks at the functions that the file DARBOUX_FAULT_OWN lists, "malloc" is called by
// the tool itself. At the end the number there were, where none fails (0), is written to the file
// DARBOUX_FAULT_COUNT, by the process that read it.
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <link.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <unwind.h>

extern "C" void* __libc_malloc(std::size_t);

namespace {

char kind[16];
unsigned long at = 0;
std::atomic<unsigned long> count{0};
pid_t owner = 0;
std::uintptr_t tool_base = 0, tool_begin = 0, tool_end = 0;
bool wants = false, ready = false;
thread_local bool inside = false;

constexpr std::size_t most_stacks = std::size_t{1} << 17;
std::atomic<std::uint64_t> stacks[most_stacks];

// Addresses of functions in the tool, in order, as [begin, end).
struct Function {
  std::uint64_t begin, end;
};
constexpr std::size_t most_functions = std::size_t{1} << 17;
Function own[most_functions];
std::size_t number_of_own = 0;

void read_own() {
  const char* const file = std::getenv("DARBOUX_FAULT_OWN");
  if (file == nullptr) return;
  const long from = ::syscall(SYS_openat, AT_FDCWD, file, O_RDONLY);
  const long bytes = ::syscall(SYS_read, from, own, sizeof own);
  ::syscall(SYS_close, from);
  number_of_own = bytes < 0 ? 0 : static_cast<std::size_t>(bytes) / sizeof(Function);
}

bool is_own(std::uintptr_t address) {
  if (address < tool_begin || address >= tool_end) return false;
  address -= tool_base;
  const Function* const after = std::upper_bound(
      own, own + number_of_own, address, [](std::uint64_t a, const Function& f) { return a < f.begin; });
  return after != own && address < after[-1].end;
}

// The innermost callers, as a hash.
struct Callers {
  bool of_own_code;
  int skipped = 2;  // of this file
  int left = 10;
  std::uint64_t hash = 1469598103934665603u;

  static _Unwind_Reason_Code add(_Unwind_Context* context, void* callers) {
    Callers& c = *static_cast<Callers*>(callers);
    const std::uintptr_t address = ::_Unwind_GetIP(context);
    if (c.skipped > 0) {
      --c.skipped;
      return _URC_NO_REASON;
    }
    if (c.of_own_code && !is_own(address - 1)) return _URC_NO_REASON;
    c.hash = (c.hash ^ address) * 1099511628211u;
    return --c.left > 0 ? _URC_NO_REASON : _URC_END_OF_STACK;
  }
};

// Whether this stack was not seen before.
bool is_new_stack(bool of_own_code) {
  Callers callers{of_own_code};
  ::_Unwind_Backtrace(Callers::add, &callers);
  const std::uint64_t hash = callers.hash | 1;
  for (std::size_t i = hash % most_stacks;; i = (i + 1) % most_stacks) {
    std::uint64_t there = stacks[i].load();
    if (there == hash) return false;
    if (there == 0 && stacks[i].compare_exchange_strong(there, hash)) return true;
    if (there == hash) return false;
  }
}

bool fails(const char* which) {
  return ready && std::strcmp(which, kind) == 0 && ++count == at;
}

// After the one that fails there is nothing to count.
bool allocation_fails(const char* which) {
  if (!ready || inside || (at != 0 && count >= at)) return false;
  const bool of_own_code = std::strcmp(kind, "own") == 0 && std::strcmp(which, "new") == 0;
  if (!of_own_code && std::strcmp(which, kind) != 0) return false;
  inside = true;
  const bool result = is_new_stack(of_own_code) && ++count == at;
  inside = false;
  return result;
}

template <class F>
F* next(const char* name) {
  return reinterpret_cast<F*>(::dlsym(RTLD_NEXT, name));
}

__attribute__((constructor)) void begin() {
  const char* const wanted = std::getenv("DARBOUX_FAULT");
  if (wanted == nullptr) return;
  const char* const colon = std::strchr(wanted, ':');
  if (colon == nullptr || colon - wanted >= static_cast<std::ptrdiff_t>(sizeof kind)) return;
  std::memcpy(kind, wanted, static_cast<std::size_t>(colon - wanted));
  at = std::strtoul(colon + 1, nullptr, 10);
  void* frames[2];
  ::backtrace(frames, 2);  // loads what it needs
  ::dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void*) {
        for (int i = 0; i < info->dlpi_phnum; ++i)
          if (info->dlpi_phdr[i].p_type == PT_LOAD && (info->dlpi_phdr[i].p_flags & PF_X) != 0) {
            tool_base = info->dlpi_addr;
            tool_begin = info->dlpi_addr + info->dlpi_phdr[i].p_vaddr;
            tool_end = tool_begin + info->dlpi_phdr[i].p_memsz;
          }
        return 1;  // the first is the program
      },
      nullptr);
  read_own();
  owner = ::getpid();
  wants = true;
}

__attribute__((destructor)) void end() {
  const char* const file = std::getenv("DARBOUX_FAULT_COUNT");
  if (!ready || file == nullptr || ::getpid() != owner) return;
  char text[32];
  const int n = std::snprintf(text, sizeof text, "%lu", count.load());
  const long to = ::syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  ::syscall(SYS_write, to, text, n);
  ::syscall(SYS_close, to);
}

// That of a library that is preloaded after this one, as the leak sanitizer's, or glibc's. Finding it may
// allocate.
void* next_malloc(std::size_t size) {
  static std::atomic<bool> is_finding{false};
  static std::atomic<void* (*)(std::size_t)> found{nullptr};
  if (void* (*const known)(std::size_t) = found.load()) return known(size);
  if (is_finding.exchange(true)) return ::__libc_malloc(size);
  found = next<void*(std::size_t)>("malloc");
  return found.load()(size);
}

// The kind "leak": the first hundred allocations are made twice, and one of each is lost.
void leak(std::size_t size) {
  if (ready && std::strcmp(kind, "leak") == 0 && ++count <= 100) next_malloc(size);
}

void* allocated(std::size_t size) {
  leak(size);
  if (allocation_fails("new")) throw std::bad_alloc();
  void* const result = next_malloc(size == 0 ? 1 : size);
  if (result == nullptr) throw std::bad_alloc();
  return result;
}

void* allocated(std::size_t size, std::align_val_t alignment) {
  if (allocation_fails("new")) throw std::bad_alloc();
  void* result = nullptr;
  if (::posix_memalign(&result, static_cast<std::size_t>(alignment), size) != 0) throw std::bad_alloc();
  return result;
}

}  // namespace

void* operator new(std::size_t size) {
  return allocated(size);
}
void* operator new[](std::size_t size) {
  return allocated(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocated(size, alignment);
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return allocated(size, alignment);
}

namespace {

using Main = int(int, char**, char**);
Main* main_of_tool = nullptr;

struct sigaction action_of_tool {};

void write_stack(int signal) {
  ready = false;
  if (const char* const file = std::getenv("DARBOUX_FAULT_STACK"); file != nullptr) {
    void* frames[64];
    const int n = ::backtrace(frames, 64);
    const long to = ::syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    for (int i = 0; i < n; ++i) {
      const auto place = reinterpret_cast<std::uintptr_t>(frames[i]);
      if (place < tool_begin || place >= tool_end) continue;
      char text[32];
      ::syscall(SYS_write, to, text, std::snprintf(text, sizeof text, "%#lx ", place - tool_base - 1));
    }
    ::syscall(SYS_close, to);
  }
  action_of_tool.sa_handler(signal);
}

int counted_main(int argc, char** argv, char** environment) {
  ready = wants;
  return main_of_tool(argc, argv, environment);
}

}  // namespace

extern "C" {

// Where the process crashes: the places in the tool, from the innermost, go to the file DARBOUX_FAULT_STACK.
int sigaction(int signal, const struct sigaction* action, struct sigaction* before) {
  static const auto real = next<int(int, const struct sigaction*, struct sigaction*)>("sigaction");
  if (!ready || action == nullptr || (signal != SIGSEGV && signal != SIGABRT))
    return real(signal, action, before);
  action_of_tool = *action;
  struct sigaction ours = *action;
  ours.sa_handler = write_stack;
  return real(signal, &ours, before);
}

// What is allocated before main() cannot be refused in words.
int __libc_start_main(Main* main, int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*loader_fini)(),
                      void* stack) {  // NOLINT: glibc's name
  main_of_tool = main;
  static const auto real =
      next<int(Main*, int, char**, void (*)(), void (*)(), void (*)(), void*)>("__libc_start_main");
  return real(counted_main, argc, argv, init, fini, loader_fini, stack);
}

void* malloc(std::size_t size) {
  const auto caller = reinterpret_cast<std::uintptr_t>(__builtin_return_address(0));
  if (caller >= tool_begin && caller < tool_end && allocation_fails("malloc")) {
    errno = ENOMEM;
    return nullptr;
  }
  return next_malloc(size);
}

ssize_t write(int descriptor, const void* bytes, std::size_t size) {
  if (fails("write")) {
    errno = ENOSPC;
    return -1;
  }
  return ::syscall(SYS_write, descriptor, bytes, size);
}

ssize_t read(int descriptor, void* bytes, std::size_t size) {
  if (fails("read")) {
    errno = EIO;
    return -1;
  }
  return ::syscall(SYS_read, descriptor, bytes, size);
}

int rename(const char* from, const char* to) {
  if (fails("rename")) {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_rename, from, to));
}

int linkat(int from, const char* old_name, int to, const char* name, int flags) {
  if (fails("linkat")) {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_linkat, from, old_name, to, name, flags));
}

int fsync(int descriptor) {
  if (fails("fsync")) {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_fsync, descriptor));
}

void* mmap(void* where, std::size_t size, int protection, int flags, int descriptor, off_t offset) {
  if (fails("mmap")) {
    errno = ENOMEM;
    return MAP_FAILED;
  }
  return reinterpret_cast<void*>(::syscall(SYS_mmap, where, size, protection, flags, descriptor, offset));
}

pid_t fork() {
  if (fails("fork")) {
    errno = EAGAIN;
    return -1;
  }
  static const auto real = next<pid_t()>("fork");
  return real();
}

int pipe2(int* ends, int flags) {
  if (fails("pipe2")) {
    errno = EMFILE;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_pipe2, ends, flags));
}

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const unsigned mode =
      (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE ? va_arg(rest, unsigned) : 0;
  va_end(rest);
  if (fails("open")) {
    errno = EMFILE;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

}  // extern "C"
