// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/qemu.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace fovea::sim {
namespace {

constexpr const char* kProgram = "qemu-system-arm";

// The emulator's threads alternate several times per byte. This is fastest on one processor.
void StayOnOneProcessor() {
  if (const int cpu = sched_getcpu(); cpu >= 0) {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(cpu), &one);
    sched_setaffinity(0, sizeof(one), &one);  // on failure nothing changes
  }
}

// In the child process: executes QEMU, or writes errno to `report`.
[[noreturn]] void Become(std::vector<std::string> arguments, int line, int report, pid_t parent) {
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) {
    argv.push_back(argument.data());
  }
  argv.push_back(nullptr);
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // the emulator ends with its parent
  StayOnOneProcessor();
  // The socket stays open across exec, by the number that the arguments name.
  if (getppid() == parent && dup2(line, line + 1) == line + 1) {
    execvp(kProgram, argv.data());
  }
  const int error = errno;
  static_cast<void>(write(report, &error, sizeof(error)));
  _exit(127);
}

}  // namespace

Qemu::Qemu(const QemuConfig& config) {
  if (!std::filesystem::exists(config.image)) {
    throw std::runtime_error(
        fmt::format("image {} not found; `cmake --build --preset mcu` builds it", config.image.string()));
  }
  std::array<int, 2> line{};
  std::array<int, 2> report{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, line.data()) != 0 ||
      pipe2(report.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(fmt::format("cannot open a line to {}: {}", kProgram, std::strerror(errno)));
  }
  // sleep=off skips the time that the board spends waiting.
  const std::vector<std::string> arguments{
      kProgram,
      "-M",
      "mps2-an500",
      "-nodefaults",
      "-display",
      "none",
      "-monitor",
      "none",
      "-net",
      "none",
      "-kernel",
      config.image.string(),
      "-icount",
      fmt::format("shift={},sleep={}", std::countr_zero(static_cast<unsigned>(config.instruction_ns)),
                  config.real_time ? "on" : "off"),
      "-chardev",
      fmt::format("socket,id=line,fd={}", line[1] + 1),
      "-serial",
      "chardev:line"};
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0) {
    Become(arguments, line[1], report[1], parent);
  }
  close(line[1]);
  close(report[1]);
  line_ = line[0];
  int error = process_ < 0 ? errno : 0;
  if (process_ > 0 && read(report[0], &error, sizeof(error)) == 0) {
    error = 0;  // the pipe closed when exec succeeded
  }
  close(report[0]);
  if (error != 0) {
    if (process_ > 0) {
      waitpid(process_, nullptr, 0);
    }
    close(line_);
    throw std::runtime_error(
        fmt::format("{} does not start: {} (Debian: qemu-system-arm)", kProgram, std::strerror(error)));
  }
}

Qemu::~Qemu() {
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
  close(line_);
}

bool Qemu::Send(std::span<const std::uint8_t> bytes) noexcept {
  while (!bytes.empty() && !gone_) {
    const ssize_t sent = send(line_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    } else if (errno != EINTR) {
      gone_ = true;
    }
  }
  return !gone_;
}

std::span<const std::uint8_t> Qemu::Receive(std::span<std::uint8_t> bytes, int timeout_ms) noexcept {
  pollfd readable{line_, POLLIN, 0};
  if (gone_ || poll(&readable, 1, timeout_ms) <= 0) {
    return {};
  }
  const ssize_t received = recv(line_, bytes.data(), bytes.size(), 0);
  if (received > 0) {
    return bytes.first(static_cast<std::size_t>(received));
  }
  gone_ = received == 0 || errno != EINTR;
  return {};
}

}  // namespace fovea::sim
