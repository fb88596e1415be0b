/// \file unfinished.h
/// Files that are not finished, which no signal but SIGKILL leaves behind.
#pragma once

#include <csignal>
#include <string>

namespace darboux::io {

/// While one lives, no signal interrupts this thread, and none that remove_unfinished_on_signals() knows ends
/// the process. One thread at a time has it; it is not nested.
class Uninterrupted {
 public:
  Uninterrupted();
  Uninterrupted(const Uninterrupted&) = delete;
  Uninterrupted& operator=(const Uninterrupted&) = delete;
  ~Uninterrupted();

 private:
  sigset_t before_;
};

/// The name of a file to be removed when a signal ends the process. Both are called in a scope with
/// Uninterrupted that creates, renames or removes the file too.
void add_unfinished(const std::string& name);
void drop_unfinished(const std::string& name);

/// For the whole process: all signals that would end it (SIGHUP, SIGINT, SIGTERM, SIGALRM, SIGUSR1, SIGABRT,
/// those of crashes, real-time signals, ...; not SIGKILL), where they are neither ignored nor handled, remove
/// what is unfinished and then end it as they would have done. SIGXFSZ is ignored, so that a file that gets
/// too large is an error of write().
void remove_unfinished_on_signals();

}  // namespace darboux::io
