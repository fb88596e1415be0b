#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <span>
#include <vector>

#include "connectivity.h"

namespace darboux::mikk {
namespace {

struct Vertices {
  const MikkMesh& mesh;

  std::uint64_t hash(std::size_t v) const {
    const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x + 0.0F)}; };
    const float *p = &mesh.positions[3 * v], *n = &mesh.normals[3 * v], *uv = &mesh.uvs[2 * v];
    std::uint64_t h = 0x9e3779b97f4a7c15;
    for (const std::uint64_t word : {bits(p[0]) | bits(p[1]) << 32, bits(p[2]) | bits(n[0]) << 32,
                                     bits(n[1]) | bits(n[2]) << 32, bits(uv[0]) | bits(uv[1]) << 32}) {
      h = (h ^ word) * 0xff51afd7ed558ccd;
      h ^= h >> 32;
    }
    return h;
  }
  template <class F>
  bool all_of(const F& f) const {
    return f(mesh.positions, 3) && f(mesh.normals, 3) && f(mesh.uvs, 2);
  }
  bool equal(std::size_t a, std::size_t b) const {
    return all_of([&](std::span<const float> x, std::size_t n) {
      for (std::size_t k = 0; k < n; ++k)
        if (x[n * a + k] != x[n * b + k]) return false;
      return true;
    });
  }
  bool has_negative_zero(std::size_t v) const {
    return !all_of([&](std::span<const float> x, std::size_t n) {
      std::uint32_t found = 0;
      for (std::size_t k = 0; k < n; ++k)
        found |= std::bit_cast<std::uint32_t>(x[n * v + k]) == 0x80000000U ? 1 : 0;
      return found == 0;
    });
  }
};

// A hash table with one place for each value. Whichever thread comes first, the smallest index stays. place[v] is where the
// value of v is. False when so much room does not do.
bool fill(const Vertices& vertices, std::size_t threads, std::span<Index> table, std::size_t most_steps,
          std::span<Index> place, std::atomic<bool>& negative_zeros) {
  const std::size_t mask = table.size() - 1;
  in_pieces(table.size(), threads, [&](std::size_t begin, std::size_t end) {
    std::fill(&table[begin], &table[begin] + (end - begin), none);
  });
  std::atomic<bool> full = false;
  in_pieces(place.size(), threads, [&](std::size_t begin, std::size_t end) {
    constexpr std::size_t ahead = 16;
    std::array<std::size_t, ahead> places{};
    bool negative = false;
    for (std::size_t i = begin; i < end + ahead; ++i) {
      std::size_t& first = places[i % ahead];
      if (i >= begin + ahead) {
        const auto v = static_cast<Index>(i - ahead);
        std::size_t at = first, steps = 0;
        while (true) {
          const std::atomic_ref held(table[at]);
          Index there = held.load(std::memory_order_relaxed);
          if (there == none && held.compare_exchange_strong(there, v, std::memory_order_relaxed)) there = v;
          if (there == v || vertices.equal(there, v)) {
            while (v < there && !held.compare_exchange_weak(there, v, std::memory_order_relaxed)) {
            }
            break;
          }
          if (++steps > most_steps) {
            full = true;
            return;
          }
          at = (at + 1) & mask;
        }
        place[v] = static_cast<Index>(at);
      }
      if (i < end) {
        first = vertices.hash(i) & mask;
        __builtin_prefetch(&table[first]);
        negative = negative || vertices.has_negative_zero(i);
      }
    }
    if (negative) negative_zeros = true;
  });
  return !full;
}

}  // namespace

void Connectivity::weld() {
  const std::size_t n = mesh_.vertex_count(), enough = weld_places(n);
  const Vertices vertices{mesh_};
  id_ = Buffer<Index>(n);
  const std::span<Index> first = room_.as<Index>(n);  // of each vertex: the first that equals it
  const std::span<Index> places = room_.as<Index>(enough, first.size_bytes());
  // Vertices of a triangle soup are mostly sixfold.
  std::span<Index> table = places.first(mesh_.corners.empty() && n > 4096 ? enough / 4 : enough);
  std::atomic<bool> negative_zeros = false;
  if (!fill(vertices, threads_, table, table.size() < enough ? 64 : enough, {id_.data(), n},
            negative_zeros)) {
    table = places;
    fill(vertices, threads_, table, enough, {id_.data(), n}, negative_zeros);
  }
  negative_zeros_ = negative_zeros;
  // Numbered block by block.
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
