// A board that is emulated: QEMU as a process of ours, and its serial port as a stream of bytes.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <span>

#include "sim/mcu/board_line.hpp"

namespace fovea::sim {

struct QemuConfig {
  std::filesystem::path image;  // the ELF file
  int instruction_ns = 64;      // of the board's time, each: a power of two
  bool real_time = false;       // the board's time is held to the clock; else it goes as fast as it can
};

class Qemu final : public BoardLine {
 public:
  // std::runtime_error: no such image, no qemu-system-arm, or it does not start.
  explicit Qemu(const QemuConfig& config);
  ~Qemu() override;  // ends it

  bool Send(std::span<const std::uint8_t> bytes) noexcept override;
  [[nodiscard]] std::span<const std::uint8_t> Receive(std::span<std::uint8_t> bytes,
                                                      int timeout_ms) noexcept override;
  [[nodiscard]] bool gone() const noexcept override { return gone_; }

 private:
  pid_t process_ = -1;
  int line_ = -1;
  bool gone_ = false;
};

}  // namespace fovea::sim
