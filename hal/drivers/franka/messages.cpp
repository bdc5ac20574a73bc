// SPDX-License-Identifier: Apache-2.0
#include "fovea/franka/messages.hpp"

#include "fovea/franka/errors.hpp"

namespace fovea::franka {
namespace {

constexpr std::array<const char*, kErrors> kErrorNames{
    "joint_position_limits_violation",
    "cartesian_position_limits_violation",
    "self_collision_avoidance_violation",
    "joint_velocity_violation",
    "cartesian_velocity_violation",
    "force_control_safety_violation",
    "joint_reflex",
    "cartesian_reflex",
    "max_goal_pose_deviation_violation",
    "max_path_pose_deviation_violation",
    "cartesian_velocity_profile_safety_violation",
    "joint_position_motion_generator_start_pose_invalid",
    "joint_motion_generator_position_limits_violation",
    "joint_motion_generator_velocity_limits_violation",
    "joint_motion_generator_velocity_discontinuity",
    "joint_motion_generator_acceleration_discontinuity",
    "cartesian_position_motion_generator_start_pose_invalid",
    "cartesian_motion_generator_elbow_limit_violation",
    "cartesian_motion_generator_velocity_limits_violation",
    "cartesian_motion_generator_velocity_discontinuity",
    "cartesian_motion_generator_acceleration_discontinuity",
    "cartesian_motion_generator_elbow_sign_inconsistent",
    "cartesian_motion_generator_start_elbow_invalid",
    "force_controller_desired_force_tolerance_violation",
    "start_elbow_sign_inconsistent",
    "communication_constraints_violation",
    "power_limit_violation",
    "cartesian_motion_generator_joint_position_limits_violation",
    "cartesian_motion_generator_joint_velocity_limits_violation",
    "cartesian_motion_generator_joint_velocity_discontinuity",
    "cartesian_motion_generator_joint_acceleration_discontinuity",
    "cartesian_position_motion_generator_invalid_frame",
    "controller_torque_discontinuity",
    "joint_p2p_insufficient_torque_for_planning",
    "tau_j_range_violation",
    "instability_detection",
    "joint_move_in_wrong_direction",
    "cartesian_spline_violation",
    "joint_via_plan_limit_violation",
    "base_acceleration_initialization_timeout",
    "base_acceleration_invalid_reading",
};

struct CommandEntry {
  const char* name;
  std::size_t request_size;  // of the payload
};

constexpr std::array<CommandEntry, kCommands> kCommandTable{{
    {"Connect", WireSize<ConnectRequest>()},
    {"Move", WireSize<MoveRequest>()},
    {"StopMove", WireSize<Nothing>()},
    {"GetCartesianLimit", WireSize<GetCartesianLimitRequest>()},
    {"SetCollisionBehavior", WireSize<CollisionBehavior>()},
    {"SetJointImpedance", WireSize<JointImpedance>()},
    {"SetCartesianImpedance", WireSize<CartesianImpedance>()},
    {"SetGuidingMode", WireSize<GuidingMode>()},
    {"SetEEToK", WireSize<FramePose>()},
    {"SetNEToEE", WireSize<FramePose>()},
    {"SetLoad", WireSize<Load>()},
    {"SetFilters", WireSize<Filters>()},
    {"AutomaticErrorRecovery", WireSize<Nothing>()},
    {"LoadModelLibrary", WireSize<LoadModelRequest>()},
}};

}  // namespace

const char* Name(Command command) noexcept {
  const auto k = static_cast<std::size_t>(command);
  return k < kCommandTable.size() ? kCommandTable[k].name : "unknown";
}

std::uint32_t RequestSize(Command command) noexcept {
  const auto k = static_cast<std::size_t>(command);
  return k < kCommandTable.size() ? static_cast<std::uint32_t>(kHeaderSize + kCommandTable[k].request_size)
                                  : 0;
}

const char* Name(Error error) noexcept {
  const auto k = static_cast<std::size_t>(error);
  return k < kErrorNames.size() ? kErrorNames[k] : "none";
}

const char* FirstError(const ErrorFlags& flags) noexcept {
  for (std::size_t k = 0; k < flags.size(); ++k) {
    if (flags[k] != 0) {
      return kErrorNames[k];
    }
  }
  return "none";
}

}  // namespace fovea::franka
