// SPDX-License-Identifier: Apache-2.0
// Disables interrupts in a scope, and sleeps until the next interrupt.
#pragma once

namespace fovea::cortex_m7 {

class InterruptLock {
 public:
  InterruptLock() noexcept { asm volatile("cpsid i" ::: "memory"); }
  ~InterruptLock() { asm volatile("cpsie i" ::: "memory"); }
  InterruptLock(const InterruptLock&) = delete;
  InterruptLock& operator=(const InterruptLock&) = delete;
};

// An interrupt during a lock wakes the processor too; it is served when the lock is released.
inline void WaitForInterrupt() noexcept { asm volatile("dsb\n wfi" ::: "memory"); }

}  // namespace fovea::cortex_m7
