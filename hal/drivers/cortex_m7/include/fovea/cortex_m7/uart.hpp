// UART 0 of the board, by interrupts, with a ring of bytes each way.
#pragma once

#include <cstdint>
#include <span>

namespace fovea::cortex_m7 {

struct UartCounters {
  std::uint32_t received_lost = 0;  // bytes that came while the ring was full
  std::uint32_t messages_lost = 0;  // that found no room to be sent
};

void StartUart() noexcept;

[[nodiscard]] bool HasByte() noexcept;

// False when no byte is there.
[[nodiscard]] bool TakeByte(std::uint8_t& byte) noexcept;

// All of `message`, or nothing of it where there is no room. Does not wait.
void SendBytes(std::span<const std::uint8_t> message) noexcept;

// All of `message` at once, waiting for each byte, whatever the interrupts do: for a processor that has
// faulted.
void SendBytesNow(std::span<const std::uint8_t> message) noexcept;

[[nodiscard]] const UartCounters& Counters() noexcept;

}  // namespace fovea::cortex_m7
