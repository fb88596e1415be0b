/// \file child.h
/// Work that may crash, hang or use up the memory, done in a process of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>

namespace darboux::io {

/// What a child process may use.
struct ChildLimits {
  std::uint64_t bytes;  ///< of address space beyond what this process has
  unsigned seconds;     ///< of processor time; twice as many and ten on the clock
  /// Whether it can do nothing but compute and answer: confine.h. Where the kernel cannot, it is not started.
  bool confined = true;
};

/// Why a child process gave no answer: "crashes (Segmentation fault)".
struct ChildFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Runs `work` in a copy of this process and returns its bytes. The copy ends when this process ends, in
/// whatever way. Its output and core dumps are discarded. It has only this thread, so `work` must not wait
/// for another. \throws ChildFailure when it does not end well
std::string in_child(const std::function<std::string()>& work, const ChildLimits& limits);

}  // namespace darboux::io
