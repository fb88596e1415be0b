/// \file budget.h
/// Limits the memory for the content of a file.
#pragma once

#include <cstdint>
#include <string>

#include <darboux/error.h>
#include <darboux/io.h>

#include "base/text.h"
#include "gltf_file.h"

namespace darboux::io {

/// Bytes per triangle, including the memory for judging it: 12 for its indices, the rest for the edges,
/// classes, areas and frames that commands compute. validate of a plane grid of 4 million triangles peaks at
/// 119 per triangle.
constexpr std::uint64_t triangle_bytes = 128;

/// Smaller files have a lower default limit, since they can declare much more content than they hold.
inline constexpr std::uint64_t small_file = 10000000;

/// A file as a whole, for Budget::take().
struct FilePlace {
  const std::string& file;
  void fail(const std::string& expected, const std::string& got) const {
    throw FileError(file, expected_got(expected, got));
  }
};

/// Adds up the memory that a file requires, and compares it with ReadOptions::max_memory.
class Budget {
 public:
  /// \param file_bytes stored size of the file with its buffers \param taken bytes already in use
  Budget(const ReadOptions& options, std::uint64_t file_bytes, std::uint64_t taken = 0);
  /// Counts data that were decoded into the buffers since the file was read.
  explicit Budget(const GltfFile& file);

  /// \param place has fail(expected, got), which throws a FileError that names the place \param what the
  /// content that needs the memory
  template <class Place>
  void take(std::uint64_t bytes, const Place& place, const std::string& what) {
    if (taken_ > most_ || bytes > most_ - taken_) place.fail(expected(), got(bytes, what));
    taken_ += bytes;
  }

 private:
  std::string expected() const;
  std::string got(std::uint64_t bytes, const std::string& what) const;
  std::uint64_t most_, taken_;
};

}  // namespace darboux::io
