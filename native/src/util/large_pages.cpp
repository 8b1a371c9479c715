#include "util/large_pages.h"

#if defined(__linux__)
#include <sys/mman.h>

#include <cstdlib>
#elif defined(_WIN32)
#include <windows.h>
#endif

namespace photon_splat {

#if defined(__linux__)

void* allocate_large_pages(std::size_t bytes) {
  void* memory = std::aligned_alloc(kLargePage, bytes);
  if (!memory) throw std::bad_alloc();
  madvise(memory, bytes, MADV_HUGEPAGE);  // a wish: where it is not granted nothing is lost
  return memory;
}

void free_large_pages(void* memory) noexcept { std::free(memory); }

#elif defined(_WIN32)

namespace {

// Whether this user may have large pages: "Lock pages in memory" of the local policy, which is
// granted to nobody at first, and has to be switched on in the process too.
bool may_have_large_pages() {
  const SIZE_T page = GetLargePageMinimum();
  HANDLE token = nullptr;
  if (!page || kLargePage % page ||
      !OpenProcessToken(GetCurrentProcess(), TOKEN_ADJUST_PRIVILEGES | TOKEN_QUERY, &token))
    return false;
  TOKEN_PRIVILEGES wanted{};
  wanted.PrivilegeCount = 1;
  wanted.Privileges[0].Attributes = SE_PRIVILEGE_ENABLED;
  const bool granted =
      LookupPrivilegeValueW(nullptr, L"SeLockMemoryPrivilege", &wanted.Privileges[0].Luid) &&
      AdjustTokenPrivileges(token, FALSE, &wanted, 0, nullptr, nullptr) &&
      GetLastError() == ERROR_SUCCESS;  // it succeeds without granting anything, too
  CloseHandle(token);
  return granted;
}

}  // namespace

void* allocate_large_pages(std::size_t bytes) {
  static const bool allowed = may_have_large_pages();
  const DWORD kind = MEM_RESERVE | MEM_COMMIT;
  void* memory = nullptr;
  if (allowed) memory = VirtualAlloc(nullptr, bytes, kind | MEM_LARGE_PAGES, PAGE_READWRITE);
  // Not allowed, or no free memory in one piece: ordinary pages.
  if (!memory) memory = VirtualAlloc(nullptr, bytes, kind, PAGE_READWRITE);
  if (!memory) throw std::bad_alloc();
  return memory;
}

void free_large_pages(void* memory) noexcept { VirtualFree(memory, 0, MEM_RELEASE); }

#endif

}  // namespace photon_splat
