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
  using Four = float __attribute__((vector_size(16)));
  using Words = std::uint64_t __attribute__((vector_size(16)));

  explicit Vertices(const MikkMesh& mesh)
      : positions(mesh.positions.data()),
        normals(mesh.normals.data()),
        uvs(mesh.uvs.data()),
        last(mesh.vertex_count() - 1) {}

  const float *positions, *normals, *uvs;
  std::size_t last;

  static Words load(const float* from, std::size_t bytes) {
    Words x{};
    std::memcpy(&x, from, bytes);
    return x;
  }
  // Maps zeros of both signs to +0.
  static Words positive_zeros(const Words& x) {
    return reinterpret_cast<Words>(reinterpret_cast<Four>(x) + 0.0F);
  }
  // 16 bytes for all but the last vertex: three numbers, and one of the next vertex.
  std::uint64_t hash(std::size_t v) const { return v < last ? hash(v, 16) : hash(v, 12); }
  std::uint64_t hash(std::size_t v, std::size_t bytes) const {
    const Words p = positive_zeros(load(positions + 3 * v, bytes)),
                n = positive_zeros(load(normals + 3 * v, bytes)), uv = positive_zeros(load(uvs + 2 * v, 8));
    // Odd multipliers: values that differ in only one of the four words never collide.
    const std::uint64_t sum = p[0] * 0xff51afd7ed558ccd + n[0] * 0xc4ceb9fe1a85ec53 +
                              uv[0] * 0x9e3779b97f4a7c15 +
                              (static_cast<std::uint32_t>(p[1]) | n[1] << 32) * 0xd6e8feb86659fd93;
    const std::uint64_t product = (sum ^ sum >> 32) * 0xff51afd7ed558ccd;
    // Numbers with many trailing zero bits, as in a grid of small steps, affect only the upper half, which
    // same_half() compares and which stays unchanged.
    return product ^ product >> 32;
  }
  bool same_bits(std::size_t a, std::size_t b) const {
    const std::size_t bytes = std::max(a, b) < last ? 16 : 12;
    const auto differ = [](std::size_t n, const float* x, const float* y) { return load(x, n) ^ load(y, n); };
    const float *p = positions, *n = normals;
    const Words uv = differ(8, uvs + 2 * a, uvs + 2 * b);
    const Words threes = bytes == 16 ? differ(16, p + 3 * a, p + 3 * b) | differ(16, n + 3 * a, n + 3 * b)
                                     : differ(12, p + 3 * a, p + 3 * b) | differ(12, n + 3 * a, n + 3 * b);
    return (threes[0] | (threes[1] & 0xffffffff) | uv[0]) == 0;
  }
  // 0: other values; 1: the same bits; 2: the same values, zeros of other signs.
  int compare(std::size_t a, std::size_t b) const {
    if (same_bits(a, b)) return 1;
    const auto equal = [&](const float* x, std::size_t n) {
      return std::equal(x + n * a, x + n * a + n, x + n * b);
    };
    return equal(positions, 3) && equal(normals, 3) && equal(uvs, 2) ? 2 : 0;
  }
  void prefetch(std::size_t v) const {
    __builtin_prefetch(positions + 3 * v);
    __builtin_prefetch(normals + 3 * v);
    __builtin_prefetch(uvs + 2 * v);
  }
};

// Assigns ids.
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

// One thread's access to the table.
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
  return Vertices(mesh).hash(v);
}

// Welds by a hash table with a slot per value. False if the table is too small.
template <class Access>
bool Connectivity::weld_with(std::span<Place> table, std::size_t most_steps) {
  parallel_ranges(table.size(), threads_, [&](std::size_t begin, std::size_t end) {
    std::fill(&table[begin], &table[begin] + (end - begin), empty);
  });
  std::atomic<bool> full = false, joined = false, mixed_zeros = false;
  std::atomic<Index> ids = 0;
  parallel_ranges(
      id_.size(), threads_,
      [&](std::size_t begin, std::size_t end) {
        // Several at a time: their slots are prefetched while hashes are computed, then the vertices there.
        constexpr std::size_t at_a_time = 64;
        std::array<std::uint64_t, at_a_time> hashes;
        const Vertices vertices(mesh_);
        Place* const places = table.data();
        Index *const id_of = id_.data(), *const stands_for = stands_for_.data();
        const std::size_t mask = table.size() - 1;
        Numbers numbers(ids);
        bool some = false, mixed = false;
        for (std::size_t first = begin; first < end; first += at_a_time) {
          const std::size_t count = std::min(at_a_time, end - first);
          for (std::size_t i = 0; i < count; ++i) {
            hashes[i] = vertices.hash(first + i);
            __builtin_prefetch(&places[hashes[i] & mask]);
          }
          for (std::size_t i = 0; i < count; ++i) {
            const Place there = Access::load(places[hashes[i] & mask]);
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
              Place there = Access::load(places[at]);
              if (there == empty) {
                const Index id = numbers.next();
                id_of[v] = id;
                stands_for[id] = static_cast<Index>(v);
                if (Access::take(places[at], there, place_of(hash, v))) {
                  numbers.take();
                  break;
                }
              }
              if (!same_half(there, hash)) continue;
              const int same = vertices.compare(vertex_in(there), v);
              if (same == 0) continue;
              some = true;
              mixed = mixed || same == 2;
              id_of[v] = id_of[vertex_in(there)];
              break;
            }
          }
        }
        if (some) joined = true;
        if (mixed) mixed_zeros = true;
      },
      least_welded);
  ids_ = ids;
  joined_ = joined;
  mixed_zeros_ = mixed_zeros;
  return !full;
}

void Connectivity::weld() {
  const std::size_t n = mesh_.vertex_count(), enough = weld_places(n);
  id_ = memory_.take<Index>(n);
  stands_for_ = memory_.take<Index>(most_ids(n, threads_));
  const std::span<Place> table = reused<Place>(scratch_, enough);
  const auto with = [&](std::span<Place> places, std::size_t most_steps) {
    return range_count(n, threads_, least_welded) == 1 ? weld_with<Alone>(places, most_steps)
                                                       : weld_with<Shared>(places, most_steps);
  };
  // Vertices of a triangle soup mostly occur six times, so this table is at most a third full, and soon in
  // the caches.
  if (mesh_.corners.empty() && n > 4096 && with(table.first(std::bit_ceil(n / 2)), 64)) return;
  with(table, enough);
  if (joined_) return;
  ids_ = n;  // vertices are their own ids
  parallel_ranges(n, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) id_[v] = stands_for_[v] = static_cast<Index>(v);
  });
}

}  // namespace darboux::mikk
