/// \file eval_output.h
/// Output of `eval`: points evaluated block by block, as text or as binary numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/any_surface.h>
#include <darboux/io.h>

#include "eval_attributes.h"

namespace darboux {

/// The values of --format.
enum class FrameFormat { table, json, csv, f32, f64, npy };
/// In the order of FrameFormat.
inline constexpr std::array<const char*, 6> frame_format_names{"table", "json", "csv", "f32", "f64", "npy"};

/// Evaluates points and writes the results. Memory does not grow with their number.
///   table, json, csv  with u, v and the status, in double
///   f32, f64          for each point the numbers of its attributes, little-endian, nothing else; f32 is
///                     evaluated in double, then rounded
///   npy               the same as f64 after a header of 128 bytes, shape (points, numbers)
class FrameWriter {
 public:
  virtual ~FrameWriter() = default;
  /// Writes at most `room` points. \throws FileError if they cannot be written
  virtual void write(std::span<const double> u, std::span<const double> v) = 0;
  /// Writes `count` rows of a grid, starting at row `first`: see Points::grid().
  virtual void write_grid(std::size_t columns, std::size_t rows, std::size_t first, std::size_t count) = 0;
  /// Writes what follows the last point.
  virtual void finish() {}
};

struct FrameWriterOptions {
  FrameFormat format = FrameFormat::table;
  std::vector<const EvalAttribute*> attributes;  ///< in the order written, each once
  std::size_t room = 4096;                       ///< points per call
  int threads = 1;
  std::uint64_t points = 0;  ///< total number; only npy needs it
};

/// Writes what comes before the first point. `file` and `surface` must outlive the writer.
std::unique_ptr<FrameWriter> make_frame_writer(OutputFile& file, const AnySurface& surface,
                                               const FrameWriterOptions& options);

}  // namespace darboux
