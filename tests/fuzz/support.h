/// \file support.h
/// What fuzz targets share. A target reads bytes nobody made with care: what may happen is a result that its
/// law holds for, or an Error of one line. Anything else is a finding: a crash, another exception, a
/// sanitizer's word.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

#include <darboux/error.h>

namespace darboux::fuzz {

/// Ends the run with a finding.
[[noreturn]] inline void found(const std::string& what) {
  std::fprintf(stderr, "FOUND: %s\n", what.c_str());
  std::abort();
}
inline void expect(bool holds, const char* law) {
  if (!holds) found(law);
}

/// Calls f, which may refuse what it reads, with a message as all have them.
template <class F>
void may_refuse(F f) {
  try {
    f();
  } catch (const Error& error) {
    const std::string_view message = error.what();
    expect(!message.empty() && message.find('\n') == std::string_view::npos, "a message is one line");
    expect(message.size() <= 500, "a message has at most 500 characters");
    for (const char c : message)
      expect(static_cast<unsigned char>(c) >= 32 && c != 127, "a message has no control characters");
  }
}

/// The bytes in a file of this extension, the same one every time.
inline std::string in_file(std::string_view bytes, const std::string& extension) {
  static const std::string folder = [] {
    std::string name = (std::filesystem::temp_directory_path() / "darboux_fuzz_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    static const std::string kept = name;
    std::atexit([] { std::filesystem::remove_all(kept); });
    return name;
  }();
  const std::string path = folder + "/f" + extension;
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Takes numbers off the front of the bytes, zeros where they end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool empty() const { return size_ == 0; }
  template <class T>
  T take() {
    T value{};
    const std::size_t n = std::min(size_, sizeof value);
    if (n > 0) std::memcpy(&value, data_, n);
    data_ += n, size_ -= n;
    return value;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

}  // namespace darboux::fuzz
