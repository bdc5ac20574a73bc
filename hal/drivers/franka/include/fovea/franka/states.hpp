// SPDX-License-Identifier: Apache-2.0
// The two datagrams of the Franka Control Interface, version 5: RobotState down, RobotCommand up.
//
// Field names are the interface's own. f64 matrices are column-major; SI and radians; _d desired, _c
// commanded. O base, EE end effector, F flange, NE nominal end effector, K stiffness frame.
#pragma once

#include "fovea/franka/wire.hpp"

namespace fovea::franka {

inline constexpr int kJoints = 7;
inline constexpr std::size_t kErrors = 41;

using Vector2 = std::array<double, 2>;
using Vector3 = std::array<double, 3>;
using Vector6 = std::array<double, 6>;
using Vector7 = std::array<double, 7>;
using Matrix3 = std::array<double, 9>;
using Matrix4 = std::array<double, 16>;
using ErrorFlags = std::array<std::uint8_t, kErrors>;

inline constexpr Matrix4 kIdentity4{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

// Values in a state; Move uses other values (see messages.hpp).
enum class MotionGeneratorMode : std::uint8_t {
  kIdle,
  kJointPosition,
  kJointVelocity,
  kCartesianPosition,
  kCartesianVelocity,
};
enum class ControllerMode : std::uint8_t { kJointImpedance, kCartesianImpedance, kExternal, kOther };
enum class RobotMode : std::uint8_t {
  kOther,
  kIdle,
  kMove,
  kGuiding,
  kReflex,
  kUserStopped,
  kAutomaticErrorRecovery,
};

struct RobotState {
  std::uint64_t message_id = 0;  // the robot's time [ms]
  Matrix4 O_T_EE{};
  Matrix4 O_T_EE_d{};
  Matrix4 F_T_EE{};
  Matrix4 EE_T_K{};
  Matrix4 F_T_NE{};
  Matrix4 NE_T_EE{};
  double m_ee = 0.0;
  Matrix3 I_ee{};
  Vector3 F_x_Cee{};
  double m_load = 0.0;
  Matrix3 I_load{};
  Vector3 F_x_Cload{};
  Vector2 elbow{};  // angle of joint 3, sign of joint 4
  Vector2 elbow_d{};
  Vector7 tau_J{};    // measured, gravity included
  Vector7 tau_J_d{};  // in force, gravity excluded
  Vector7 dtau_J{};
  Vector7 q{};
  Vector7 q_d{};
  Vector7 dq{};
  Vector7 dq_d{};
  Vector7 ddq_d{};
  Vector7 joint_contact{};
  Vector6 cartesian_contact{};
  Vector7 joint_collision{};
  Vector6 cartesian_collision{};
  Vector7 tau_ext_hat_filtered{};
  Vector6 O_F_ext_hat_K{};
  Vector6 K_F_ext_hat_K{};
  Vector6 O_dP_EE_d{};
  Vector3 O_ddP_O{};
  Vector2 elbow_c{};
  Vector2 delbow_c{};
  Vector2 ddelbow_c{};
  Matrix4 O_T_EE_c{};
  Vector6 O_dP_EE_c{};
  Vector6 O_ddP_EE_c{};
  Vector7 theta{};
  Vector7 dtheta{};
  MotionGeneratorMode motion_generator_mode = MotionGeneratorMode::kIdle;
  ControllerMode controller_mode = ControllerMode::kOther;
  ErrorFlags errors{};
  ErrorFlags reflex_reason{};
  RobotMode robot_mode = RobotMode::kOther;
  double control_command_success_rate = 0.0;  // over the last 100 states

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.message_id), visit(s.O_T_EE), visit(s.O_T_EE_d), visit(s.F_T_EE), visit(s.EE_T_K),
        visit(s.F_T_NE);
    visit(s.NE_T_EE), visit(s.m_ee), visit(s.I_ee), visit(s.F_x_Cee), visit(s.m_load), visit(s.I_load);
    visit(s.F_x_Cload), visit(s.elbow), visit(s.elbow_d), visit(s.tau_J), visit(s.tau_J_d), visit(s.dtau_J);
    visit(s.q), visit(s.q_d), visit(s.dq), visit(s.dq_d), visit(s.ddq_d), visit(s.joint_contact);
    visit(s.cartesian_contact), visit(s.joint_collision), visit(s.cartesian_collision);
    visit(s.tau_ext_hat_filtered), visit(s.O_F_ext_hat_K), visit(s.K_F_ext_hat_K), visit(s.O_dP_EE_d);
    visit(s.O_ddP_O), visit(s.elbow_c), visit(s.delbow_c), visit(s.ddelbow_c), visit(s.O_T_EE_c);
    visit(s.O_dP_EE_c), visit(s.O_ddP_EE_c), visit(s.theta), visit(s.dtheta), visit(s.motion_generator_mode);
    visit(s.controller_mode), visit(s.errors), visit(s.reflex_reason), visit(s.robot_mode);
    visit(s.control_command_success_rate);
  }
};

struct RobotCommand {
  std::uint64_t message_id = 0;  // of the state that it answers
  Vector7 q_c{};
  Vector7 dq_c{};
  Matrix4 O_T_EE_c = kIdentity4;
  Vector6 O_dP_EE_c{};
  Vector2 elbow_c{};
  std::uint8_t valid_elbow = 0;
  std::uint8_t motion_generation_finished = 0;
  Vector7 tau_J_d{};  // gravity and motor friction excluded

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.message_id), visit(s.q_c), visit(s.dq_c), visit(s.O_T_EE_c), visit(s.O_dP_EE_c), visit(s.elbow_c);
    visit(s.valid_elbow), visit(s.motion_generation_finished), visit(s.tau_J_d);
  }
};

inline constexpr std::size_t kStateSize = 2373;
inline constexpr std::size_t kCommandSize = 370;
static_assert(WireSize<RobotState>() == kStateSize);
static_assert(WireSize<RobotCommand>() == kCommandSize);

}  // namespace fovea::franka
