// SPDX-License-Identifier: Apache-2.0
// An emulated board: runs QEMU as a child process, with its serial port as a stream of bytes.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <span>

#include "sim/mcu/board_line.hpp"

namespace fovea::sim {

struct QemuConfig {
  std::filesystem::path image;  // the ELF file
  int instruction_ns = 64;      // the board's time per instruction: a power of two
  bool real_time = false;       // true: the board's time follows the clock; false: as fast as possible
};

class Qemu final : public BoardLine {
 public:
  // std::runtime_error: no such image, no qemu-system-arm, or it does not start.
  explicit Qemu(const QemuConfig& config);
  ~Qemu() override;  // ends the emulator

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
