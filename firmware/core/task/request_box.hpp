// SPDX-License-Identifier: Apache-2.0
// Hands requests for a mode from any thread to the loop. A Hold is never lost, and never overtaken.
#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/core/task/modes.hpp"

namespace fovea::task {

// Lock-free, without a heap. Waits: a Hold, and the last request after it. They are taken in this order, one
// per tick, so that one person's request cannot cancel the Hold of another.
class RequestBox {
 public:
  // From any thread. A Hold drops what came before it, except a reset. kNone drops all but a Hold.
  void Put(Request request) noexcept {
    std::uint8_t waiting = waiting_.load(std::memory_order_relaxed);
    while (!waiting_.compare_exchange_weak(waiting, With(waiting, request), std::memory_order_release,
                                           std::memory_order_relaxed)) {
    }
  }

  // From any thread: puts it if nothing waits.
  void PutIfEmpty(Request request) noexcept {
    std::uint8_t nothing = 0;
    waiting_.compare_exchange_strong(nothing, With(0, request), std::memory_order_release,
                                     std::memory_order_relaxed);
  }

  // From one thread: the next request, kNone if none waits. Real-time: yes.
  Request Take() noexcept {
    const std::uint8_t waiting = waiting_.exchange(0, std::memory_order_acquire);
    const Request newest = After(waiting);
    if ((waiting & kHold) != 0) {
      after_hold_ = newest != Request::kNone || after_hold_ != Request::kReset ? newest : after_hold_;
      return Request::kHold;
    }
    const Request kept = after_hold_;
    after_hold_ = Request::kNone;
    return newest != Request::kNone ? newest : kept;
  }

  // Forgets all that waits; only while no other thread uses the box.
  void Clear() noexcept {
    waiting_.store(0, std::memory_order_relaxed);
    after_hold_ = Request::kNone;
  }

 private:
  static constexpr std::uint8_t kHold = 0x80;  // a Hold waits; the other bits: the request after it

  static constexpr Request After(std::uint8_t waiting) noexcept {
    return static_cast<Request>(waiting & ~kHold);
  }
  static constexpr std::uint8_t With(std::uint8_t waiting, Request request) noexcept {
    if (request != Request::kHold) {
      return static_cast<std::uint8_t>((waiting & kHold) | static_cast<std::uint8_t>(request));
    }
    const Request kept = After(waiting) == Request::kReset ? Request::kReset : Request::kNone;
    return static_cast<std::uint8_t>(kHold | static_cast<std::uint8_t>(kept));
  }

  std::atomic<std::uint8_t> waiting_{0};
  Request after_hold_ = Request::kNone;  // came with the Hold that was taken last; of the thread that takes
};

}  // namespace fovea::task
