// SPDX-License-Identifier: Apache-2.0
// From reset to the program: FPU on, data in RAM, the stack filled with a pattern to measure its use later.
#include <cstddef>
#include <cstdint>

#include "fovea/cortex_m7/faults.hpp"
#include "fovea/cortex_m7/program.hpp"
#include "fovea/cortex_m7/registers.hpp"
#include "fovea/cortex_m7/stack.hpp"

// From the linker script.
extern "C" {
extern std::uint32_t data_load_start;
extern std::uint32_t data_start;
extern std::uint32_t data_end;
extern std::uint32_t bss_start;
extern std::uint32_t bss_end;
extern std::uint32_t stack_bottom;
extern std::uint32_t stack_top;
using Initialiser = void (*)();
extern const Initialiser init_array_start[];
extern const Initialiser init_array_end[];

void FaultHandler();
void SysTickHandler();
void Uart0ReceiveHandler();
void Uart0TransmitHandler();
[[noreturn]] void ResetHandler();
}

namespace fovea::cortex_m7 {
namespace {

constexpr std::uint32_t kPaint = 0xA5A5A5A5;

using Vector = void (*)();
struct VectorTable {
  std::uint32_t* stack;
  Vector exceptions[15];
  Vector interrupts[32];
};

// Unexpected exceptions and interrupts are faults.
constexpr VectorTable MakeVectors() {
  VectorTable table{&stack_top, {}, {}};
  for (Vector& vector : table.exceptions) {
    vector = FaultHandler;
  }
  for (Vector& vector : table.interrupts) {
    vector = FaultHandler;
  }
  table.exceptions[0] = ResetHandler;
  table.exceptions[14] = SysTickHandler;
  table.interrupts[kUart0ReceiveIrq] = Uart0ReceiveHandler;
  table.interrupts[kUart0TransmitIrq] = Uart0TransmitHandler;
  return table;
}

}  // namespace

[[gnu::section(".vectors"), gnu::used]] constinit const VectorTable vectors = MakeVectors();

std::uint32_t StackBytes() noexcept {
  const std::uint32_t* word = &stack_bottom;
  while (word < &stack_top && *word == kPaint) {
    ++word;
  }
  return static_cast<std::uint32_t>((&stack_top - word) * static_cast<std::ptrdiff_t>(sizeof(*word)));
}

extern "C" [[noreturn, gnu::used]] void StartProgram() {
  std::uint32_t* from = &data_load_start;
  for (std::uint32_t* to = &data_start; to < &data_end; ++to, ++from) {
    *to = *from;
  }
  for (std::uint32_t* to = &bss_start; to < &bss_end; ++to) {
    *to = 0;
  }
  for (const Initialiser* initialise = init_array_start; initialise < init_array_end; ++initialise) {
    (*initialise)();
  }
  EnableFaults();
  RunProgram();
}

}  // namespace fovea::cortex_m7

// Must not use the FPU before it is on, nor the stack, which is being filled.
extern "C" [[gnu::naked]] void ResetHandler() {
  asm volatile(
      "ldr r0, =0xE000ED88\n"  // CPACR: full access to the FPU
      "ldr r1, [r0]\n"
      "orr r1, r1, #0xF00000\n"
      "str r1, [r0]\n"
      "dsb\n"
      "isb\n"
      "ldr r0, =stack_bottom\n"
      "ldr r1, =stack_top\n"
      "ldr r2, =0xA5A5A5A5\n"
      "1: cmp r0, r1\n"
      "beq 2f\n"
      "str r2, [r0], #4\n"
      "b 1b\n"
      "2: b StartProgram\n");
}
