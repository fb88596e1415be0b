#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <span>

#include "connectivity.h"

namespace darboux::mikk {

static_assert(std::endian::native == std::endian::little, "a number is the lower half of the two it begins");

namespace {

struct Vertices {
  const MikkMesh& mesh;

  // Zeros of either sign alike: the sign bit counts where the others are not all zero.
  static std::uint64_t without_signs_of_zeros(std::uint64_t two) {
    constexpr std::uint64_t magnitude = 0x7fffffff7fffffff;
    const std::uint64_t some = (two & magnitude) + magnitude;  // the sign bits of those that are not zero
    return two & (some | magnitude);
  }
  std::uint64_t hash(std::size_t v) const {
    const float *p = &mesh.positions[3 * v], *n = &mesh.normals[3 * v], *uv = &mesh.uvs[2 * v];
    const auto two = [](const float* x, const float* y) {
      return std::uint64_t{std::bit_cast<std::uint32_t>(*x)} | std::uint64_t{std::bit_cast<std::uint32_t>(*y)}
                                                                   << 32;
    };
    const std::array<std::uint64_t, 4> w{
        without_signs_of_zeros(two(p, p + 1)), without_signs_of_zeros(two(n, n + 1)),
        without_signs_of_zeros(two(uv, uv + 1)), without_signs_of_zeros(two(p + 2, n + 2))};
    // Multipliers are odd: what differs in one of the four never collides.
    const std::uint64_t sum = w[0] * 0xff51afd7ed558ccd + w[1] * 0xc4ceb9fe1a85ec53 +
                              w[2] * 0x9e3779b97f4a7c15 + w[3] * 0xd6e8feb86659fd93;
    const std::uint64_t product = (sum ^ sum >> 32) * 0xff51afd7ed558ccd;
    // Numbers with many zero bits at their end, as of a grid of small steps, reach the upper half alone. It
    // is what same_half() compares, and stays.
    return product ^ product >> 32;
  }
  bool same_bits(std::size_t a, std::size_t b) const {
    using Words = std::uint64_t __attribute__((vector_size(16)));
    const auto differ = [](std::size_t n, const float* x, const float* y) {
      Words p{}, q{};
      std::memcpy(&p, x, n);
      std::memcpy(&q, y, n);
      return p ^ q;
    };
    const float *p = mesh.positions.data(), *n = mesh.normals.data(), *uv = mesh.uvs.data();
    const Words uvs = differ(8, uv + 2 * a, uv + 2 * b);
    // Three numbers, and one more where another vertex follows.
    const bool last = std::max(a, b) + 1 == mesh.vertex_count();
    const Words threes = last ? differ(12, p + 3 * a, p + 3 * b) | differ(12, n + 3 * a, n + 3 * b)
                              : differ(16, p + 3 * a, p + 3 * b) | differ(16, n + 3 * a, n + 3 * b);
    return (threes[0] | (threes[1] & 0xffffffff) | uvs[0]) == 0;
  }
  // 0: other values; 1: the same bits; 2: the same values, zeros of other signs.
  int compare(std::size_t a, std::size_t b) const {
    if (same_bits(a, b)) return 1;
    const auto equal = [&](std::span<const float> x, std::size_t n) {
      return std::equal(&x[n * a], &x[n * a] + n, &x[n * b]);
    };
    return equal(mesh.positions, 3) && equal(mesh.normals, 3) && equal(mesh.uvs, 2) ? 2 : 0;
  }
  void prefetch(std::size_t v) const {
    __builtin_prefetch(&mesh.positions[3 * v]);
    __builtin_prefetch(&mesh.normals[3 * v]);
    __builtin_prefetch(&mesh.uvs[2 * v]);
  }
};

// Hands out ids.
class Numbers {
 public:
  explicit Numbers(std::atomic<Index>& all) : all_(all) {}
  Index next() {
    if (next_ == end_)
      next_ = all_.fetch_add(ids_at_a_time, std::memory_order_relaxed), end_ = next_ + ids_at_a_time;
    return next_;
  }
  void take() { ++next_; }

 private:
  std::atomic<Index>& all_;
  Index next_ = 0, end_ = 0;
};

// A place of the table: a vertex, the first of its value, and half of its hash; or none.
using Place = std::uint64_t;
constexpr Place empty = ~Place{0};
constexpr Place place_of(std::uint64_t hash, std::size_t v) {
  return (hash & ~std::uint64_t{none}) | v;
}
constexpr Index vertex_in(Place place) {
  return static_cast<Index>(place);
}
constexpr bool same_half(Place place, std::uint64_t hash) {
  return (place ^ hash) >> 32 == 0;
}

// What one thread sees of the table.
struct Alone {
  static Place load(const Place& place) { return place; }
  static bool take(Place& place, Place& expected, Place value) {
    expected = empty;
    place = value;
    return true;
  }
};
struct Shared {
  static Place load(Place& place) { return std::atomic_ref(place).load(std::memory_order_acquire); }
  static bool take(Place& place, Place& expected, Place value) {
    return std::atomic_ref(place).compare_exchange_strong(expected, value, std::memory_order_acq_rel);
  }
};

}  // namespace

std::uint64_t weld_hash(const MikkMesh& mesh, std::size_t v) {
  return Vertices{mesh}.hash(v);
}

// A hash table with a place for each value. False when so much room does not do.
template <class Access>
bool Connectivity::weld_with(std::span<Place> table, std::size_t most_steps) {
  const Vertices vertices{mesh_};
  const std::size_t mask = table.size() - 1;
  parallel_ranges(table.size(), threads_, [&](std::size_t begin, std::size_t end) {
    std::fill(&table[begin], &table[begin] + (end - begin), empty);
  });
  std::atomic<bool> full = false, mixed_zeros = false;
  std::atomic<Index> ids = 0;
  parallel_ranges(id_.size(), threads_, [&](std::size_t begin, std::size_t end) {
    // Some at a time: their places are fetched while hashes are taken, then the vertices there.
    constexpr std::size_t at_a_time = 64;
    std::array<std::uint64_t, at_a_time> hashes;
    Numbers numbers(ids);
    bool mixed = false;
    for (std::size_t first = begin; first < end; first += at_a_time) {
      const std::size_t count = std::min(at_a_time, end - first);
      for (std::size_t i = 0; i < count; ++i) {
        hashes[i] = vertices.hash(first + i);
        __builtin_prefetch(&table[hashes[i] & mask]);
      }
      for (std::size_t i = 0; i < count; ++i) {
        const Place there = Access::load(table[hashes[i] & mask]);
        if (there != empty && same_half(there, hashes[i])) vertices.prefetch(vertex_in(there));
      }
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t v = first + i;
        const std::uint64_t hash = hashes[i];
        for (std::size_t at = hash & mask, steps = 0;; at = (at + 1) & mask, ++steps) {
          if (steps > most_steps) {
            full = true;
            return;
          }
          Place there = Access::load(table[at]);
          if (there == empty) {
            const Index id = numbers.next();
            id_[v] = id;
            stands_for_[id] = static_cast<Index>(v);
            if (Access::take(table[at], there, place_of(hash, v))) {
              numbers.take();
              break;
            }
          }
          if (!same_half(there, hash)) continue;
          const int same = vertices.compare(vertex_in(there), v);
          if (same == 0) continue;
          mixed = mixed || same == 2;
          id_[v] = id_[vertex_in(there)];
          break;
        }
      }
    }
    if (mixed) mixed_zeros = true;
  });
  ids_ = ids;
  mixed_zeros_ = mixed_zeros;
  return !full;
}

void Connectivity::weld() {
  const std::size_t n = mesh_.vertex_count(), enough = weld_places(n);
  id_ = memory_.take<Index>(n);
  stands_for_ = memory_.take<Index>(most_ids(n, threads_));
  const std::span<Place> table = reused<Place>(scratch_, enough);
  const auto with = [&](std::span<Place> places, std::size_t most_steps) {
    return threads_ <= 1 ? weld_with<Alone>(places, most_steps) : weld_with<Shared>(places, most_steps);
  };
  // Vertices of a triangle soup are mostly sixfold: a table that is half full then, and soon in the caches.
  if (mesh_.corners.empty() && n > 4096 && with(table.first(std::bit_ceil(n / 3)), 64)) return;
  with(table, enough);
}

}  // namespace darboux::mikk
