// SPDX-License-Identifier: Apache-2.0
// Register addresses of the processor and the board. Processor: ARMv7-M Architecture Reference Manual,
// B3; board: Arm MPS2 with image AN500 (Application Note 500), with Arm's CMSDK peripherals (DDI 0479).
#pragma once

#include <cstdint>

namespace fovea::cortex_m7 {

// One 32-bit register of the memory map.
inline volatile std::uint32_t& Register(std::uint32_t address) noexcept {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

inline constexpr std::uint32_t kClockHz = 25'000'000;  // of the board: processor, timers, UART

// Processor
inline constexpr std::uint32_t kSysTickControl = 0xE000E010;
inline constexpr std::uint32_t kSysTickReload = 0xE000E014;
inline constexpr std::uint32_t kSysTickValue = 0xE000E018;
inline constexpr std::uint32_t kInterruptEnable = 0xE000E100;
inline constexpr std::uint32_t kSystemHandlers = 0xE000ED24;   // SHCSR
inline constexpr std::uint32_t kFaultStatus = 0xE000ED28;      // CFSR
inline constexpr std::uint32_t kHardFaultStatus = 0xE000ED2C;  // HFSR
inline constexpr std::uint32_t kCoprocessors = 0xE000ED88;     // CPACR
inline constexpr std::uint32_t kFpuOn = 0xFU << 20U;           // full access to CP10 and CP11

// Board
inline constexpr std::uint32_t kTimer0 = 0x40000000;
inline constexpr std::uint32_t kTimerControl = 0x0;
inline constexpr std::uint32_t kTimerValue = 0x4;
inline constexpr std::uint32_t kTimerReload = 0x8;

inline constexpr std::uint32_t kUart0 = 0x40004000;
inline constexpr std::uint32_t kUartData = 0x0;
inline constexpr std::uint32_t kUartState = 0x4;      // bit 0: transmitter full, bit 1: a byte was received
inline constexpr std::uint32_t kUartControl = 0x8;    // bits 0, 1: transmit, receive; 2, 3: their interrupts
inline constexpr std::uint32_t kUartInterrupt = 0xC;  // write 1 to clear: bit 0 transmit, 1 receive
inline constexpr std::uint32_t kUartDivider = 0x10;
inline constexpr std::uint32_t kUart0ReceiveIrq = 0;
inline constexpr std::uint32_t kUart0TransmitIrq = 1;

}  // namespace fovea::cortex_m7
