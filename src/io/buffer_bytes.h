/// \file buffer_bytes.h
/// The bytes of a glTF buffer as a list of pieces: those of the file, which may be memory-mapped, and
/// appended ones.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace darboux::io {

/// A range of bytes, and the owner that keeps them alive.
struct Piece {
  std::string_view bytes;
  std::shared_ptr<const void> owner;

  static Piece of(std::string text) {
    const auto kept = std::make_shared<const std::string>(std::move(text));
    return {*kept, kept};
  }
  /// A subrange, which keeps the whole piece alive.
  Piece part(std::size_t begin, std::size_t length) const { return {bytes.substr(begin, length), owner}; }
};

/// A sequence of pieces. Appended bytes never move, so views of them remain valid.
class BufferBytes {
 public:
  BufferBytes(Piece first) { append(std::move(first)); }                        // NOLINT: converting
  BufferBytes(std::string first) : BufferBytes(Piece::of(std::move(first))) {}  // NOLINT: converting

  std::size_t size() const { return size_; }
  const std::vector<Piece>& pieces() const { return pieces_; }
  void append(Piece piece) {
    begins_.push_back(size_);
    size_ += piece.bytes.size();
    pieces_.push_back(std::move(piece));
  }
  /// A range of the bytes; empty if it is not within one piece.
  std::optional<std::string_view> within(std::size_t begin, std::size_t length) const {
    // The last piece that begins at or before `begin`; of several with equal begin, the non-empty one.
    const auto after = std::upper_bound(begins_.begin(), begins_.end(), begin);
    const auto k = static_cast<std::size_t>(after - begins_.begin()) - 1;
    const std::string_view bytes = pieces_[k].bytes;
    begin -= begins_[k];
    if (begin > bytes.size() || length > bytes.size() - begin) return std::nullopt;
    return bytes.substr(begin, length);
  }
  std::string joined() const {
    std::string all;
    all.reserve(size_);
    for (const Piece& piece : pieces_) all += piece.bytes;
    return all;
  }

 private:
  std::size_t size_ = 0;
  std::vector<Piece> pieces_;
  std::vector<std::size_t> begins_;  // of the pieces
};

}  // namespace darboux::io
