/// \file confine.h
/// Restricts a process that reads an untrusted file.
#pragma once

namespace darboux::io {

/// Confines this process for good: from now on it computes, allocates, and reads and writes what is open. To
/// open a file, use the network, start a process or a program, or send a signal to another is an error
/// (EPERM). By seccomp and, as a second fence, Landlock where the kernel has it. \returns whether the kernel
/// can (Linux on x86-64 or AArch64, with seccomp); else nothing is done
bool confine_process();

}  // namespace darboux::io
