// SPDX-License-Identifier: Apache-2.0
// UART 0 of the board, by interrupts, with a ring of bytes each way.
#pragma once

#include <cstdint>
#include <span>

namespace fovea::cortex_m7 {

struct UartCounters {
  std::uint32_t received_lost = 0;  // bytes that arrived while the ring was full
  std::uint32_t messages_lost = 0;  // dropped because the ring was full
};

void StartUart() noexcept;

[[nodiscard]] bool HasByte() noexcept;

// False when no byte is there.
[[nodiscard]] bool TakeByte(std::uint8_t& byte) noexcept;

// Queues all of `message`, or nothing if there is no room. Does not wait.
void SendBytes(std::span<const std::uint8_t> message) noexcept;

// Sends all of `message` at once, waits for each byte, needs no interrupts: for a processor that has faulted.
void SendBytesNow(std::span<const std::uint8_t> message) noexcept;

[[nodiscard]] const UartCounters& Counters() noexcept;

}  // namespace fovea::cortex_m7
