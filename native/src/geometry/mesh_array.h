// An array of a mesh: its own, or one that somebody lends it, which is not copied before it has to
// change.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>

#include "util/large_pages.h"

namespace photon_splat {

template <class T>
class MeshArray {
 public:
  using value_type = T;

  MeshArray() = default;
  MeshArray(LargeArray<T> own) : own_(std::move(own)) {}
  MeshArray(std::initializer_list<T> values) : own_(values) {}
  // lender: keeps the memory as it is while it lives.
  MeshArray(const T* lent, std::size_t count, std::shared_ptr<const void> lender)
      : lent_(lent), count_(count), lender_(std::move(lender)) {}

  const T* data() const { return lent_ ? lent_ : own_.data(); }
  std::size_t size() const { return lent_ ? count_ : own_.size(); }
  bool empty() const { return size() == 0; }
  const T& operator[](std::size_t i) const { return data()[i]; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size(); }

  // To be changed: copied first where it is lent.
  LargeArray<T>& own() {
    if (lent_) {
      own_.assign(lent_, lent_ + count_);
      lent_ = nullptr;
      count_ = 0;
      lender_.reset();
    }
    return own_;
  }

 private:
  LargeArray<T> own_;
  const T* lent_ = nullptr;
  std::size_t count_ = 0;
  std::shared_ptr<const void> lender_;
};

}  // namespace photon_splat
