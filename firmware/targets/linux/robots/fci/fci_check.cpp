// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/robots/fci/fci_check.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/core/model/kinematics.hpp"
#include "firmware/targets/linux/check_robot.hpp"
#include "firmware/targets/linux/gravity_check.hpp"
#include "firmware/targets/linux/hw_config.hpp"
#include "firmware/targets/linux/robots/fci/fci_driver.hpp"
#include "fovea/franka/panda_limits.hpp"

namespace fovea::hw {
namespace {

using Rows = std::vector<CheckRow>;

constexpr int kStates = 1000;  // states of the robot that are read, at least
constexpr double kFlangeWarnMm = 1.0;
constexpr double kFlangeFailMm = 5.0;
constexpr double kFlangeWarnDeg = 0.1;
constexpr double kFlangeFailDeg = 0.5;
constexpr double kMmPerM = 1e3;

// The limits of the servo's arm model may be inside the robot's, never outside.
CheckRow CheckLimits(const HwConfig& config, const robots::Robot& robot) {
  struct Limit {
    const char* what;
    double given;
    double robot;
    double sign;  // 1: at most the robot's; -1: at least
  };
  constexpr double kRounding = 1e-6;
  const auto broken = [](const Limit& limit) {
    return limit.sign * (limit.given - limit.robot) > kRounding * std::max(1.0, std::fabs(limit.robot));
  };
  for (std::size_t k = 0; k < franka::kPandaJoints.size(); ++k) {
    const model::Joint& joint = robot.model.joints[k];
    const franka::PandaJoint& own = franka::kPandaJoints[k];
    for (const Limit& limit : {Limit{"least angle [rad]", joint.q_min, own.q_min, -1.0},
                               {"largest angle [rad]", joint.q_max, own.q_max, 1.0},
                               {"velocity [rad/s]", joint.dq_max, own.dq_max, 1.0},
                               {"acceleration [rad/s^2]", joint.ddq_max, own.ddq_max, 1.0},
                               {"jerk [rad/s^3]", joint.dddq_max, own.dddq_max, 1.0},
                               {"torque [Nm]", joint.tau_max, own.tau_max, 1.0},
                               {"torque rate [Nm/s]", joint.dtau_max, franka::kPandaTorqueRate, 1.0}}) {
      if (broken(limit)) {
        return {"limits", Verdict::kFail,
                fmt::format("joint {}'s {}: {:.6g} in arm.model, {:.6g} of the robot", k + 1, limit.what,
                            limit.given, limit.robot),
                "bring the arm file's and the URDF's limits inside the robot's"};
      }
    }
  }
  if (const double speed = config.robot.speed_scale * config.servo.config.guard.cartesian_speed;
      broken({"", speed, franka::kPandaHandSpeed, 1.0})) {
    return {"limits", Verdict::kFail,
            fmt::format("the hand's speed: {:.6g} m/s allowed, {:.6g} of the robot", speed,
                        franka::kPandaHandSpeed),
            "set safety.cartesian_speed below the robot's"};
  }
  if (const double speed = config.robot.speed_scale * config.servo.config.guard.rotation_speed;
      broken({"", speed, franka::kPandaHandRotation, 1.0})) {
    return {"limits", Verdict::kFail,
            fmt::format("the hand's rotation: {:.6g} rad/s allowed, {:.6g} of the robot", speed,
                        franka::kPandaHandRotation),
            "set safety.rotation_speed below the robot's"};
  }
  return {"limits", Verdict::kPass, "ranges, speeds, torques and their rates are inside the robot's", ""};
}

// Compares the flange's pose that the robot reports with the model's.
CheckRow CheckKinematics(const robots::Robot& robot, const hal::ArmState& state,
                         const franka::RobotState& said) {
  const auto pose = [](const franka::Matrix4& m) {
    const Eigen::Map<const Eigen::Matrix4d> T(m.data());
    return model::Pose{T.topLeftCorner<3, 3>(), T.topRightCorner<3, 1>()};
  };
  model::ArmPoses poses;
  model::ComputePoses(robot.model, model::ToVector(state.q, franka::kJoints), poses);
  const model::Pose off = poses.X_BE.Inverse() * pose(said.O_T_EE) * pose(said.F_T_EE).Inverse();
  const double mm = kMmPerM * off.p.norm();
  const double deg = Eigen::AngleAxisd(off.R).angle() * 180.0 / std::numbers::pi;
  const bool fits = mm < kFlangeWarnMm && deg < kFlangeWarnDeg;
  return {"kinematics",
          fits                                         ? Verdict::kPass
          : mm < kFlangeFailMm && deg < kFlangeFailDeg ? Verdict::kWarn
                                                       : Verdict::kFail,
          fmt::format("the flange is {:.2f} mm and {:.3f} deg off the model's", mm, deg),
          fits ? "" : "check that arm.model is this robot, with its tip at the flange"};
}

void CheckStates(const HwConfig& config, const robots::Robot& robot, Rows& rows) {
  franka::FrankaArm arm(FrankaConfigOf(config, /*allow_motion=*/false));
  rows.push_back({"robot", Verdict::kPass, "speaks version 5 of the interface", ""});
  hal::ArmState state;
  bool has_state = false;
  RestMean mean = MakeRestMean(config);
  bool rests = false;
  hal::Status status;
  const int reads = std::max(kStates, 2 * mean.states());
  for (int k = 0; k < reads; ++k) {
    status = arm.Read(state);
    has_state = has_state || status.ok();
    rests = rests || (status.ok() && mean.Add(state));
    if (!status.ok() && status.code() != hal::StatusCode::kTimeout) {
      rows.push_back({"robot's mode", Verdict::kFail, status.where(),
                      "release the stop, clear the error, switch to external control"});
      return;
    }
  }
  const franka::FrankaCounters& c = arm.counters();
  const std::uint64_t lost = c.lost_states + c.timeouts;
  const bool ready = has_state && arm.robot_state().robot_mode == franka::RobotMode::kIdle;
  rows.push_back({"robot's mode", ready ? Verdict::kPass : Verdict::kFail, ready ? "idle" : "not idle",
                  ready ? "" : "switch it to external control, and end other programs that move it"});
  rows.push_back({"states",
                  lost == 0 ? Verdict::kPass : (lost < kStates / 100 ? Verdict::kWarn : Verdict::kFail),
                  fmt::format("{} came, {} lost or late", c.states, lost),
                  lost == 0 ? "" : "use a direct cable to the robot, without a switch or other traffic"});
  if (has_state) {
    rows.push_back(CheckRange(robot, state, config.servo.config.guard.joint_position_margin));
    rows.push_back(CheckKinematics(robot, state, arm.robot_state()));
    rows.push_back(CheckGravity(robot, mean, rests, config.check.gravity_torque));
  }
}

}  // namespace

void CheckFciRobot(const HwConfig& config, const robots::Robot& robot, Rows& rows) {
  rows.push_back(CheckLimits(config, robot));
  try {
    CheckStates(config, robot, rows);
  } catch (const franka::NetworkError& error) {
    rows.push_back(
        {"robot", Verdict::kFail, error.what(), "check robot.host, robot.port and the network cable"});
  }
}

}  // namespace fovea::hw
