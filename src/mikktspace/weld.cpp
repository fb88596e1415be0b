#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <span>
#include <vector>

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

// A hash table with one place for each value. Whichever thread comes first, the smallest index stays. found(v, at, there): v is
// at that place, with `there` so far the smallest of its value. False when so much room does not do.
template <class Found>
bool fill(const Vertices& vertices, std::size_t n, std::size_t threads, std::span<Index> table,
          std::size_t most_steps, std::atomic<bool>& mixed_zeros, const Found& found) {
  const std::size_t mask = table.size() - 1;
  in_pieces(table.size(), threads, [&](std::size_t begin, std::size_t end) {
    std::fill(&table[begin], &table[begin] + (end - begin), none);
  });
  std::atomic<bool> full = false;
  in_pieces(n, threads, [&](std::size_t begin, std::size_t end) {
    constexpr std::size_t ahead = 32, vertex_ahead = 12;
    std::array<std::size_t, ahead> places{};
    bool mixed = false;
    for (std::size_t i = begin; i < end + ahead; ++i) {
      if (i >= begin + ahead - vertex_ahead) {
        const Index there =
            std::atomic_ref(table[places[(i + vertex_ahead) % ahead]]).load(std::memory_order_relaxed);
        if (there != none) vertices.prefetch(there);
      }
      std::size_t& first = places[i % ahead];
      if (i >= begin + ahead) {
        const auto v = static_cast<Index>(i - ahead);
        for (std::size_t at = first, steps = 0;; at = (at + 1) & mask, ++steps) {
          if (steps > most_steps) {
            full = true;
            return;
          }
          const std::atomic_ref held(table[at]);
          Index there = held.load(std::memory_order_relaxed);
          if (there == none && held.compare_exchange_strong(there, v, std::memory_order_relaxed)) there = v;
          if (there != v) {
            const int same = vertices.compare(there, v);
            if (same == 0) continue;
            mixed = mixed || same == 2;
          }
          while (v < there && !held.compare_exchange_weak(there, v, std::memory_order_relaxed)) {
          }
          found(v, at, there);
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
  return !full;
}

}  // namespace

void Connectivity::weld() {
  const std::size_t n = mesh_.vertex_count(), enough = weld_places(n);
  id_ = Buffer<Index>(n);
  const std::span<Index> first = room_.as<Index>(n);
  const std::span<Index> places = room_.as<Index>(enough, first.size_bytes());
  std::atomic<bool> mixed_zeros = false;
  std::size_t ids = 0;
  const auto fill_places = [&](std::size_t size, std::size_t most_steps) {
    ids = 0;
    const auto fill_with = [&](const auto& found) {
      return fill(Vertices{mesh_}, n, threads_, places.first(size), most_steps, mixed_zeros, found);
    };
    if (threads_ > 1)
      return fill_with([&](Index v, std::size_t at, Index) { id_[v] = static_cast<Index>(at); });
    return fill_with([&](Index v, std::size_t, Index there) {  // in order, so that `there` is the smallest
      id_[v] = there == v ? static_cast<Index>(ids) : id_[there];
      if (there == v) first[ids++] = v;
    });
  };
  // Vertices of a triangle soup are mostly sixfold.
  std::size_t size = mesh_.corners.empty() && n > 4096 ? enough / 8 : enough;
  if (!fill_places(size, size < enough ? 64 : enough)) fill_places(size = enough, enough);
  mixed_zeros_ = mixed_zeros;
  if (threads_ > 1) return number(first, places.first(size));
  stands_for_ = Buffer<Index>(ids);
  std::copy_n(first.data(), ids, stands_for_.data());
}

// id_ holds places of the table, which knows the smallest vertex of each value: numbered block by block.
void Connectivity::number(std::span<Index> first, std::span<const Index> table) {
  const std::size_t n = mesh_.vertex_count();
  constexpr std::size_t block = 1 << 16;
  const std::size_t blocks = (n + block - 1) / block;
  const auto in_blocks = [&](const auto& f) {
    in_pieces(
        blocks, threads_,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t b = begin; b < end; ++b) f(b, b * block, std::min(n, (b + 1) * block));
        },
        1);
  };
  std::vector<std::size_t> before(blocks + 1, 0);
  in_blocks([&](std::size_t b, std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t v = begin; v < end; ++v) {
      first[v] = table[id_[v]];
      count += first[v] == v ? 1 : 0;
    }
    before[b + 1] = count;
  });
  for (std::size_t b = 0; b < blocks; ++b) before[b + 1] += before[b];
  stands_for_ = Buffer<Index>(before[blocks]);
  in_blocks([&](std::size_t b, std::size_t begin, std::size_t end) {
    std::size_t next = before[b];
    for (std::size_t v = begin; v < end; ++v)
      if (first[v] == v) {
        stands_for_[next] = static_cast<Index>(v);
        id_[v] = static_cast<Index>(next++);
      }
  });
  in_blocks([&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      if (first[v] != v) id_[v] = id_[first[v]];
  });
}

}  // namespace darboux::mikk
