// Finds blocks of a sparse grid by their integer coordinates.
#pragma once

#include "engine/core/random.h"
#include "engine/core/types.h"

#include <vector>

namespace rend {

/// Hash map from block coordinates, each within +-2^20, to an index; open addressing, never
/// shrinks.
class BlockIndex {
 public:
  /// One number per block; neighbours in space get numbers that are near each other (Morton order).
  static std::uint64_t key(const Vec3i& coord) {
    std::uint64_t key = 0;
    for (int a = 0; a < 3; ++a)
      key |= spread(static_cast<std::uint64_t>(coord[a] + kOffset)) << (2 - a);
    return key;
  }

  void clear(std::size_t expected) {
    std::size_t capacity = 64;
    while (capacity < 2 * expected) capacity *= 2;
    slots_.assign(capacity, Slot{});
    count_ = 0;
  }

  /// Index of a block, -1 when it is not there.
  Index find(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t at = mix_bits(key) & mask;; at = (at + 1) & mask) {
      if (slots_[at].index < 0) return -1;
      if (slots_[at].key == key) return slots_[at].index;
    }
  }

  /// Index of a block, which becomes `fresh` when it was not there.
  Index find_or_add(std::uint64_t key, Index fresh) {
    if (2 * (count_ + 1) > slots_.size()) grow();
    Slot& slot = place(key);
    if (slot.index < 0) {
      slot = {key, fresh};
      ++count_;
    }
    return slot.index;
  }

  std::size_t bytes() const { return slots_.size() * sizeof(Slot); }

 private:
  struct Slot {
    std::uint64_t key = 0;
    Index index = -1;
  };
  static constexpr int kOffset = 1 << 20;

  static std::uint64_t spread(std::uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
  }
  Slot& place(std::uint64_t key) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = mix_bits(key) & mask;
    while (slots_[at].index >= 0 && slots_[at].key != key) at = (at + 1) & mask;
    return slots_[at];
  }
  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old)
      if (slot.index >= 0) place(slot.key) = slot;
  }

  std::vector<Slot> slots_ = std::vector<Slot>(64);
  std::size_t count_ = 0;
};

}  // namespace rend
