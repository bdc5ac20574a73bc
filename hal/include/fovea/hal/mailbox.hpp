// SPDX-License-Identifier: Apache-2.0
// Hands messages from one thread to one other: the newest wins, no lock.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace fovea::hal {

// One thread puts, one takes. Wait-free on both sides; no message is ever seen half-written.
//
// Three slots: one is being written, one is being read, the third changes hands by one atomic exchange.
template <typename Message>
class Mailbox {
 public:
  static_assert(std::is_trivially_copyable_v<Message>, "copied without a heap, a lock or an exception");

  Mailbox() noexcept = default;

  // Replaces the last message. Real-time: yes.
  void Put(const Message& message) noexcept {
    slots_[write_slot_] = message;
    // Release: the slot's content is visible before its number is. Acquire: the reader is done with the slot
    // that comes back.
    const auto offered = static_cast<std::uint8_t>(write_slot_ | kFresh);
    const std::uint8_t returned = middle_.exchange(offered, std::memory_order_acq_rel);
    write_slot_ = returned & kSlotMask;
  }

  // True, with the newest message in `message`, when one came since the last Take; else false, and `message`
  // is left as it was. Real-time: yes.
  [[nodiscard]] bool Take(Message& message) noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) {
      return false;
    }
    const std::uint8_t taken = middle_.exchange(read_slot_, std::memory_order_acq_rel);
    read_slot_ = taken & kSlotMask;
    message = slots_[read_slot_];
    return true;
  }

 private:
  static constexpr std::uint8_t kFresh = 0x80;  // the slot in the middle was not read yet
  static constexpr std::uint8_t kSlotMask = 0x03;

  std::array<Message, 3> slots_{};
  std::uint8_t write_slot_ = 0;  // the writer's own
  alignas(64) std::atomic<std::uint8_t> middle_{1};
  alignas(64) std::uint8_t read_slot_ = 2;  // the reader's own
};

}  // namespace fovea::hal
