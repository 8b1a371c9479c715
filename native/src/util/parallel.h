// The engine's own threads, and the flag that stops them.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

namespace photon_splat {

struct Cancelled : std::runtime_error {
  Cancelled() : std::runtime_error("the render was cancelled") {}
};

// Set from any thread; work that sees it throws Cancelled at its next chunk.
class CancelFlag {
 public:
  void set() { value_.store(true, std::memory_order_relaxed); }
  void clear() { value_.store(false, std::memory_order_relaxed); }
  bool is_set() const { return value_.load(std::memory_order_relaxed); }
  void check() const {
    if (is_set()) throw Cancelled();
  }

 private:
  std::atomic<bool> value_{false};
};

// A fixed set of threads; the caller is one of them. Calls from two threads at once are not
// allowed.
class ThreadPool {
 public:
  using Start = std::function<std::thread(std::function<void()> work)>;
  // threads: 0 = all of the machine. Where the system starts no more of them (std::system_error)
  // there are fewer; start: for tests.
  explicit ThreadPool(int threads, const Start& start = {});
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int size() const { return static_cast<int>(workers_.size()) + 1; }
  int wanted() const { return wanted_; }

  // Calls work(worker) once on every thread and returns when all have finished; rethrows the first
  // exception.
  void run_on_all(const std::function<void(int worker)>& work);

  // Calls work(chunk, worker) for chunks 0 .. count-1 in any order; stops with Cancelled when
  // `cancel` is set.
  void for_each(size_t count, const CancelFlag& cancel,
                const std::function<void(size_t chunk, int worker)>& work);

  // Calls work(begin, end) for parts of 0 .. count, in any order; what is one part alone wakes no
  // thread.
  template <class Work>
  void for_parts(size_t count, size_t part, const CancelFlag& cancel, Work&& work) {
    if (count <= part) return work(size_t{0}, count);
    for_each((count + part - 1) / part, cancel,
             [&](size_t i, int) { work(i * part, std::min(count, (i + 1) * part)); });
  }

 private:
  void worker_loop(int worker);
  void stop();

  int wanted_;
  std::vector<std::thread> workers_;
  std::mutex mutex_;
  std::condition_variable start_, finished_;
  const std::function<void(int)>* work_ = nullptr;
  std::exception_ptr error_;
  uint64_t generation_ = 0;
  int running_ = 0;
  bool stop_ = false;
};

// The same on threads of its own, of all of the machine, where there is more than one part.
template <class Work>
void for_parts_by_all(size_t count, size_t part, Work&& work) {
  if (count <= part) return work(size_t{0}, count);
  ThreadPool(0).for_parts(count, part, CancelFlag{}, work);
}

}  // namespace photon_splat
