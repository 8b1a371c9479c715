// Memory for large arrays that are filled once and soon: in pages of 2 MB where the system has
// them, as touching small ones takes longer than a pass' arithmetic on them. resize() leaves what
// it adds as it comes, for the threads that fill it to touch first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace photon_splat {

// Has the memory come while other things are worked on.
inline void prefetch([[maybe_unused]] const void* memory) {
#if defined(__GNUC__) || defined(__clang__)
  __builtin_prefetch(memory);
#endif
}

inline constexpr std::size_t kLargePage = std::size_t{2} << 20;

// Linux and Windows have them on request; macOS's pages are larger as they are.
#if defined(__linux__) || defined(_WIN32)
#define PHOTON_SPLAT_LARGE_PAGES
// bytes: a multiple of kLargePage. std::bad_alloc where there is no memory.
void* allocate_large_pages(std::size_t bytes);
void free_large_pages(void* memory) noexcept;
#endif

template <class T>
struct LargePages {
  using value_type = T;
  static constexpr std::size_t kPage = kLargePage, kLeast = 4 * kPage;

  LargePages() = default;
  template <class U>
  LargePages(const LargePages<U>&) noexcept {}

  T* allocate(std::size_t count) {
#ifdef PHOTON_SPLAT_LARGE_PAGES
    if (count >= kLeast / sizeof(T)) {
      if (count > (std::size_t{PTRDIFF_MAX} - kPage) / sizeof(T)) throw std::bad_array_new_length();
      const std::size_t bytes = (count * sizeof(T) + kPage - 1) / kPage * kPage;
      return static_cast<T*>(allocate_large_pages(bytes));
    }
#endif
    return std::allocator<T>{}.allocate(count);
  }

  void deallocate(T* memory, std::size_t count) noexcept {
#ifdef PHOTON_SPLAT_LARGE_PAGES
    if (count >= kLeast / sizeof(T)) return free_large_pages(memory);
#endif
    std::allocator<T>{}.deallocate(memory, count);
  }

  template <class U>
  void construct(U*) noexcept {
    static_assert(std::is_trivially_copyable_v<U> && std::is_trivially_destructible_v<U>);
  }
  template <class U, class First, class... Rest>
  void construct(U* at, First&& first, Rest&&... rest) {
    ::new (static_cast<void*>(at)) U(std::forward<First>(first), std::forward<Rest>(rest)...);
  }

  bool operator==(const LargePages&) const = default;
};

template <class T>
using LargeArray = std::vector<T, LargePages<T>>;

}  // namespace photon_splat
