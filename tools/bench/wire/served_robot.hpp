// SPDX-License-Identifier: Apache-2.0
// Runs `fovea-sim serve` as a child process for the lifetime of the object.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace fovea::bench {

class ServedRobot {
 public:
  // Starts the Panda of scenario `ball` at `pace`, without its camera, on a free port of 127.0.0.1. Throws
  // std::runtime_error when `program` does not start or does not print its port.
  ServedRobot(const std::filesystem::path& program, const std::string& pace);
  ~ServedRobot();
  ServedRobot(const ServedRobot&) = delete;
  ServedRobot& operator=(const ServedRobot&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  pid_t process_ = -1;
  int said_ = -1;  // pipe with the program's output
  std::uint16_t port_ = 0;
};

}  // namespace fovea::bench
