// The 1 kHz tick, and a counter to measure with.
#pragma once

#include <cstdint>

namespace fovea::cortex_m7 {

// Of TimerCounts.
inline constexpr std::uint32_t kTimerHz = 25'000'000;

void StartTimers() noexcept;

// SysTick's interrupts at 1 kHz. Off, it keeps what has passed of the period in hand.
void RunSysTick(bool on) noexcept;
[[nodiscard]] std::uint32_t SysTicks() noexcept;  // all of them; wraps

// Runs freely, upwards, wraps after 172 s.
[[nodiscard]] std::uint32_t TimerCounts() noexcept;

}  // namespace fovea::cortex_m7
