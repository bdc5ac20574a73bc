// SPDX-License-Identifier: Apache-2.0
// The 1 kHz tick, and a counter to measure with.
#pragma once

#include <cstdint>

namespace fovea::cortex_m7 {

// Rate of TimerCounts.
inline constexpr std::uint32_t kTimerHz = 25'000'000;

void StartTimers() noexcept;

// Turns SysTick's interrupts at 1 kHz on or off. Off, the counter keeps its place in the period.
void RunSysTick(bool on) noexcept;
[[nodiscard]] std::uint32_t SysTicks() noexcept;  // since the start; wraps

// Runs freely, upwards, wraps after 172 s.
[[nodiscard]] std::uint32_t TimerCounts() noexcept;

}  // namespace fovea::cortex_m7
