// SPDX-License-Identifier: Apache-2.0
// Hands requests to change keys from any thread to the loop: the last value of each key, one key per tick.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "firmware/core/config/tuning.hpp"

namespace fovea::task {

// Lock-free, without a heap. No key's request is lost: it waits until Take has returned its last value. Take
// may return a value twice if Put runs at the same time.
class TuningBox {
 public:
  // From any thread. False: no key can have this number.
  bool Put(const config::Tuning& tuning) noexcept {
    if (tuning.key < 0 || tuning.key >= config::kMostTunable) {
      return false;
    }
    values_[static_cast<std::size_t>(tuning.key)].store(tuning.value, std::memory_order_relaxed);
    waiting_.fetch_or(Bit(tuning.key), std::memory_order_release);
    return true;
  }

  // From one thread: the next request, kNone if none waits. The keys take turns. Real-time: yes.
  config::Tuning Take() noexcept {
    const std::uint32_t waiting = waiting_.load(std::memory_order_relaxed);
    if (waiting == 0) {
      return {};
    }
    const std::uint32_t ahead = waiting & ~(Bit(turn_) - 1U);
    const int key = std::countr_zero(ahead != 0 ? ahead : waiting);
    turn_ = (key + 1) % config::kMostTunable;
    waiting_.fetch_and(~Bit(key), std::memory_order_acquire);
    return {key, values_[static_cast<std::size_t>(key)].load(std::memory_order_relaxed)};
  }

 private:
  static_assert(config::kMostTunable <= 32, "one bit for each key");
  static constexpr std::uint32_t Bit(int key) noexcept { return 1U << static_cast<unsigned>(key); }

  std::array<std::atomic<double>, config::kMostTunable> values_{};
  std::atomic<std::uint32_t> waiting_{0};  // a bit for each key
  int turn_ = 0;                           // the key that comes first
};

}  // namespace fovea::task
