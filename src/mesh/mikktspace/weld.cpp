#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <span>

#include "connectivity.h"

namespace darboux::mikk {
namespace {

struct Vertices {
  const MikkMesh& mesh;

  // Zeros of either sign alike.
  std::uint64_t hash(std::size_t v) const {
    const float *p = &mesh.positions[3 * v], *n = &mesh.normals[3 * v], *uv = &mesh.uvs[2 * v];
    const std::array<float, 8> x{p[0] + 0.0F, p[1] + 0.0F, p[2] + 0.0F,  n[0] + 0.0F,
                                 n[1] + 0.0F, n[2] + 0.0F, uv[0] + 0.0F, uv[1] + 0.0F};
    const auto w = std::bit_cast<std::array<std::uint64_t, 4>>(x);
    const std::uint64_t sum =
        (w[0] ^ w[0] >> 29) * 0xff51afd7ed558ccd + (w[1] ^ w[1] >> 31) * 0xc4ceb9fe1a85ec53 +
        (w[2] ^ w[2] >> 29) * 0x9e3779b97f4a7c15 + (w[3] ^ w[3] >> 31) * 0xd6e8feb86659fd93;
    return (sum ^ sum >> 32) * 0xff51afd7ed558ccd >> 20;
  }
  // 0: other values; 1: the same bits; 2: the same values, zeros of other signs.
  int compare(std::size_t a, std::size_t b) const {
    const auto bits_differ = [&](std::span<const float> x, std::size_t n) {
      std::uint64_t a2, b2;
      std::memcpy(&a2, &x[n * a], 8);
      std::memcpy(&b2, &x[n * b], 8);
      const std::uint32_t rest =
          n == 2 ? 0
                 : std::bit_cast<std::uint32_t>(x[n * a + 2]) ^ std::bit_cast<std::uint32_t>(x[n * b + 2]);
      return (a2 ^ b2) | rest;
    };
    if ((bits_differ(mesh.positions, 3) | bits_differ(mesh.normals, 3) | bits_differ(mesh.uvs, 2)) == 0)
      return 1;
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

// Hands out numbers: a few at a time to each thread, so that some are left unused.
class Numbers {
 public:
  static constexpr Index at_a_time = 256;
  explicit Numbers(std::atomic<Index>& all) : all_(all) {}
  Index next() {
    if (next_ == end_) next_ = all_.fetch_add(at_a_time, std::memory_order_relaxed), end_ = next_ + at_a_time;
    return next_;
  }
  void take() { ++next_; }

 private:
  std::atomic<Index>& all_;
  Index next_ = 0, end_ = 0;
};

}  // namespace

// A hash table of ids, one for each value. False when so much room does not do.
bool Connectivity::weld_with(std::span<Index> table, std::size_t most_steps) {
  const Vertices vertices{mesh_};
  const std::size_t mask = table.size() - 1;
  parallel_ranges(table.size(), threads_, [&](std::size_t begin, std::size_t end) {
    std::fill(&table[begin], &table[begin] + (end - begin), none);
  });
  std::atomic<bool> full = false, mixed_zeros = false;
  std::atomic<Index> ids = 0;
  parallel_ranges(id_.size(), threads_, [&](std::size_t begin, std::size_t end) {
    constexpr std::size_t ahead = 32, vertex_ahead = 12;
    std::array<std::size_t, ahead> places{};
    Numbers numbers(ids);
    bool mixed = false;
    for (std::size_t i = begin; i < end + ahead; ++i) {
      if (i >= begin + ahead - vertex_ahead) {
        const std::size_t soon = places[(i + vertex_ahead) % ahead];
        const Index there = std::atomic_ref(table[soon]).load(std::memory_order_acquire);
        if (there != none) vertices.prefetch(stands_for_[there]);
      }
      std::size_t& first = places[i % ahead];
      if (i >= begin + ahead) {
        const std::size_t v = i - ahead;
        for (std::size_t at = first, steps = 0;; at = (at + 1) & mask, ++steps) {
          if (steps > most_steps) {
            full = true;
            return;
          }
          const std::atomic_ref held(table[at]);
          Index there = held.load(std::memory_order_acquire);
          if (there == none) {
            const Index id = numbers.next();
            stands_for_[id] = static_cast<Index>(v);
            if (held.compare_exchange_strong(there, id, std::memory_order_acq_rel)) {
              numbers.take();
              id_[v] = id;
              break;
            }
          }
          const int same = vertices.compare(stands_for_[there], v);
          if (same == 0) continue;
          mixed = mixed || same == 2;
          id_[v] = there;
          break;
        }
      }
      if (i < end) {
        first = vertices.hash(i) & mask;
        __builtin_prefetch(&table[first]);
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
  id_ = Buffer<Index>(n);
  stands_for_ = Buffer<Index>(n + Numbers::at_a_time * range_count(n, threads_));
  const std::span<Index> table = scratch_.as<Index>(enough);
  // Vertices of a triangle soup are mostly sixfold: a table that is half full then, and soon in the caches.
  if (mesh_.corners.empty() && n > 4096 && weld_with(table.first(std::bit_ceil(n / 3)), 64)) return;
  weld_with(table, enough);
}

}  // namespace darboux::mikk
