/// \file said.h
/// What a report says beside notes.
#pragma once

#include <string>

#include <darboux/validate.h>

namespace darboux::test {

/// Code and message of each error and warning, a line each.
inline std::string said(const MeshReport& report) {
  std::string text;
  for (const Finding& f : report.findings)
    if (f.severity != Severity::info) text += std::string(f.code) + ": " + f.message + '\n';
  return text;
}

}  // namespace darboux::test
