// A robot that fovea-hw drives: what the program needs of it beside the seam.
//
// Each driver is a folder beside this file and a line in arm_drivers.hpp. A class that derives from ArmDriver
// also has, for its entry there:
//
//   static constexpr const char* kName           as robot.driver names it
//   static constexpr const char* kMeaning        for the list of keys
//   static constexpr int kJoints
//   struct Settings                              its keys' values, in HwConfig
//   static void AddKeys(Settings&, config::KeyTable&)         named robot.<key>
//   static void CheckSettings(const HwConfig&)                InputError where values do not fit each other
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

// What a connection came to.
struct RobotFigures {
  std::uint64_t states = 0;       // taken
  std::uint64_t lost_states = 0;  // gaps in their numbers
  std::uint64_t commands = 0;     // sent
  // What the driver counts beside these, by its name in summary.json.
  std::vector<std::pair<std::string, std::uint64_t>> counters;
  // Of the last commands, by the robot; of those before Stop, once that was called.
  double command_success_rate = 0.0;
};

class ArmDriver {
 public:
  ArmDriver() = default;
  ArmDriver(const ArmDriver&) = delete;
  ArmDriver& operator=(const ArmDriver&) = delete;
  virtual ~ArmDriver() = default;

  // The clock that the robot's stamps are in, where that is not the computer's; else null.
  [[nodiscard]] virtual hal::Clock* robot_time() noexcept { return nullptr; }
  // Where the robot is, for a person.
  [[nodiscard]] virtual std::string address() const = 0;

  // Looks at the robot, which is not moved, and adds what it found. Never throws for a robot that is not
  // there: that is a row. Not while it is connected.
  virtual void Check(const HwConfig& config, const robots::Robot& robot, std::vector<CheckRow>& rows) = 0;

  // Once, from the arm's thread, like all that follows where nothing else is said. From now on the robot
  // sends its states. Throws, with one line that names the robot and what it answered. Real-time: no.
  virtual hal::Arm& Connect(bool allow_motion) = 0;
  // Ends a motion in order, as far as the robot goes along within a second, and closes. Real-time: no.
  virtual void Stop() noexcept = 0;
  // From any thread, once connected: the next Read asks the robot to recover. Real-time: yes.
  virtual void AskRecovery() noexcept = 0;
  // From any thread, once connected: why the robot did not recover when it was asked to; each refusal is told
  // once, nullptr where there is none. Static storage. Real-time: yes.
  [[nodiscard]] virtual const char* TakeRecoveryRefusal() noexcept = 0;
  // What broke the motion off for good; null where nothing did. Static storage.
  [[nodiscard]] virtual const char* failure() const noexcept = 0;
  [[nodiscard]] virtual RobotFigures figures() const = 0;
};

}  // namespace fovea::hw
