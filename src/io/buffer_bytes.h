/// \file buffer_bytes.h
/// The bytes of a glTF buffer in pieces: those of a file, which may be mapped, and each that was appended.
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

/// Bytes, and what keeps them where they are.
struct Piece {
  std::string_view bytes;
  std::shared_ptr<const void> owner;

  static Piece of(std::string text) {
    const auto kept = std::make_shared<const std::string>(std::move(text));
    return {*kept, kept};
  }
  /// A part of it, which keeps all of it.
  Piece part(std::size_t begin, std::size_t length) const { return {bytes.substr(begin, length), owner}; }
};

/// Pieces one after the other. What was once appended stays where it is: views of it hold.
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
  /// Some of the bytes, nothing where they do not lie in one piece.
  std::optional<std::string_view> within(std::size_t begin, std::size_t length) const {
    // The last piece that begins there or before, of those that begin at one place the one that is not empty.
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
