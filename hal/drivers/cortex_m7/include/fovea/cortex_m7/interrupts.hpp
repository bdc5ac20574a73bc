// Interrupts held off for a moment, and sleep until the next.
#pragma once

namespace fovea::cortex_m7 {

class InterruptLock {
 public:
  InterruptLock() noexcept { asm volatile("cpsid i" ::: "memory"); }
  ~InterruptLock() { asm volatile("cpsie i" ::: "memory"); }
  InterruptLock(const InterruptLock&) = delete;
  InterruptLock& operator=(const InterruptLock&) = delete;
};

// One that comes while a lock is held wakes the processor too, and is served when the lock is gone.
inline void WaitForInterrupt() noexcept { asm volatile("dsb\n wfi" ::: "memory"); }

}  // namespace fovea::cortex_m7
