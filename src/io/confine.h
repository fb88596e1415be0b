/// \file confine.h
/// Sandboxes a process that reads an untrusted file.
#pragma once

namespace darboux::io {

/// Sandboxes this process irrevocably: it can still compute, allocate, and use open descriptors. Opening a
/// file, using the network, starting a process or program, and sending signals to other processes fail with
/// EPERM. Uses seccomp and, as a second barrier, Landlock if the kernel supports it. \returns whether the
/// kernel supports this (Linux on x86-64 or AArch64, with seccomp); if not, nothing is changed
bool confine_process();

}  // namespace darboux::io
