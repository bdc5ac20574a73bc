// SPDX-License-Identifier: Apache-2.0
// Hands requests for a mode from any thread to the loop. No Hold and no reset is lost.
#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/core/task/modes.hpp"

namespace fovea::task {

// Lock-free, without a heap. One of each kind can wait; they are taken in the order Hold, reset, track, one
// per tick. Put keeps this order true to the order of the requests: a Hold or a reset drops a track that
// waits, as neither may lead to motion that was asked for before it.
class RequestBox {
 public:
  // From any thread. kNone drops a track that waits.
  void Put(Request request) noexcept {
    std::uint8_t waiting = waiting_.load(std::memory_order_relaxed);
    while (!waiting_.compare_exchange_weak(waiting, With(waiting, request), std::memory_order_release,
                                           std::memory_order_relaxed)) {
    }
  }

  // From any thread: puts it if nothing but kNone was put since the last Take.
  void PutIfEmpty(Request request) noexcept {
    std::uint8_t waiting = waiting_.load(std::memory_order_relaxed);
    while ((waiting & ~kDropsTrack) == 0 &&
           !waiting_.compare_exchange_weak(waiting, With(waiting, request), std::memory_order_release,
                                           std::memory_order_relaxed)) {
    }
  }

  // From one thread: the next request, kNone if none waits. Real-time: yes.
  Request Take() noexcept {
    const std::uint8_t came = waiting_.exchange(0, std::memory_order_acquire);
    if ((came & kDropsTrack) != 0) {
      kept_ = static_cast<std::uint8_t>(kept_ & ~kTrack);
    }
    kept_ = static_cast<std::uint8_t>(kept_ | (came & ~kDropsTrack));
    if ((kept_ & kHold) != 0) {
      return Taken(kHold, Request::kHold);
    }
    if ((kept_ & kReset) != 0) {
      return Taken(kReset, Request::kReset);
    }
    return (kept_ & kTrack) != 0 ? Taken(kTrack, Request::kTrack) : Request::kNone;
  }

  // Forgets all that waits; only while no other thread uses the box.
  void Clear() noexcept {
    waiting_.store(0, std::memory_order_relaxed);
    kept_ = 0;
  }

 private:
  static constexpr std::uint8_t kHold = 1;
  static constexpr std::uint8_t kReset = 2;
  static constexpr std::uint8_t kTrack = 4;
  static constexpr std::uint8_t kDropsTrack = 8;  // what Take has kept, too

  static constexpr std::uint8_t With(std::uint8_t waiting, Request request) noexcept {
    if (request == Request::kTrack) {
      return static_cast<std::uint8_t>(waiting | kTrack);
    }
    const std::uint8_t added = request == Request::kHold ? kHold : request == Request::kReset ? kReset : 0;
    return static_cast<std::uint8_t>((waiting & ~kTrack) | added | kDropsTrack);
  }
  Request Taken(std::uint8_t kind, Request request) noexcept {
    kept_ = static_cast<std::uint8_t>(kept_ & ~kind);
    return request;
  }

  std::atomic<std::uint8_t> waiting_{0};
  std::uint8_t kept_ = 0;  // taken from `waiting_`, not yet given; of the thread that takes
};

}  // namespace fovea::task
