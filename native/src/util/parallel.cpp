#include "util/parallel.h"

#include <algorithm>
#include <system_error>

namespace photon_splat {

ThreadPool::ThreadPool(int threads, const Start& start) {
  if (threads <= 0) threads = std::max(1u, std::thread::hardware_concurrency());
  wanted_ = std::min(threads, 1024);
  workers_.reserve(wanted_ - 1);
  try {
    for (int i = 1; i < wanted_; ++i) {
      const auto work = [this, i] { worker_loop(i); };
      if (start)
        workers_.push_back(start(work));
      else
        workers_.emplace_back(work);
    }
    // a limit of processes or memory: those that are there do the work
  } catch (const std::system_error&) {
  } catch (...) {
    stop();
    throw;
  }
}

ThreadPool::~ThreadPool() { stop(); }

void ThreadPool::stop() {
  {
    std::lock_guard lock(mutex_);
    stop_ = true;
  }
  start_.notify_all();
  for (auto& worker : workers_) worker.join();
}

void ThreadPool::worker_loop(int worker) {
  uint64_t seen = 0;
  while (true) {
    const std::function<void(int)>* work = nullptr;
    {
      std::unique_lock lock(mutex_);
      start_.wait(lock, [&] { return stop_ || generation_ != seen; });
      if (stop_) return;
      seen = generation_;
      work = work_;
    }
    std::exception_ptr error;
    try {
      (*work)(worker);
    } catch (...) {
      error = std::current_exception();
    }
    std::lock_guard lock(mutex_);
    if (error && !error_) error_ = error;
    if (--running_ == 0) finished_.notify_one();
  }
}

void ThreadPool::run_on_all(const std::function<void(int)>& work) {
  {
    std::lock_guard lock(mutex_);
    work_ = &work;
    error_ = nullptr;
    running_ = static_cast<int>(workers_.size());
    ++generation_;
  }
  start_.notify_all();
  std::exception_ptr error;
  try {
    work(0);
  } catch (...) {
    error = std::current_exception();
  }
  std::unique_lock lock(mutex_);
  finished_.wait(lock, [&] { return running_ == 0; });
  if (!error) error = error_;
  if (error) std::rethrow_exception(error);
}

void ThreadPool::for_each(size_t count, const CancelFlag& cancel,
                          const std::function<void(size_t, int)>& work) {
  std::atomic<size_t> next{0};
  std::atomic<bool> failed{false};
  run_on_all([&](int worker) {
    while (!failed.load(std::memory_order_relaxed)) {
      const size_t chunk = next.fetch_add(1, std::memory_order_relaxed);
      if (chunk >= count) return;
      try {
        cancel.check();
        work(chunk, worker);
      } catch (...) {
        failed.store(true, std::memory_order_relaxed);
        throw;
      }
    }
  });
}

}  // namespace photon_splat
