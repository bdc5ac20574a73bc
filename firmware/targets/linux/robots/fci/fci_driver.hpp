// SPDX-License-Identifier: Apache-2.0
// A Franka Emika Panda, through its control interface, version 5 (hal/drivers/franka).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/host/config/key_table.hpp"
#include "firmware/targets/linux/robots/arm_driver.hpp"
#include "fovea/franka/franka_arm.hpp"

namespace fovea::hw {

class FciDriver final : public ArmDriver {
 public:
  static constexpr const char* kName = "fci5";
  static constexpr const char* kMeaning = "a Franka Emika Panda, through its control interface, version 5";
  static constexpr int kJoints = franka::kJoints;

  struct Settings {
    std::string host = "172.16.0.2";  // the maker's default
    int port = franka::kFciPort;
    bool set_load = true;
    std::string time = "computer";
    double state_timeout_ms = 2.0;
    double torque_step = 1.0;  // [Nm]
  };
  static void AddKeys(Settings& settings, config::KeyTable& keys);
  // Checks that a read of the robot's state ends before the robot counts as lost.
  static void CheckSettings(const HwConfig& config);

  // `config` is borrowed.
  explicit FciDriver(const HwConfig& config);

  [[nodiscard]] hal::Clock* robot_time() noexcept override { return by_robot_ ? &robot_time_ : nullptr; }
  [[nodiscard]] std::string address() const override;
  void Check(const HwConfig& config, const robots::Robot& robot, std::vector<CheckRow>& rows) override;
  hal::Arm& Connect(bool allow_motion) override;
  void Stop() noexcept override;
  void AskRecovery() noexcept override { arm_->AskRecovery(); }
  [[nodiscard]] const char* TakeRecoveryRefusal() noexcept override {
    return arm_ ? arm_->TakeRecoveryRefusal() : nullptr;
  }
  [[nodiscard]] const char* failure() const noexcept override;
  [[nodiscard]] RobotFigures figures() const override;

 private:
  const HwConfig& config_;
  const Settings& settings_;
  const bool by_robot_;
  franka::RobotClock robot_time_;
  std::optional<franka::FrankaArm> arm_;
  std::optional<double> success_rate_;  // at the call of Stop
};

// The configuration of the Franka driver.
franka::FrankaConfig FrankaConfigOf(const HwConfig& config, bool allow_motion);

}  // namespace fovea::hw
