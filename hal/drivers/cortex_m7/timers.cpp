// SPDX-License-Identifier: Apache-2.0
#include "fovea/cortex_m7/timers.hpp"

#include <atomic>

#include "fovea/cortex_m7/registers.hpp"

namespace fovea::cortex_m7 {
namespace {

constexpr std::uint32_t kTickHz = 1000;
constexpr std::uint32_t kProcessorClock = 1U << 2U;
constexpr std::uint32_t kInterrupt = 1U << 1U;
constexpr std::uint32_t kOn = 1U << 0U;

std::atomic<std::uint32_t> sys_ticks{0};

}  // namespace

void StartTimers() noexcept {
  Register(kTimer0 + kTimerReload) = UINT32_MAX;
  Register(kTimer0 + kTimerValue) = UINT32_MAX;
  Register(kTimer0 + kTimerControl) = kOn;
  Register(kSysTickReload) = kClockHz / kTickHz - 1;
  Register(kSysTickValue) = 0;
}

void RunSysTick(bool on) noexcept {
  Register(kSysTickControl) = kProcessorClock | kInterrupt | (on ? kOn : 0U);
}

std::uint32_t SysTicks() noexcept { return sys_ticks.load(std::memory_order_relaxed); }

std::uint32_t TimerCounts() noexcept { return UINT32_MAX - Register(kTimer0 + kTimerValue); }

extern "C" void SysTickHandler() { sys_ticks.fetch_add(1, std::memory_order_relaxed); }

}  // namespace fovea::cortex_m7
