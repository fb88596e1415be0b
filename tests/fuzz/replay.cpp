// In the place of libFuzzer, for any compiler: hands each file of a corpus, and mutants of it, to a target.
//   fuzz_TARGET FOLDER [MUTANTS [SEED]]     how many mutants in all, 0 unless said otherwise
// Mutants are made from the seed, the same ones every time. A target ends the program where it finds
// something; the input that it had then is in fuzz-finding, in the folder where it runs.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

extern "C" {
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);
__attribute__((weak)) std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                                          std::size_t most, unsigned int seed);
}

namespace {

constexpr std::size_t most_bytes = 4096;
#ifdef DARBOUX_SHORT_TESTS
constexpr double slow_s = 100;  // in slow builds
#else
constexpr double slow_s = 10;  // of one input: a finding
#endif

std::mt19937_64 random_bits;
std::vector<std::vector<std::uint8_t>> corpus;
std::vector<std::uint8_t> input;

std::size_t below(std::size_t n) {
  return static_cast<std::size_t>(random_bits() % n);
}

// Only what may be called while the program ends.
void keep_input(int signal) {
  constexpr char name[] = "fuzz-finding";
  const int file = ::open(name, O_CREAT | O_TRUNC | O_WRONLY, 0600);
  if (file < 0 || ::write(file, input.data(), input.size()) < 0) std::_Exit(99);
  constexpr char text[] = "the input is in fuzz-finding\n";
  if (::write(2, text, sizeof text - 1) < 0) std::_Exit(99);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void run(const std::vector<std::uint8_t>& bytes) {
  input = bytes;
  const auto begun = std::chrono::steady_clock::now();
  LLVMFuzzerTestOneInput(input.data(), input.size());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  if (took.count() > slow_s) {
    std::fprintf(stderr, "FOUND: an input takes %.1f s\n", took.count());
    std::abort();
  }
}

}  // namespace

/// One change of a few kinds: bits, numbers that are special, pieces taken out, repeated or from elsewhere.
std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most) {
  if (size == 0) {
    if (most > 0) data[0] = static_cast<std::uint8_t>(below(256));
    return std::min<std::size_t>(most, 1);
  }
  const std::size_t at = below(size);
  const auto insert = [&](const std::uint8_t* from, std::size_t n) {
    n = std::min(n, most - size);
    const std::vector<std::uint8_t> copy(from, from + n);
    std::memmove(data + at + n, data + at, size - at);
    std::copy(copy.begin(), copy.end(), data + at);
    return size + n;
  };
  switch (below(6)) {
    case 0:
      data[at] ^= static_cast<std::uint8_t>(1U << below(8));
      return size;
    case 1:
      data[at] = static_cast<std::uint8_t>(below(256));
      return size;
    case 2: {
      static constexpr std::uint64_t special[] = {0,
                                                  ~std::uint64_t{0},
                                                  1,
                                                  0x7fffffff,
                                                  0x80000000,
                                                  0x7f8000007fc00000,
                                                  0xfff0000000000000,
                                                  0x7fefffffffffffff};
      const std::size_t n = std::min<std::size_t>(std::size_t{1} << below(4), size - at);
      std::memcpy(data + at, &special[below(std::size(special))], n);
      return size;
    }
    case 3: {
      const std::size_t n = 1 + below(std::min<std::size_t>(size - at, 64));
      std::memmove(data + at, data + at + n, size - at - n);
      return size - n;
    }
    case 4:
      return insert(data + at, 1 + below(std::min<std::size_t>(size - at, 64)));
    default: {
      const std::vector<std::uint8_t>& other = corpus[below(corpus.size())];
      if (other.empty()) return size;
      const std::size_t from = below(other.size());
      return insert(other.data() + from, 1 + below(std::min<std::size_t>(other.size() - from, 64)));
    }
  }
}

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) {
    std::fprintf(stderr, "expected FOLDER [MUTANTS [SEED]], got %d arguments\n", argc - 1);
    return 2;
  }
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
    std::ifstream file(entry.path(), std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  if (corpus.empty()) {
    std::fprintf(stderr, "expected files in %s, got none\n", argv[1]);
    return 2;
  }
  std::sort(corpus.begin(), corpus.end(),
            [](const auto& a, const auto& b) {  // that of a folder is the machine's
              return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), std::less<>());
            });
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGBUS}) std::signal(signal, keep_input);
  const std::size_t mutants = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 0;
  const std::uint64_t seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
  random_bits.seed(seed);
  for (const auto& bytes : corpus) run(bytes);
  for (std::size_t i = 0; i < mutants; ++i) {
    std::vector<std::uint8_t> bytes = corpus[below(corpus.size())];
    std::size_t size = std::min(bytes.size(), most_bytes);
    bytes.resize(most_bytes);
    for (std::size_t n = 1 + below(4); n > 0; --n)
      size =
          LLVMFuzzerCustomMutator && below(2) == 0
              ? LLVMFuzzerCustomMutator(bytes.data(), size, most_bytes, static_cast<unsigned>(random_bits()))
              : LLVMFuzzerMutate(bytes.data(), size, most_bytes);
    bytes.resize(size);
    run(bytes);
  }
  std::printf("%zu files, %zu mutants of seed %llu: nothing found\n", corpus.size(), mutants,
              static_cast<unsigned long long>(seed));
}
