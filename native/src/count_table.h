// How often each of many keys has been counted: open addressing, as looking up is what it is made for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace photon_splat {

// Keys are hashes: their low bits are as good as any.
class CountTable {
 public:
  // The count of `key` once it has gone up by one.
  uint32_t add(uint64_t key) {
    if (2 * (size_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[find(key)];
    size_ += slot.count == 0;
    slot.key = key;
    return ++slot.count;
  }

  bool empty() const { return size_ == 0; }

  // 0: never counted.
  uint32_t count(uint64_t key) const { return slots_.empty() ? 0 : slots_[find(key)].count; }

  // Forgets keys that have been counted less often.
  void keep_from(uint32_t least) {
    std::vector<Slot> all = std::move(slots_);
    size_t kept = 0;
    for (const Slot& slot : all) kept += slot.count >= least;
    size_ = 0;
    slots_.assign(capacity_for(kept), Slot{});
    for (const Slot& slot : all)
      if (slot.count && slot.count >= least) put(slot);
  }

 private:
  struct Slot {
    uint64_t key = 0;
    uint32_t count = 0;
  };

  static size_t capacity_for(size_t keys) {
    size_t capacity = 64;
    while (capacity < 2 * (keys + 1)) capacity *= 2;
    return capacity;
  }
  // Where the key is, or is to be.
  size_t find(uint64_t key) const {
    size_t at = key & (slots_.size() - 1);
    while (slots_[at].count && slots_[at].key != key) at = (at + 1) & (slots_.size() - 1);
    return at;
  }
  void put(const Slot& slot) {
    slots_[find(slot.key)] = slot;
    ++size_;
  }
  void grow() {
    std::vector<Slot> all = std::move(slots_);
    slots_.assign(capacity_for(all.size()), Slot{});
    size_ = 0;
    for (const Slot& slot : all)
      if (slot.count) put(slot);
  }

  std::vector<Slot> slots_;  // a power of two, at most half of them in use
  size_t size_ = 0;
};

}  // namespace photon_splat
