// SPDX-License-Identifier: Apache-2.0
// A queue of a film's frames. Its own thread draws and encodes them while the run goes on.
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

// `Item` holds the data of one frame. Take returns used items again, which reuses their memory. Only one
// thread may fill the queue.
template <typename Item>
class FilmQueue {
 public:
  // The queue's thread calls `work` for each item in order. When `work` is slower than the frames, Take drops
  // a frame (`may_drop`) or waits.
  FilmQueue(bool may_drop, std::function<void(Item&)> work)
      : may_drop_(may_drop), work_(std::move(work)), thread_([this] { Run(); }) {}
  ~FilmQueue() { Close(); }
  FilmQueue(const FilmQueue&) = delete;
  FilmQueue& operator=(const FilmQueue&) = delete;

  // An item to fill and Put: new, or with the data of an earlier frame. None when this frame is dropped.
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

  // Waits until all items are done. Throws what `work` threw.
  void Finish() {
    Close();
    if (failure_) {
      std::rethrow_exception(failure_);
    }
  }

  // Frames dropped for lack of room or after an error.
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
  std::thread thread_;  // last: it starts when all other members exist
};

}  // namespace fovea::film
