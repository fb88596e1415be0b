/// \file buffer.h
/// Uninitialised memory, in large pages where the system has them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <span>
#include <utility>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace darboux::mikk {

// A fixed number of trivial T.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  explicit Buffer(std::size_t size) : size_(size) {
    const std::size_t bytes = (size * sizeof(T) + page) / page * page;
#ifdef __linux__
    if (large()) {  // mapped separately, so that it can be given back; starts at a multiple of the page size
      void* mapped = mmap(nullptr, bytes + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
      if (mapped == MAP_FAILED) throw std::bad_alloc();
      char* const begin = static_cast<char*>(mapped);
      const std::size_t before = (page - reinterpret_cast<std::uintptr_t>(begin) % page) % page;
      if (before > 0) munmap(begin, before);
      if (before < page) munmap(begin + before + bytes, page - before);
      data_ = reinterpret_cast<T*>(begin + before);
      madvise(data_, bytes, MADV_HUGEPAGE);
      return;
    }
#endif
    data_ = static_cast<T*>(std::malloc(size * sizeof(T) + 1));
    if (data_ == nullptr) throw std::bad_alloc();
  }
  Buffer(Buffer&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  Buffer& operator=(Buffer&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~Buffer() {
#ifdef __linux__
    if (large()) {
      munmap(data_, (size_ * sizeof(T) + page) / page * page);
      return;
    }
#endif
    std::free(data_);
  }

  std::size_t size() const {
    return size_;
  }
  bool empty() const {
    return size_ == 0;
  }
  T* data() {
    return data_;
  }
  const T* data() const {
    return data_;
  }
  T& operator[](std::size_t i) {
    return data_[i];
  }
  const T& operator[](std::size_t i) const {
    return data_[i];
  }

 private:
  static constexpr std::size_t page = std::size_t{1} << 21;
  // Clearing a large page takes less time than allocating a quarter of it in pages of 4 kB.
  bool large() const {
    return size_ * sizeof(T) >= page / 4;
  }

  T* data_ = nullptr;
  std::size_t size_ = 0;
};

// Working memory in a few allocations, freed all at once. Not thread-safe.
class Memory {
 public:
  // Frees everything taken, and provides one allocation of at least this many bytes: the present one if it is
  // large enough, else a new one at least as large as all previous ones together.
  void start(std::size_t bytes) {
    used_ = 0;
    if (pieces_.size() == 1 && pieces_.front().size() >= bytes) return;
    const std::size_t size = std::max(bytes, this->bytes());
    pieces_.clear();
    pieces_.emplace_back(size);
  }
  // Uninitialised.
  template <class T>
  std::span<T> take(std::size_t size) {
    constexpr std::size_t line = 64;
    const std::size_t bytes = (size * sizeof(T) + line - 1) / line * line + line;
    if (pieces_.empty() || pieces_.back().size() - used_ < bytes) {
      pieces_.emplace_back(std::max(bytes, least_bytes));
      used_ = 0;
    }
    std::byte* const at = pieces_.back().data() + used_;
    std::byte* const begin = at + (line - reinterpret_cast<std::uintptr_t>(at) % line) % line;
    used_ += bytes;
    return {reinterpret_cast<T*>(begin), size};
  }
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const Buffer<std::byte>& piece : pieces_) sum += piece.size();
    return sum;
  }

 private:
  static constexpr std::size_t least_bytes = 1 << 12;

  std::vector<Buffer<std::byte>> pieces_;
  std::size_t used_ = 0;  // of the last
};

// The first `size` T of memory that several steps use in turn; earlier content is lost.
template <class T>
std::span<T> reused(std::span<std::byte> memory, std::size_t size) {
  return {reinterpret_cast<T*>(memory.data()), size};
}

}  // namespace darboux::mikk
