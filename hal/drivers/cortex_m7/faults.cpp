// SPDX-License-Identifier: Apache-2.0
#include "fovea/cortex_m7/faults.hpp"

#include "fovea/cortex_m7/interrupts.hpp"
#include "fovea/cortex_m7/registers.hpp"

namespace fovea::cortex_m7 {
namespace {

constexpr std::uint32_t kMemoryBusUsage = 0x7U << 16U;

// The registers that the processor pushes at an exception.
struct StackFrame {
  std::uint32_t r0;
  std::uint32_t r1;
  std::uint32_t r2;
  std::uint32_t r3;
  std::uint32_t r12;
  std::uint32_t lr;
  std::uint32_t pc;
  std::uint32_t xpsr;
};

}  // namespace

void EnableFaults() noexcept { Register(kSystemHandlers) = Register(kSystemHandlers) | kMemoryBusUsage; }

void FailCheck() noexcept {
  asm volatile("udf #0");
  __builtin_unreachable();
}

// Called by FaultHandler with the stack pointer of the code that faulted.
extern "C" [[noreturn]] void ReportFault(const StackFrame* frame, std::uint32_t exception) {
  // FPU on: the compiler may use its registers even without floating-point code.
  Register(kCoprocessors) = Register(kCoprocessors) | kFpuOn;
  asm volatile("dsb\n isb" ::: "memory");
  OnFault({exception, Register(kFaultStatus), Register(kHardFaultStatus), frame->pc, frame->lr});
  for (;;) {
    WaitForInterrupt();
  }
}

// The stack may be the cause of the fault: switch to another one.
extern "C" [[gnu::naked]] void FaultHandler() {
  asm volatile(
      "cpsid i\n"
      "mov r0, sp\n"
      "mrs r1, ipsr\n"
      "ldr r2, =fault_stack_top\n"
      "mov sp, r2\n"
      "b ReportFault\n");
}

}  // namespace fovea::cortex_m7
