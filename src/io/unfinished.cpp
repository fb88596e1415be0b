#include "unfinished.h"

#include <atomic>
#include <set>

#include <unistd.h>

namespace darboux::io {
namespace {

// Whoever holds it has signals blocked, so the handler, which takes it and never releases it, cannot wait for
// its own thread.
std::atomic_flag busy;
pid_t owner = 0;  // a child removes nothing of its parent's

// Never destroyed: a signal may come after main() has returned.
std::set<std::string>& names() {
  static auto& set = *new std::set<std::string>;
  return set;
}

void take() {
  while (busy.test_and_set(std::memory_order_acquire)) {
  }
}

// Only calls that POSIX permits in a handler: the set is read, not changed.
void end_process(int signal) {
  if (::getpid() == owner) {
    take();
    for (const std::string& name : names()) ::unlink(name.c_str());
  }
  ::raise(signal);  // waits until the handler returns; its action is the default again
}

}  // namespace

Uninterrupted::Uninterrupted() {
  sigset_t all;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  take();
}

Uninterrupted::~Uninterrupted() {
  busy.clear(std::memory_order_release);
  ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void add_unfinished(const std::string& name) {
  names().insert(name);
}

void drop_unfinished(const std::string& name) {
  names().erase(name);
}

void remove_unfinished_on_signals() {
  owner = ::getpid();
  names();
  struct sigaction action {};
  action.sa_handler = end_process;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  ::sigfillset(&action.sa_mask);
  // Signals that end no process, and SIGKILL, which cannot be caught.
  const std::set<int> others{SIGKILL, SIGXFSZ, SIGCHLD, SIGCONT, SIGSTOP,
                             SIGTSTP, SIGTTIN, SIGTTOU, SIGURG,  SIGWINCH};
  for (int signal = 1; signal < NSIG; ++signal) {
    struct sigaction before {};
    if (!others.contains(signal) && ::sigaction(signal, nullptr, &before) == 0 &&
        before.sa_handler == SIG_DFL)
      ::sigaction(signal, &action, nullptr);
  }
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace darboux::io
