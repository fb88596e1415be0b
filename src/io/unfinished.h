/// \file unfinished.h
/// Removes unfinished files if a signal other than SIGKILL ends the process.
#pragma once

#include <csignal>
#include <string>

namespace darboux::io {

/// While an object exists, no signal interrupts this thread, and no signal handled by
/// remove_unfinished_on_signals() ends the process. Only one thread at a time can have one; not nestable.
class Uninterrupted {
 public:
  Uninterrupted();
  Uninterrupted(const Uninterrupted&) = delete;
  Uninterrupted& operator=(const Uninterrupted&) = delete;
  ~Uninterrupted();

 private:
  sigset_t before_;
};

/// Registers (add) or unregisters (drop) a file to be removed if a signal ends the process. Call both in an
/// Uninterrupted scope that also creates, renames or removes the file.
void add_unfinished(const std::string& name);
void drop_unfinished(const std::string& name);

/// For the whole process: all signals that would end it (SIGHUP, SIGINT, SIGTERM, SIGALRM, SIGUSR1, SIGABRT,
/// those of crashes, real-time signals, ...; not SIGKILL), if they are neither ignored nor handled, remove
/// unfinished files and then end the process as they would have done. SIGXFSZ is ignored, so that exceeding
/// the file size limit is an error of write().
void remove_unfinished_on_signals();

}  // namespace darboux::io
