/// \file child.h
/// Runs work that may crash, hang or exhaust memory in a separate process.
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>

namespace darboux::io {

/// Resource limits of a child process.
struct ChildLimits {
  std::uint64_t bytes;  ///< of address space, in addition to that of this process
  unsigned seconds;     ///< of processor time; the limit of elapsed time is twice that plus ten
  /// Whether it is sandboxed so that it can only compute and answer (confine.h). If the kernel does not
  /// support that, the child is not started.
  bool confined = true;
};

/// The reason why a child process gave no answer: "crashes (Segmentation fault)".
struct ChildFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Runs `work` in a fork of this process and returns the bytes that it returns. The child ends when this
/// process ends, for whatever reason. Its output and core dumps are discarded. It has only the calling
/// thread, so `work` must not wait for another. \throws ChildFailure if the child fails
std::string in_child(const std::function<std::string()>& work, const ChildLimits& limits);

}  // namespace darboux::io
