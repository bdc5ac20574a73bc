// A board that is emulated: QEMU as a process of ours, and its serial port as a stream of bytes.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <span>

namespace fovea::sim {

struct QemuConfig {
  std::filesystem::path image;  // the ELF file
  int instruction_shift = 6;    // an instruction takes 2^this ns of the board's time
  bool real_time = false;       // the board's time is held to the clock; else it goes as fast as it can
};

class Qemu {
 public:
  // std::runtime_error: no such image, no qemu-system-arm, or it does not start.
  explicit Qemu(const QemuConfig& config);
  ~Qemu();  // ends it
  Qemu(const Qemu&) = delete;
  Qemu& operator=(const Qemu&) = delete;

  // False when it is gone.
  bool Send(std::span<const std::uint8_t> bytes) noexcept;
  // What has come into `bytes`, after at most `timeout_ms`; none when nothing came. Sets gone().
  [[nodiscard]] std::span<const std::uint8_t> Receive(std::span<std::uint8_t> bytes, int timeout_ms) noexcept;
  [[nodiscard]] bool gone() const noexcept { return gone_; }

 private:
  pid_t process_ = -1;
  int line_ = -1;
  bool gone_ = false;
};

}  // namespace fovea::sim
