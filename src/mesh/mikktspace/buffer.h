/// \file buffer.h
/// Memory without values, in large pages where the system has them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <span>
#include <utility>

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
    if (large()) {  // mapped by itself, so that it is given back, from a multiple of the page's size
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
  bool large() const {
    return size_ * sizeof(T) >= 2 * page;
  }

  T* data_ = nullptr;
  std::size_t size_ = 0;
};

// Scratch memory that the steps of the work use one after the other.
class Scratch {
 public:
  explicit Scratch(std::size_t bytes) : bytes_(bytes) {}
  // The first `size` T of it, from a byte on; what was there is gone.
  template <class T>
  std::span<T> as(std::size_t size, std::size_t from_byte = 0) {
    return {reinterpret_cast<T*>(bytes_.data() + from_byte), size};
  }

 private:
  Buffer<std::byte> bytes_;
};

}  // namespace darboux::mikk
