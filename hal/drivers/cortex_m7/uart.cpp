// SPDX-License-Identifier: Apache-2.0
#include "fovea/cortex_m7/uart.hpp"

#include "fovea/cortex_m7/byte_ring.hpp"
#include "fovea/cortex_m7/interrupts.hpp"
#include "fovea/cortex_m7/registers.hpp"

namespace fovea::cortex_m7 {
namespace {

constexpr std::uint32_t kTransmitterFull = 1U << 0U;
constexpr std::uint32_t kReceived = 1U << 1U;
constexpr std::uint32_t kTransmitDone = 1U << 0U;
constexpr std::uint32_t kReceiveDone = 1U << 1U;
constexpr std::uint32_t kAllOn = 0xFU;         // both ways, and their interrupts
constexpr std::uint32_t kFastestDivider = 16;  // the smallest that the UART accepts

ByteRing<8192> received;
ByteRing<16384> to_send;
UartCounters counters;

volatile std::uint32_t& Uart(std::uint32_t offset) noexcept { return Register(kUart0 + offset); }

// Sends queued bytes while the transmitter has room.
void SendNext() noexcept {
  std::uint8_t byte = 0;
  while ((Uart(kUartState) & kTransmitterFull) == 0 && to_send.Take(byte)) {
    Uart(kUartData) = byte;
  }
}

}  // namespace

void StartUart() noexcept {
  Uart(kUartDivider) = kFastestDivider;
  Uart(kUartControl) = kAllOn;
  Register(kInterruptEnable) = 1U << kUart0ReceiveIrq | 1U << kUart0TransmitIrq;
}

bool HasByte() noexcept { return !received.Empty(); }

bool TakeByte(std::uint8_t& byte) noexcept { return received.Take(byte); }

void SendBytes(std::span<const std::uint8_t> message) noexcept {
  if (to_send.Room() < message.size()) {
    ++counters.messages_lost;
    return;
  }
  for (const std::uint8_t byte : message) {
    to_send.Put(byte);
  }
  const InterruptLock lock;  // the interrupt sends too
  SendNext();
}

void SendBytesNow(std::span<const std::uint8_t> message) noexcept {
  for (const std::uint8_t byte : message) {
    while ((Uart(kUartState) & kTransmitterFull) != 0) {
    }
    Uart(kUartData) = byte;
  }
}

const UartCounters& Counters() noexcept { return counters; }

extern "C" void Uart0ReceiveHandler() {
  Uart(kUartInterrupt) = kReceiveDone;
  while ((Uart(kUartState) & kReceived) != 0) {
    if (!received.Put(static_cast<std::uint8_t>(Uart(kUartData)))) {
      ++counters.received_lost;
    }
  }
}

extern "C" void Uart0TransmitHandler() {
  Uart(kUartInterrupt) = kTransmitDone;
  SendNext();
}

}  // namespace fovea::cortex_m7
