// SPDX-License-Identifier: Apache-2.0
// fovea-mcu: the servo on a processor without an operating system, at the end of a serial line.
#include "emitted/panda.hpp"
#include "firmware/core/link/servo_server.hpp"
#include "fovea/cortex_m7/faults.hpp"
#include "fovea/cortex_m7/interrupts.hpp"
#include "fovea/cortex_m7/program.hpp"
#include "fovea/cortex_m7/registers.hpp"
#include "fovea/cortex_m7/stack.hpp"
#include "fovea/cortex_m7/timers.hpp"
#include "fovea/cortex_m7/uart.hpp"

namespace {

namespace m7 = fovea::cortex_m7;
namespace link = fovea::link;

constexpr std::uint32_t kTicksPerStackLook = 64;  // a look takes time: it reads the whole unused stack

class Mps2Board final : public link::Board {
 public:
  void Send(std::span<const std::uint8_t> bytes) noexcept override { m7::SendBytes(bytes); }
  [[nodiscard]] std::uint32_t TimerCounts() noexcept override { return m7::TimerCounts(); }
  [[nodiscard]] std::uint32_t StackBytes() noexcept override {
    if (looks_++ % kTicksPerStackLook == 0) {
      stack_bytes_ = m7::StackBytes();
    }
    return stack_bytes_;
  }
  [[nodiscard]] link::LineLosses Lost() noexcept override {
    const m7::UartCounters& uart = m7::Counters();
    return {uart.received_lost, uart.messages_lost};
  }
  void RunTimer(bool on) noexcept override { m7::RunSysTick(on); }
  [[nodiscard]] std::uint32_t Periods() noexcept override { return m7::SysTicks(); }
  void Provoke(link::Provocation what) noexcept override {
    if (what == link::Provocation::kUsageFault) {
      m7::Register(m7::kCoprocessors) = m7::Register(m7::kCoprocessors) & ~m7::kFpuOn;
      asm volatile("dsb\n isb\n vmov.f64 d0, #1.0" ::: "d0", "memory");
    }
  }

 private:
  std::uint32_t looks_ = 0;
  std::uint32_t stack_bytes_ = 0;
};

fovea::model::ArmModel arm;
Mps2Board board;
link::ServoServer server(arm, board);

// Separate buffers: those of the server may be half-written when a fault comes.
link::FrameWriter crash_writer;
std::array<std::uint8_t, 64> crash_payload;

}  // namespace

// Reports the fault to the host. The host holds the arm when it gets the report, or when the board is silent.
void fovea::cortex_m7::OnFault(const FaultRegisters& registers) noexcept {
  const link::Crash crash{registers.exception, registers.cfsr, registers.hfsr, registers.pc, registers.lr};
  SendBytesNow(crash_writer.Encode({link::FrameKind::kCrash, 0, link::Encode(crash, crash_payload)}));
}

void fovea::cortex_m7::RunProgram() {
  fovea::arms::LoadPanda(arm);
  m7::StartTimers();
  m7::StartUart();
  server.SayHello();
  std::array<std::uint8_t, 64> bytes{};
  for (;;) {
    std::size_t count = 0;
    while (count < bytes.size() && m7::TakeByte(bytes[count])) {
      ++count;
    }
    server.Receive({bytes.data(), count});
    const std::uint32_t periods = m7::SysTicks();
    server.Poll();
    const m7::InterruptLock lock;
    if (!m7::HasByte() && m7::SysTicks() == periods) {
      m7::WaitForInterrupt();
    }
  }
}
