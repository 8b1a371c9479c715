// What is known of each of many keys: open addressing, as looking up is what it is made for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace photon_splat {

// Keys are hashes: their low bits are as good as any.
template <class Value>
class HashTable {
 public:
  // The value of `key`; as made by default where there was none.
  Value& operator[](uint64_t key) {
    if (2 * (size_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[place_of(key | kUsed)];
    size_ += !slot.key;
    slot.key = key | kUsed;
    return slot.value;
  }

  // nullptr where there is none.
  const Value* find(uint64_t key) const {
    if (slots_.empty()) return nullptr;
    const Slot& slot = slots_[place_of(key | kUsed)];
    return slot.key ? &slot.value : nullptr;
  }

  bool empty() const { return size_ == 0; }
  size_t size() const { return size_; }

  // Forgets the others.
  template <class Keeps>
  void keep_if(Keeps&& keeps) {
    std::vector<Slot> all = std::move(slots_);
    size_t kept = 0;
    for (Slot& slot : all) {
      if (slot.key && !keeps(slot.value)) slot.key = 0;
      kept += slot.key != 0;
    }
    put_all(all, capacity_for(kept));
  }

 private:
  static constexpr uint64_t kUsed = uint64_t{1} << 63;

  struct Slot {
    uint64_t key = 0;  // 0: free
    Value value{};
  };

  static size_t capacity_for(size_t keys) {
    size_t capacity = 64;
    while (capacity < 2 * (keys + 1)) capacity *= 2;
    return capacity;
  }
  // Where the key is, or is to be.
  size_t place_of(uint64_t key) const {
    size_t at = key & (slots_.size() - 1);
    while (slots_[at].key && slots_[at].key != key) at = (at + 1) & (slots_.size() - 1);
    return at;
  }
  void put_all(const std::vector<Slot>& all, size_t capacity) {
    slots_.assign(capacity, Slot{});
    size_ = 0;
    for (const Slot& slot : all) {
      if (!slot.key) continue;
      slots_[place_of(slot.key)] = slot;
      ++size_;
    }
  }
  void grow() {
    const std::vector<Slot> all = std::move(slots_);
    put_all(all, capacity_for(all.size()));
  }

  std::vector<Slot> slots_;  // a power of two, at most half of them in use
  size_t size_ = 0;
};

// How often each key has been counted.
class CountTable {
 public:
  // The count of `key` once it has gone up by one.
  uint32_t add(uint64_t key) { return ++table_[key]; }
  // 0: never counted.
  uint32_t count(uint64_t key) const {
    const uint32_t* found = table_.find(key);
    return found ? *found : 0;
  }
  bool empty() const { return table_.empty(); }
  // Forgets keys that have been counted less often.
  void keep_from(uint32_t least) {
    table_.keep_if([least](uint32_t count) { return count >= least; });
  }

 private:
  HashTable<uint32_t> table_;
};

}  // namespace photon_splat
