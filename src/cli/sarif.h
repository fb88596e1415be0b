/// \file sarif.h
/// SARIF 2.1.0 output of commands.
#pragma once

#include <string>
#include <string_view>

#include <darboux/validate.h>

#include "command.h"

namespace darboux {

/// A finding about a file, not a mesh, so it is not one of the library.
inline constexpr FindingKind unreadable_file{"FILE_UNREADABLE", Severity::error, "the file cannot be read",
                                             "see what the message expects, and export the file again"};

/// "the message. To do: what to do"
std::string with_to_do(const std::string& message, std::string_view to_do);

/// A rule of the log.
Json sarif_rule(const FindingKind& kind);

/// \param place empty: the file as a whole \param own the original severity, before options change it
Json sarif_result(const std::string& path, std::string_view code, Severity severity, Severity own,
                  const std::string& message, const std::string& place);

/// The document, of one run of this tool.
Json sarif_log(Json rules, Json results);

}  // namespace darboux
