#include "confine.h"

#if defined(__linux__) && (defined(__x86_64__) || defined(__aarch64__))

#include <array>
#include <cerrno>
#include <cstddef>
#include <vector>

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/sanitized.h"

namespace darboux::io {
namespace {

#ifdef __x86_64__
constexpr unsigned architecture = AUDIT_ARCH_X86_64;
#else
constexpr unsigned architecture = AUDIT_ARCH_AARCH64;
#endif

// System calls needed to compute and to answer through a pipe. All others are refused.
constexpr std::array allowed{SYS_read,
                             SYS_write,
                             SYS_writev,
                             SYS_close,
                             SYS_lseek,
                             SYS_fstat,
                             SYS_brk,
                             SYS_mmap,
                             SYS_munmap,
                             SYS_mremap,
                             SYS_mprotect,
                             SYS_madvise,
                             SYS_futex,
                             SYS_rt_sigaction,
                             SYS_rt_sigprocmask,
                             SYS_rt_sigreturn,
                             SYS_sigaltstack,
                             SYS_getpid,
                             SYS_gettid,
                             SYS_clock_gettime,
                             SYS_gettimeofday,
                             SYS_nanosleep,
                             SYS_getrandom,
                             SYS_sched_yield,
                             SYS_sched_getaffinity,
                             SYS_clock_nanosleep,
                             SYS_getrusage,
                             SYS_prlimit64,
                             SYS_uname,
                             SYS_restart_syscall,
#ifdef DARBOUX_SANITIZED
                             SYS_pipe2,  // the sanitizer tests by it which memory is readable
#endif
                             SYS_exit,
                             SYS_exit_group};

// Forbids opening, creating and removing any file.
void forbid_files() {
  landlock_ruleset_attr rules{};
  rules.handled_access_fs = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1;  // all that the first version knows
  const long descriptor = ::syscall(SYS_landlock_create_ruleset, &rules, sizeof rules, 0);
  if (descriptor < 0) return;
  ::syscall(SYS_landlock_restrict_self, descriptor, 0);
  ::close(static_cast<int>(descriptor));
}

// Allows tgkill() of this process itself, for abort(); the filter sees only the numbers.
bool filter_calls() {
  constexpr unsigned load = BPF_LD | BPF_W | BPF_ABS, equal = BPF_JMP | BPF_JEQ | BPF_K,
                     answer = BPF_RET | BPF_K;
  std::vector<sock_filter> program{
      BPF_STMT(load, offsetof(seccomp_data, arch)), BPF_JUMP(equal, architecture, 1, 0),
      BPF_STMT(answer, SECCOMP_RET_KILL_PROCESS), BPF_STMT(load, offsetof(seccomp_data, nr))};
  for (const long call : allowed) {
    program.push_back(BPF_JUMP(equal, static_cast<unsigned>(call), 0, 1));
    program.push_back(BPF_STMT(answer, SECCOMP_RET_ALLOW));
  }
  const std::array<sock_filter, 5> to_itself{
      {BPF_JUMP(equal, SYS_tgkill, 0, 3), BPF_STMT(load, offsetof(seccomp_data, args)),
       BPF_JUMP(equal, static_cast<unsigned>(::getpid()), 0, 1), BPF_STMT(answer, SECCOMP_RET_ALLOW),
       BPF_STMT(answer, SECCOMP_RET_ERRNO | EPERM)}};
  program.insert(program.end(), to_itself.begin(), to_itself.end());
  const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  return ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &filter) == 0;
}

}  // namespace

bool confine_process() {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return false;
  forbid_files();
  return filter_calls();
}

}  // namespace darboux::io

#else

namespace darboux::io {

bool confine_process() {
  return false;
}

}  // namespace darboux::io

#endif
