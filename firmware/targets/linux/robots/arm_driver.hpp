// SPDX-License-Identifier: Apache-2.0
// A robot that fovea-hw drives: the functions that the program needs beside hal::Arm.
//
// Each driver is a folder beside this file and a line in arm_drivers.hpp. A class that derives from ArmDriver
// also has, for its entry there:
//
//   static constexpr const char* kName           its name in robot.driver
//   static constexpr const char* kMeaning        for the list of keys
//   static constexpr int kJoints
//   struct Settings                              the values of its keys, in HwConfig
//   static void AddKeys(Settings&, config::KeyTable&)         named robot.<key>
//   static void CheckSettings(const HwConfig&)                InputError when values do not fit together
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "firmware/host/robots/robot.hpp"
#include "fovea/hal/arm.hpp"
#include "fovea/hal/clock.hpp"

namespace fovea::hw {

struct CheckRow;
struct HwConfig;

// The counters of a connection.
struct RobotFigures {
  std::uint64_t states = 0;       // taken
  std::uint64_t lost_states = 0;  // gaps in their numbers
  std::uint64_t commands = 0;     // sent
  // Further counters of the driver, by their names in summary.json.
  std::vector<std::pair<std::string, std::uint64_t>> counters;
  // Of the last commands, reported by the robot; after Stop, of the last commands before it.
  double command_success_rate = 0.0;
};

class ArmDriver {
 public:
  ArmDriver() = default;
  ArmDriver(const ArmDriver&) = delete;
  ArmDriver& operator=(const ArmDriver&) = delete;
  virtual ~ArmDriver() = default;

  // The clock of the robot's stamps, if it is not the computer's; else null.
  [[nodiscard]] virtual hal::Clock* robot_time() noexcept { return nullptr; }
  // The robot's address, for messages.
  [[nodiscard]] virtual std::string address() const = 0;

  // Checks the robot without moving it, and adds rows. Never throws for a missing robot: that is a row. Not
  // while the robot is connected.
  virtual void Check(const HwConfig& config, const robots::Robot& robot, std::vector<CheckRow>& rows) = 0;

  // Call once, from the arm's thread, like all functions below unless stated otherwise. From now on the robot
  // sends its states. Throws, with one line that names the robot and its answer. Real-time: no.
  virtual hal::Arm& Connect(bool allow_motion) = 0;
  // Ends a motion in order, if the robot does so within a second, and closes the connection. Real-time: no.
  virtual void Stop() noexcept = 0;
  // From any thread, once connected: the next Read asks the robot to recover. Real-time: yes.
  virtual void AskRecovery() noexcept = 0;
  // From any thread, once connected: why the robot did not recover on request. Reports each refusal once;
  // nullptr if there is none. Static storage. Real-time: yes.
  [[nodiscard]] virtual const char* TakeRecoveryRefusal() noexcept = 0;
  // Why the motion ended for good; null if it did not. Static storage.
  [[nodiscard]] virtual const char* failure() const noexcept = 0;
  [[nodiscard]] virtual RobotFigures figures() const = 0;
};

}  // namespace fovea::hw
