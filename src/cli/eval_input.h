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

/// Points on their way to the batch: collected one by one, handed on in blocks whose memory is used again.
class PointBlocks {
 public:
  using Use = std::function<void(std::span<const double> u, std::span<const double> v)>;
  PointBlocks(std::size_t block, Use use) : u_(block), v_(block), use_(std::move(use)) {}
  void add(double u, double v) {
    u_[count_] = u;
    v_[count_] = v;
    if (++count_ == u_.size()) pass_on();
  }
  /// Hands on what has been collected.
  void pass_on() {
    if (count_ > 0) use_(std::span(u_).first(count_), std::span(v_).first(count_));
    count_ = 0;
  }

 private:
  std::vector<double> u_, v_;
  std::size_t count_ = 0;
  Use use_;
};

/// What --input-format takes.
enum class PointFormat { csv, json, f32, f64, npy };
/// In the order of PointFormat.
inline constexpr std::array<const char*, 5> point_format_names{"csv", "json", "f32", "f64", "npy"};

/// The format of a file by its extension; csv for .txt and .tsv too, and for "-", standard input.
/// \throws FileError for any other extension
PointFormat point_format_of(const std::string& path);

/// An open file of points, or standard input. NaN and infinities are points like others, JSON's null is NaN.
///   csv   the columns u and v where the first line names them, else the first two; lines that begin with #
///         are passed over
///   json  [{"u": 0.25, "v": 0.5}, ...], or that array as "samples" of an object, as eval writes it; other
///         keys are passed over
///   f32, f64  pairs of little-endian numbers
///   npy   shape (n, 2), dtype <f4 or <f8, C order, version 1 or 2
/// Memory does not grow with the number of points.
class PointInput {
 public:
  virtual ~PointInput() = default;

  /// How many there are, where that is known before all are read.
  virtual std::optional<std::uint64_t> count() const { return std::nullopt; }
  /// The part read so far, in [0, 1], where the size is known.
  virtual std::optional<double> share() const = 0;
  /// All of them, once. \throws FileError naming the file, its line or point, what is expected there and what
  /// it has
  virtual void read(PointBlocks& points) = 0;
};

/// \throws FileError when it cannot be opened, or its beginning or size is wrong
std::unique_ptr<PointInput> open_points(const std::string& path, PointFormat format);

/// The same points, counted: those whose number is not known beforehand are read to the end and kept
/// meanwhile in a file without a name in the folder for temporary files ($TMPDIR), 16 bytes each. \throws
/// FileError as read() does, or when there is no room
std::unique_ptr<PointInput> counted(std::unique_ptr<PointInput> points, Progress& progress);

}  // namespace darboux
