#include "util/parallel.h"

#include <doctest/doctest.h>

#include <system_error>

using namespace photon_splat;

TEST_CASE("every chunk is worked on once, whatever the number of threads") {
  for (int threads : {1, 2, 5}) {
    ThreadPool pool(threads);
    CHECK(pool.size() == threads);
    const CancelFlag cancel;
    for (size_t count : {0u, 1u, 3u, 1000u}) {
      std::vector<int> done(count);
      pool.for_each(count, cancel, [&](size_t chunk, int worker) {
        CHECK(worker < threads);
        ++done[chunk];
      });
      CHECK(done == std::vector<int>(count, 1));
    }
  }
}

TEST_CASE("parts cover everything once, and a single one stays with the caller") {
  ThreadPool pool(3);
  const CancelFlag cancel;
  for (size_t count : {0u, 1u, 10u, 11u, 1000u}) {
    std::vector<int> done(count);
    const std::thread::id caller = std::this_thread::get_id();
    std::atomic<int> elsewhere{0};
    pool.for_parts(count, 10, cancel, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) ++done[i];
      elsewhere += std::this_thread::get_id() != caller;
    });
    CHECK(done == std::vector<int>(count, 1));
    if (count <= 10) CHECK(elsewhere == 0);
  }
}

TEST_CASE("many short runs in a row") {
  ThreadPool pool(3);
  const CancelFlag cancel;
  std::vector<int> done(7);
  for (int run = 0; run < 500; ++run)
    pool.for_each(done.size(), cancel, [&](size_t chunk, int) { ++done[chunk]; });
  CHECK(done == std::vector<int>(7, 500));
}

TEST_CASE("an exception reaches the caller, and the pool works on") {
  ThreadPool pool(4);
  const CancelFlag cancel;
  for (size_t bad : {0u, 50u, 99u})
    CHECK_THROWS_WITH_AS(pool.for_each(100, cancel,
                                       [&](size_t chunk, int) {
                                         if (chunk == bad) throw std::out_of_range("chunk");
                                       }),
                         "chunk", std::out_of_range);
  std::atomic<int> done{0};
  pool.for_each(100, cancel, [&](size_t, int) { ++done; });
  CHECK(done == 100);
}

TEST_CASE("a cancelled run stops with Cancelled before its last chunk") {
  ThreadPool pool(2);
  CancelFlag cancel;
  std::atomic<int> done{0};
  CHECK_THROWS_AS(pool.for_each(1000, cancel,
                                [&](size_t, int) {
                                  if (++done == 10) cancel.set();
                                }),
                  Cancelled);
  CHECK(done < 1000);
  CHECK_THROWS_AS(
      pool.for_each(1, cancel, [&](size_t, int) { FAIL_CHECK("worked although cancelled"); }),
      Cancelled);
}

TEST_CASE("where the system starts no more threads those that are there do the work") {
  for (const int most : {0, 2}) {
    int started = 0;
    ThreadPool pool(8, [&](std::function<void()> work) {
      if (started == most)
        throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
      ++started;
      return std::thread(std::move(work));
    });
    CHECK(pool.size() == most + 1);
    CHECK(pool.wanted() == 8);
    const CancelFlag cancel;
    std::vector<int> done(100);
    pool.for_each(done.size(), cancel, [&](size_t chunk, int worker) {
      CHECK(worker <= most);
      ++done[chunk];
    });
    CHECK(done == std::vector<int>(100, 1));
  }
}

TEST_CASE("any other fault while threads start ends those that have started") {
  int started = 0;
  const auto start = [&](std::function<void()> work) {
    if (++started == 3) throw std::bad_alloc();
    return std::thread(std::move(work));
  };
  CHECK_THROWS_AS(ThreadPool(8, start), std::bad_alloc);
}
