#include "budget.h"

#include <algorithm>

namespace darboux::io {
namespace {

constexpr std::uint64_t default_memory = std::uint64_t{4} << 30, small_memory = std::uint64_t{512} << 20;

std::string mebibytes(std::uint64_t bytes) {
  return rounded(static_cast<double>(bytes) / (1 << 20), 4) + " MiB";
}

// Factor of a large file's size. An uncompressed indexed triangle takes at least 12 bytes.
constexpr std::uint64_t honest_expansion = 16;

}  // namespace

Budget::Budget(const ReadOptions& options, std::uint64_t file_bytes, std::uint64_t taken)
    : most_(options.max_memory.value_or(
          file_bytes < small_file ? small_memory : std::max(default_memory, honest_expansion * file_bytes))),
      taken_(taken) {}

Budget::Budget(const GltfFile& file)
    : Budget(file.options, file.stored_bytes > 0 ? file.stored_bytes : file.bytes(),
             file.stored_bytes > 0 ? file.bytes() - std::min(file.bytes(), file.stored_bytes) : 0) {}

std::string Budget::expected() const {
  return "at most " + mebibytes(most_) + " of content (--max-memory raises it)";
}

std::string Budget::got(std::uint64_t bytes, const std::string& what) const {
  return mebibytes(taken_) + " before and " + mebibytes(bytes) + " for " + what;
}

}  // namespace darboux::io
