// SPDX-License-Identifier: Apache-2.0
// Processor faults: the fault is reported once, then the processor sleeps forever.
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

// The program implements it: brings the outputs into their safe state and reports. Runs on its own stack,
// with interrupts off and the FPU on. The processor then sleeps forever.
void OnFault(const FaultRegisters& registers) noexcept;

// Memory management, bus and usage faults get handlers of their own instead of becoming hard faults.
void EnableFaults() noexcept;

// Raises a usage fault, for a failed check of the program.
[[noreturn]] void FailCheck() noexcept;

}  // namespace fovea::cortex_m7
