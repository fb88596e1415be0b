/// \file budget.h
/// How much memory the content of a file may take.
#pragma once

#include <cstdint>
#include <string>

#include <darboux/io.h>

#include "json_cursor.h"

namespace darboux::io {

/// What a file asks for, added up before it is allocated, against ReadOptions::max_memory.
class Budget {
 public:
  /// \param file_bytes of the file with its buffers
  Budget(const ReadOptions& options, std::uint64_t file_bytes);

  /// \param what asks for it \throws FileError that names the place, and what was asked for how much
  void take(std::uint64_t bytes, const JsonCursor& place, const std::string& what);

 private:
  std::uint64_t most_, taken_ = 0;
};

}  // namespace darboux::io
