/// \file eval_input.h
/// The input points of `eval`: files of u, v in several formats, read in pieces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace darboux {

class Progress;

/// Collects points one by one and passes them on in blocks, reusing their memory.
class PointBlocks {
 public:
  using Use = std::function<void(std::span<const double> u, std::span<const double> v)>;
  PointBlocks(std::size_t block, Use use) : u_(block), v_(block), use_(std::move(use)) {}
  void add(double u, double v) {
    u_[count_] = u;
    v_[count_] = v;
    if (++count_ == u_.size()) pass_on();
  }
  /// Passes on the collected points.
  void pass_on() {
    if (count_ > 0) use_(std::span(u_).first(count_), std::span(v_).first(count_));
    count_ = 0;
  }

 private:
  std::vector<double> u_, v_;
  std::size_t count_ = 0;
  Use use_;
};

/// The values of --input-format.
enum class PointFormat { csv, json, f32, f64, npy };
/// In the order of PointFormat.
inline constexpr std::array<const char*, 5> point_format_names{"csv", "json", "f32", "f64", "npy"};

/// The format of a file by its extension; csv for .txt and .tsv too, and for "-", standard input.
/// \throws FileError for any other extension
PointFormat point_format_of(const std::string& path);

/// An open file of points, or standard input. NaN and infinities are accepted; null in JSON is NaN.
///   csv   the columns u and v if the first line names them, else the first two; lines that begin with # are
///         skipped
///   json  [{"u": 0.25, "v": 0.5}, ...], or that array as "samples" of an object, as eval writes it; other
///         keys are ignored
///   f32, f64  pairs of little-endian numbers
///   npy   shape (n, 2), dtype <f4 or <f8, C order, version 1 or 2
/// Memory does not grow with the number of points.
class PointInput {
 public:
  virtual ~PointInput() = default;

  /// The number of points, if known before all are read.
  virtual std::optional<std::uint64_t> count() const { return std::nullopt; }
  /// The fraction read so far, in [0, 1], if the size is known.
  virtual std::optional<double> share() const = 0;
  /// Reads all points, once. \throws FileError naming the file, the line or point, and what was expected and
  /// found there
  virtual void read(PointBlocks& points) = 0;
};

/// \throws FileError if it cannot be opened, or its header or size is invalid
std::unique_ptr<PointInput> open_points(const std::string& path, PointFormat format);

/// The same points with a known count. If their number is unknown, they are first read to the end and stored
/// in an unnamed temporary file (in $TMPDIR), 16 bytes each. \throws FileError as read(), or if there is no
/// disk space
std::unique_ptr<PointInput> counted(std::unique_ptr<PointInput> points, Progress& progress);

}  // namespace darboux
