// SPDX-License-Identifier: Apache-2.0
// Bytes between an interrupt and the main program: one writes, one reads, neither waits.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace fovea::cortex_m7 {

// Holds kCapacity bytes, a power of two.
template <std::size_t kCapacity>
class ByteRing {
  static_assert(kCapacity > 0 && (kCapacity & (kCapacity - 1)) == 0);

 public:
  // From the writer: how many bytes there is room for, at least.
  [[nodiscard]] std::size_t Room() const noexcept {
    return kCapacity - (written_.load(std::memory_order_relaxed) - read_.load(std::memory_order_acquire));
  }
  // From the writer. False, with nothing written, when it is full.
  bool Put(std::uint8_t byte) noexcept {
    if (Room() == 0) {
      return false;
    }
    const std::uint32_t at = written_.load(std::memory_order_relaxed);
    bytes_[at % kCapacity] = byte;
    written_.store(at + 1, std::memory_order_release);
    return true;
  }
  // From the reader.
  [[nodiscard]] bool Empty() const noexcept {
    return read_.load(std::memory_order_relaxed) == written_.load(std::memory_order_acquire);
  }
  // From the reader. False when it is empty.
  bool Take(std::uint8_t& byte) noexcept {
    const std::uint32_t at = read_.load(std::memory_order_relaxed);
    if (at == written_.load(std::memory_order_acquire)) {
      return false;
    }
    byte = bytes_[at % kCapacity];
    read_.store(at + 1, std::memory_order_release);
    return true;
  }

 private:
  std::array<std::uint8_t, kCapacity> bytes_{};
  std::atomic<std::uint32_t> written_{0};  // counts all bytes, wraps
  std::atomic<std::uint32_t> read_{0};
};

}  // namespace fovea::cortex_m7
