#include "budget.h"

#include <algorithm>

namespace darboux::io {
namespace {

constexpr std::uint64_t default_memory = std::uint64_t{4} << 30, small_memory = std::uint64_t{512} << 20;
constexpr std::uint64_t small_file = 10000000;

std::string mebibytes(std::uint64_t bytes) {
  return rounded(static_cast<double>(bytes) / (1 << 20), 4) + " MiB";
}

}  // namespace

Budget::Budget(const ReadOptions& options, std::uint64_t file_bytes)
    : most_(options.max_memory.value_or(file_bytes < small_file ? small_memory : default_memory)) {}

void Budget::take(std::uint64_t bytes, const JsonCursor& place, const std::string& what) {
  if (bytes > most_ - taken_)
    place.fail("at most " + mebibytes(most_) + " of content (--max-memory raises it)",
               mebibytes(taken_) + " before and " + mebibytes(bytes) + " for " + what);
  taken_ += bytes;
}

}  // namespace darboux::io
