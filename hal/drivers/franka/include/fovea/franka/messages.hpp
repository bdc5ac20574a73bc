// SPDX-License-Identifier: Apache-2.0
// The TCP messages of the Franka Control Interface, version 5: a header, then a request's or an answer's
// payload.
#pragma once

#include "fovea/franka/states.hpp"

namespace fovea::franka {

inline constexpr std::uint16_t kVersion = 5;
inline constexpr std::uint16_t kFciPort = 1337;

enum class Command : std::uint32_t {
  kConnect = 0,
  kMove,
  kStopMove,
  kGetCartesianLimit,
  kSetCollisionBehavior,
  kSetJointImpedance,
  kSetCartesianImpedance,
  kSetGuidingMode,
  kSetEEToK,
  kSetNEToEE,
  kSetLoad,
  kSetFilters,
  kAutomaticErrorRecovery,
  kLoadModelLibrary,
};
inline constexpr std::uint32_t kCommands = 14;

// The name of a command, for messages; static storage.
[[nodiscard]] const char* Name(Command command) noexcept;

struct Header {
  Command command{};
  std::uint32_t command_id = 0;
  std::uint32_t size = 0;  // of the whole message, this header included [bytes]

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.command), visit(s.command_id), visit(s.size);
  }
};
inline constexpr std::size_t kHeaderSize = 12;
static_assert(WireSize<Header>() == kHeaderSize);

// Statuses, each the first byte of an answer's payload.
enum class ConnectStatus : std::uint8_t { kSuccess, kIncompatibleVersion };
enum class SetterStatus : std::uint8_t { kSuccess, kNotPossibleNow, kInvalidArgument };
enum class MoveStatus : std::uint8_t {
  kSuccess,
  kMotionStarted,
  kPreempted,
  kNotPossible,
  kStartAtSingularPose,
  kInvalidArgument,
  kReflexAborted,
  kEmergencyAborted,
  kInputErrorAborted,
  kAborted,
};
enum class StopStatus : std::uint8_t { kSuccess, kNotPossible, kEmergencyAborted, kReflexAborted, kAborted };
enum class RecoveryStatus : std::uint8_t {
  kSuccess,
  kNotPossible,
  kManualRecoveryRequired,
  kReflexAborted,
  kEmergencyAborted,
  kAborted,
};
enum class LoadModelStatus : std::uint8_t { kSuccess, kError };

// Values in Move; the state uses other values.
enum class MoveController : std::uint32_t { kJointImpedance, kCartesianImpedance, kExternal };
enum class MoveGenerator : std::uint32_t {
  kJointPosition,
  kJointVelocity,
  kCartesianPosition,
  kCartesianVelocity
};

// A request without payload.
struct Nothing {
  template <typename Self, typename Visit>
  static constexpr void Fields(Self&, Visit&&) {}
};

struct ConnectRequest {
  std::uint16_t version = kVersion;
  std::uint16_t udp_port = 0;

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.version), visit(s.udp_port);
  }
};

struct ConnectAnswer {
  ConnectStatus status = ConnectStatus::kSuccess;
  std::uint16_t version = kVersion;

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.status), visit(s.version);
  }
};

struct MoveRequest {
  MoveController controller = MoveController::kExternal;
  MoveGenerator generator = MoveGenerator::kJointVelocity;
  Vector3 max_path_deviation{10.0, 3.12, 6.28};  // translation [m], rotation [rad], elbow [rad]
  Vector3 max_goal_deviation{10.0, 3.12, 6.28};

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.controller), visit(s.generator), visit(s.max_path_deviation), visit(s.max_goal_deviation);
  }
};

struct GetCartesianLimitRequest {
  std::int32_t id = 0;

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.id);
  }
};

struct GetCartesianLimitAnswer {
  SetterStatus status = SetterStatus::kSuccess;
  Vector3 size{};
  Matrix4 frame = kIdentity4;
  std::uint8_t active = 0;

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.status), visit(s.size), visit(s.frame), visit(s.active);
  }
};

// Above a lower threshold the robot reports a contact, above an upper one a collision. [Nm, N]
struct CollisionBehavior {
  Vector7 lower_torque_acceleration{20, 20, 18, 18, 16, 14, 12};
  Vector7 upper_torque_acceleration{20, 20, 18, 18, 16, 14, 12};
  Vector7 lower_torque_nominal{20, 20, 18, 18, 16, 14, 12};
  Vector7 upper_torque_nominal{20, 20, 18, 18, 16, 14, 12};
  Vector6 lower_force_acceleration{20, 20, 20, 25, 25, 25};
  Vector6 upper_force_acceleration{20, 20, 20, 25, 25, 25};
  Vector6 lower_force_nominal{20, 20, 20, 25, 25, 25};
  Vector6 upper_force_nominal{20, 20, 20, 25, 25, 25};

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.lower_torque_acceleration), visit(s.upper_torque_acceleration);
    visit(s.lower_torque_nominal), visit(s.upper_torque_nominal);
    visit(s.lower_force_acceleration), visit(s.upper_force_acceleration);
    visit(s.lower_force_nominal), visit(s.upper_force_nominal);
  }
};

struct JointImpedance {
  Vector7 K_theta{3000, 3000, 3000, 2500, 2500, 2000, 2000};  // [Nm/rad]

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.K_theta);
  }
};

struct CartesianImpedance {
  Vector6 K_x{2000, 2000, 2000, 200, 200, 200};  // [N/m, Nm/rad]

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.K_x);
  }
};

struct GuidingMode {
  std::array<std::uint8_t, 6> axes{1, 1, 1, 1, 1, 1};
  std::uint8_t nullspace = 1;

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.axes), visit(s.nullspace);
  }
};

// EE_T_K of SetEEToK, NE_T_EE of SetNEToEE.
struct FramePose {
  Matrix4 pose = kIdentity4;

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.pose);
  }
};

struct Load {
  double mass = 0.0;    // [kg]
  Vector3 F_x_Cload{};  // centre of mass in the flange's frame [m]
  Matrix3 I_load{};     // about it [kg m^2]

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.mass), visit(s.F_x_Cload), visit(s.I_load);
  }
};

// Cut-off frequencies of the commands [Hz]; 1000 turns the filter off.
struct Filters {
  double joint_position = 1000.0;
  double joint_velocity = 1000.0;
  double cartesian_position = 1000.0;
  double cartesian_velocity = 1000.0;
  double controller = 1000.0;

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.joint_position), visit(s.joint_velocity), visit(s.cartesian_position),
        visit(s.cartesian_velocity);
    visit(s.controller);
  }
};

struct LoadModelRequest {
  std::uint8_t architecture = 0;  // x64, x86, ARM, ARM64
  std::uint8_t system = 0;        // Linux, Windows

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.architecture), visit(s.system);
  }
};

// An answer that contains only a status.
struct StatusAnswer {
  std::uint8_t status = 0;

  template <typename Self, typename Visit>
  static constexpr void Fields(Self& s, Visit&& visit) {
    visit(s.status);
  }
};

// Length of the request of `command` on the wire [bytes, header included]; 0 for an unknown command.
[[nodiscard]] std::uint32_t RequestSize(Command command) noexcept;

// A whole message: header and payload.
template <typename Payload>
[[nodiscard]] std::array<std::byte, kHeaderSize + WireSize<Payload>()> MakeMessage(
    Command command, std::uint32_t command_id, const Payload& payload) noexcept {
  std::array<std::byte, kHeaderSize + WireSize<Payload>()> bytes;
  Encode(Header{command, command_id, static_cast<std::uint32_t>(bytes.size())}, bytes);
  Encode(payload, std::span(bytes).subspan(kHeaderSize));
  return bytes;
}

}  // namespace fovea::franka
