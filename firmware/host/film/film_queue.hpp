// Frames of a film, on their way to a thread of their own that draws and encodes them beside the run.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "fovea/linux_rt/realtime.hpp"

namespace fovea::film {

// `Item` holds what a frame needs; used ones are given out again, so that their memory is. One thread fills
// it.
template <typename Item>
class FilmQueue {
 public:
  // `work` is called for each item in order, on the queue's thread, from the first Put on. When it is slower
  // than the frames come: drop one (`may_drop`) or wait.
  FilmQueue(bool may_drop, std::function<void(Item&)> work)
      : may_drop_(may_drop), work_(std::move(work)), thread_([this] { Run(); }) {}
  ~FilmQueue() { Close(); }
  FilmQueue(const FilmQueue&) = delete;
  FilmQueue& operator=(const FilmQueue&) = delete;

  // An item to fill and Put, new or with what is left of an earlier frame; none when this frame is dropped.
  std::optional<Item> Take() {
    std::unique_lock lock(mutex_);
    const auto has_room = [this] { return waiting_.size() < kMostWaiting || failure_ != nullptr; };
    if (!may_drop_) {
      changed_.wait(lock, has_room);
    }
    if (!has_room() || failure_ != nullptr) {
      ++dropped_;
      return std::nullopt;
    }
    if (used_.empty()) {
      return Item{};
    }
    Item item = std::move(used_.back());
    used_.pop_back();
    return item;
  }

  void Put(Item item) {
    {
      const std::lock_guard lock(mutex_);
      waiting_.push_back(std::move(item));
    }
    changed_.notify_all();
  }

  // Waits until all is worked off. Throws what `work` threw.
  void Finish() {
    Close();
    if (failure_) {
      std::rethrow_exception(failure_);
    }
  }

  // Frames that found no place.
  [[nodiscard]] std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  static constexpr std::size_t kMostWaiting = 8;

  void Close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) {
      thread_.join();
    }
  }

  void Run() {
    linux_rt::MakeThreadYielding("fovea-film");
    try {
      while (true) {
        Item item;
        {
          std::unique_lock lock(mutex_);
          changed_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
          if (waiting_.empty()) {
            return;
          }
          item = std::move(waiting_.front());
          waiting_.pop_front();
        }
        changed_.notify_all();
        work_(item);
        const std::lock_guard lock(mutex_);
        used_.push_back(std::move(item));
      }
    } catch (...) {
      {
        const std::lock_guard lock(mutex_);
        failure_ = std::current_exception();
      }
      changed_.notify_all();
    }
  }

  const bool may_drop_;
  const std::function<void(Item&)> work_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> waiting_;
  std::deque<Item> used_;
  bool closed_ = false;
  std::uint64_t dropped_ = 0;
  std::exception_ptr failure_;
  std::thread thread_;  // last: it begins when all else is there
};

}  // namespace fovea::film
