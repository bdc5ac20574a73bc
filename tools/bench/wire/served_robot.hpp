// `fovea-sim serve` as a program of its own, for as long as the object lives.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace fovea::bench {

class ServedRobot {
 public:
  // The Panda of scenario `ball` at this pace, without its camera, on a free port of 127.0.0.1. Throws
  // std::runtime_error when `program` does not start or does not say where it listens.
  ServedRobot(const std::filesystem::path& program, const std::string& pace);
  ~ServedRobot();
  ServedRobot(const ServedRobot&) = delete;
  ServedRobot& operator=(const ServedRobot&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  pid_t process_ = -1;
  int said_ = -1;  // what it says
  std::uint16_t port_ = 0;
};

}  // namespace fovea::bench
