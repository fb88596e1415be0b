/// \file budget.h
/// How much memory the content of a file may take.
#pragma once

#include <cstdint>
#include <string>

#include <darboux/error.h>
#include <darboux/io.h>

#include "base/text.h"
#include "gltf_file.h"

namespace darboux::io {

/// Bytes per triangle, including what judging it takes: 12 for its corners, the rest for the edges, classes,
/// areas and frames that all commands compute. validate of a plane grid of 4 million triangles peaks at 119
/// per triangle.
constexpr std::uint64_t triangle_bytes = 128;

/// Of smaller files the default is less: they may ask for much more than they hold.
inline constexpr std::uint64_t small_file = 10000000;

/// A file as a whole, for Budget::take().
struct FilePlace {
  const std::string& file;
  void fail(const std::string& expected, const std::string& got) const {
    throw FileError(file, expected_got(expected, got));
  }
};

/// What a file asks for, added up against ReadOptions::max_memory.
class Budget {
 public:
  /// \param file_bytes of the file with its buffers, as they are stored \param taken of what is there already
  Budget(const ReadOptions& options, std::uint64_t file_bytes, std::uint64_t taken = 0);
  /// Decoded data that its buffers have got since it was read are taken.
  explicit Budget(const GltfFile& file);

  /// \param place has fail(expected, got), which throws FileError that names it \param what asks for it
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
