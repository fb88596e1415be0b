// Indices by hash.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace darboux {

// An index is stored at the slot given by the upper bits of its hash or, if that is taken, at the next free
// one.
class HashTable {
 public:
  // Calls f(index) for the indices of this hash until it returns true. Returns whether it did.
  template <class F>
  bool any_of(std::uint32_t hash, F f) const {
    for (std::size_t i = hash >> shift_; slots_[i].index != free; i = next(i))
      if (slots_[i].hash == hash && f(slots_[i].index)) return true;
    return false;
  }
  // Prefetches the slot of a hash that is needed soon: large tables do not fit into the caches.
  void prefetch(std::uint32_t hash) const { __builtin_prefetch(&slots_[hash >> shift_]); }
  static constexpr std::size_t soon = 16;  // number of hashes to look ahead

  void insert(std::uint32_t hash, std::uint32_t index) {
    if (4 * ++size_ > 3 * slots_.size() && shift_ > 0) {
      --shift_;
      for (const Slot& slot : std::exchange(slots_, std::vector<Slot>(2 * slots_.size())))
        if (slot.index != free) place(slot);
    }
    place({hash, index});
  }

 private:
  static constexpr std::uint32_t free = std::numeric_limits<std::uint32_t>::max();
  struct Slot {
    std::uint32_t hash = 0, index = free;
  };
  std::size_t next(std::size_t i) const { return (i + 1) & (slots_.size() - 1); }
  void place(const Slot& slot) {
    std::size_t i = slot.hash >> shift_;
    while (slots_[i].index != free) i = next(i);
    slots_[i] = slot;
  }

  int shift_ = 24;  // 2^(32 - shift_) slots
  std::vector<Slot> slots_ = std::vector<Slot>(1 << 8);
  std::size_t size_ = 0;
};

}  // namespace darboux
