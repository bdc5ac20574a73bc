// SPDX-License-Identifier: Apache-2.0
// A Franka Emika Panda behind the seam, by its network interface (Franka Control Interface, version 5).
//
// The robot paces the loop: it sends a state each millisecond, and Read waits for it. The first Write without
// brakes starts a torque motion. From then on each state is answered once: by Write or, without one, by the
// last command again. Brakes end the motion; the robot then holds by itself. A reflex or a user stop ends it
// too. After that nothing moves until AskRecovery and a Write with brakes: a caller that has not yet
// requested the brakes still commands as if the motion continued.
//
// Commands stay within the torque rate of the answered state's tau_J_d, which the robot applies, and of the
// commands sent since (TorqueRate). So neither a lost packet nor a new start causes a step.
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "fovea/franka/errors.hpp"
#include "fovea/franka/message_stream.hpp"
#include "fovea/franka/robot_clock.hpp"
#include "fovea/franka/torque_rate.hpp"
#include "fovea/hal/arm.hpp"

namespace fovea::franka {

struct FrankaConfig {
  std::string host;
  std::uint16_t port = kFciPort;
  int answer_timeout_ms = 2000;  // for each step of the set-up
  std::int64_t state_timeout_ns = 2 * hal::kTickPeriodNs;
  bool allow_motion = true;                      // false: reads states and never commands
  Vector7 torque_step_max{1, 1, 1, 1, 1, 1, 1};  // change of a torque from one state to the next [Nm]
  CollisionBehavior collision;
  Load load;
  Matrix4 NE_T_EE = kIdentity4;
  Matrix4 EE_T_K = kIdentity4;
};

// Counters of one connection.
struct FrankaCounters {
  std::uint64_t states = 0;             // taken
  std::uint64_t lost_states = 0;        // gaps in their numbers
  std::uint64_t late_states = 0;        // older than a state taken before; skipped
  std::uint64_t duplicate_states = 0;   // with the number of the last state
  std::uint64_t skipped_states = 0;     // taken, but replaced by a newer one in the same Read
  std::uint64_t malformed = 0;          // datagrams of the wrong size or with an impossible time
  std::uint64_t foreign = 0;            // datagrams from other addresses
  std::uint64_t commands = 0;           // sent
  std::uint64_t repeated_commands = 0;  // of these, repetitions because the loop wrote none
  std::uint64_t rate_limited = 0;       // of these, with a torque changed by the rate limit
  std::uint64_t send_failures = 0;
  std::uint64_t timeouts = 0;
  std::uint64_t motions = 0;  // started
};

enum class MotionPhase : std::uint8_t {
  kIdle,       // the robot holds by itself
  kStarting,   // a motion is requested
  kRunning,    // each state is answered
  kFinishing,  // each state is answered: by braking to rest, then by the end of the motion
  kFailed,     // the robot aborted the motion
};

class FrankaArm final : public hal::Arm {
 public:
  // Connects, agrees on the version, applies `config`, and waits for the first state. Stamps of states are in
  // CLOCK_MONOTONIC; with `robot_time` they are in the robot's own time, which that clock then shows.
  // NetworkError: one line with the robot and the cause. Real-time: no.
  explicit FrankaArm(const FrankaConfig& config, RobotClock* robot_time = nullptr);
  // Calls Stop.
  ~FrankaArm();

  // Ends a motion in order, waits at most a second for it, and closes the connection. Real-time: no.
  void Stop() noexcept;

  // From any thread: the next Read asks the robot to recover from what stopped it. Real-time: yes.
  void AskRecovery() noexcept { recovery_asked_.store(true, std::memory_order_relaxed); }
  // From any thread: why the robot refused to recover. Returns each refusal once, and nullptr if there is
  // none. Static storage. Real-time: yes.
  [[nodiscard]] const char* TakeRecoveryRefusal() noexcept {
    return recovery_refusal_.exchange(nullptr, std::memory_order_relaxed);
  }

  // The newest state. From the arm's thread, like all functions below.
  [[nodiscard]] const RobotState& robot_state() const noexcept { return state_; }
  [[nodiscard]] MotionPhase phase() const noexcept { return phase_; }
  // Why the last motion was aborted; static storage.
  [[nodiscard]] const char* failure() const noexcept { return failure_; }
  [[nodiscard]] const FrankaCounters& counters() const noexcept { return counters_; }

 private:
  hal::Status DoRead(hal::ArmState& state) noexcept override;
  hal::Status DoWrite(const hal::ArmCommand& command) noexcept override;

  void SetUp(const FrankaConfig& config);
  template <typename Payload, typename Answer>
  Answer Request(Command command, const Payload& payload);
  template <typename Payload>
  void Set(Command command, const Payload& payload);

  // Sends a request whose answer TakeAnswers or Request finds by `command_id`.
  template <typename Payload>
  [[nodiscard]] bool Post(Command command, const Payload& payload, std::uint32_t& command_id) noexcept {
    command_id = next_command_id_++;
    return PostBytes(MakeMessage(command, command_id, payload));
  }
  [[nodiscard]] bool PostBytes(std::span<const std::byte> message) noexcept;
  void TakeAnswers() noexcept;
  void TakeAnswer(const Header& header, std::span<const std::byte> payload) noexcept;
  [[nodiscard]] bool TakeStates() noexcept;
  void FollowPhase() noexcept;
  void Fail(const char* why) noexcept;
  void StartMotion() noexcept;
  void Recover() noexcept;
  void Answer(bool repeated) noexcept;
  [[nodiscard]] std::int64_t StampOf(std::uint64_t message_id, std::int64_t arrival_ns) noexcept;
  void Fill(hal::ArmState& state) const noexcept;

  std::string robot_;  // its name in messages
  int answer_timeout_ms_;
  std::int64_t state_timeout_ns_;
  bool allow_motion_;
  TorqueRate torque_rate_;
  RobotClock* robot_time_;

  TcpConnection tcp_;
  UdpSocket udp_;
  MessageStream stream_;
  Endpoint robot_tcp_;
  Endpoint robot_udp_;  // where the newest state came from
  std::uint32_t next_command_id_ = 0;

  RobotState state_;
  bool has_state_ = false;
  bool silent_ = false;   // the last read brought no state
  bool answered_ = true;  // the newest state
  std::int64_t stamp_ns_ = 0;
  std::optional<std::int64_t> robot_offset_ns_;  // from the robot's time to CLOCK_MONOTONIC
  struct {
    int count = 0;
    std::int64_t least_ns = INT64_MAX;  // least of their offsets
  } late_states_;                       // in a row, later than robot_offset_ns_ allows

  MotionPhase phase_ = MotionPhase::kIdle;
  const char* failure_ = "none";
  const char* recovery_failure_ = nullptr;  // why the last recovery failed
  std::uint32_t move_id_ = 0;
  bool move_started_ = false;                 // the robot confirmed it
  int starting_states_ = 0;                   // since the request
  bool brakes_ = false;                       // requested by the last Write
  bool broken_off_ = false;                   // a motion was aborted, and no brakes were requested since
  int braking_states_ = 0;                    // left to slow the arm down before the motion's end
  std::optional<std::uint32_t> recovery_id_;  // of a recovery in progress
  int stopped_states_borne_ = 0;              // that are still ignored after a recovery
  std::atomic<bool> recovery_asked_{false};
  std::atomic<const char*> recovery_refusal_{nullptr};  // not taken yet
  Vector7 tau_wish_{};
  FrankaCounters counters_;
};

}  // namespace fovea::franka
