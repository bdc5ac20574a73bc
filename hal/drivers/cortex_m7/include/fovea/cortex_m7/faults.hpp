// What the processor does with an instruction that it cannot execute: it tells once, and does nothing any
// more.
#pragma once

#include <cstdint>

namespace fovea::cortex_m7 {

struct FaultRegisters {
  std::uint32_t exception;  // 3 hard, 4 memory management, 5 bus, 6 usage fault
  std::uint32_t cfsr;
  std::uint32_t hfsr;
  std::uint32_t pc;
  std::uint32_t lr;
};

// The program's: brings the outputs into their safe state and reports. Runs on a stack of its own, with
// interrupts off and the FPU on; the processor sleeps for good after it.
void OnFault(const FaultRegisters& registers) noexcept;

// Memory management, bus and usage faults get handlers of their own instead of becoming hard faults.
void EnableFaults() noexcept;

// What a failed check of the program's own becomes: a usage fault.
[[noreturn]] void FailCheck() noexcept;

}  // namespace fovea::cortex_m7
