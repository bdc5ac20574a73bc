// A Franka Emika Panda behind the seam, by its network interface (Franka Control Interface, version 5).
//
// The robot paces the loop: it sends a state each millisecond, and Read waits for it. The first Write that
// does not ask for brakes starts a torque motion; from then on each state is answered once, by Write, or,
// where none came, by the last command again. Brakes end the motion: the robot then holds by itself. So does
// a reflex or a user stop; after that nothing moves until AskRecovery, nor before a Write has asked for
// brakes: who has not, still commands as if its motion went on.
//
// What is sent stays within the torque rate from the answered state's tau_J_d: what the robot applies, not
// what was sent before, so that neither a lost packet nor a new start is a step.
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
  bool allow_motion = true;                      // false: states are read, nothing is ever commanded
  Vector7 torque_step_max{1, 1, 1, 1, 1, 1, 1};  // change of a torque from one state to the next [Nm]
  CollisionBehavior collision;
  Load load;
  Matrix4 NE_T_EE = kIdentity4;
  Matrix4 EE_T_K = kIdentity4;
};

// Of one connection.
struct FrankaCounters {
  std::uint64_t states = 0;             // taken
  std::uint64_t lost_states = 0;        // gaps in their numbers
  std::uint64_t late_states = 0;        // older than one that was taken, and so passed over
  std::uint64_t duplicate_states = 0;   // the same again
  std::uint64_t skipped_states = 0;     // there was a newer one when the loop looked
  std::uint64_t malformed = 0;          // datagrams of another size
  std::uint64_t foreign = 0;            // datagrams from elsewhere
  std::uint64_t commands = 0;           // sent
  std::uint64_t repeated_commands = 0;  // of these, the last one again since the loop wrote none
  std::uint64_t rate_limited = 0;       // of these, with a torque that the rate limit held back
  std::uint64_t send_failures = 0;
  std::uint64_t timeouts = 0;
  std::uint64_t motions = 0;  // started
};

enum class MotionPhase : std::uint8_t {
  kIdle,       // the robot holds by itself
  kStarting,   // a motion is asked for
  kRunning,    // each state is answered
  kFinishing,  // as before: slowed down to rest, then with the word that this is the end
  kFailed,     // the robot broke it off
};

class FrankaArm final : public hal::Arm {
 public:
  // Connects, agrees on the version, sets what `config` says, and waits for the first state. Stamps of states
  // are in CLOCK_MONOTONIC; with `robot_time` they are the robot's own, which that clock then shows.
  // NetworkError with one line that names the robot and what it answered. Real-time: no.
  explicit FrankaArm(const FrankaConfig& config, RobotClock* robot_time = nullptr);
  // As Stop.
  ~FrankaArm();

  // Ends a motion in order, as far as the robot goes along within a second, and closes. Real-time: no.
  void Stop() noexcept;

  // From any thread: the next Read asks the robot to recover from what stopped it. Real-time: yes.
  void AskRecovery() noexcept { recovery_asked_.store(true, std::memory_order_relaxed); }
  // From any thread: why the robot did not recover when it was asked to; each refusal is told once, nullptr
  // where there is none. Static storage. Real-time: yes.
  [[nodiscard]] const char* TakeRecoveryRefusal() noexcept {
    return recovery_refusal_.exchange(nullptr, std::memory_order_relaxed);
  }

  // From the arm's thread, as all that follows. The newest state.
  [[nodiscard]] const RobotState& robot_state() const noexcept { return state_; }
  [[nodiscard]] MotionPhase phase() const noexcept { return phase_; }
  // What broke the last motion off; static storage.
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

  std::string robot_;  // for a person
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
  bool answered_ = true;  // the newest state
  std::int64_t stamp_ns_ = 0;
  std::optional<std::int64_t> robot_offset_ns_;  // from the robot's time to CLOCK_MONOTONIC
  struct {
    int count = 0;
    std::int64_t least_ns = INT64_MAX;  // of their offsets
  } late_states_;                       // in a row, later than that offset allows

  MotionPhase phase_ = MotionPhase::kIdle;
  const char* failure_ = "none";
  const char* recovery_failure_ = nullptr;  // why the last recovery was none
  std::uint32_t move_id_ = 0;
  bool move_started_ = false;                 // the robot said so
  int starting_states_ = 0;                   // since it was asked to
  bool brakes_ = false;                       // wished for
  bool broken_off_ = false;                   // a motion was, and no brakes were wished for since
  int braking_states_ = 0;                    // in which the arm may still be slowed down before the end
  std::optional<std::uint32_t> recovery_id_;  // of a recovery under way
  int stopped_states_borne_ = 0;              // that may still come after a recovery
  std::atomic<bool> recovery_asked_{false};
  std::atomic<const char*> recovery_refusal_{nullptr};  // that nobody took yet
  Vector7 tau_wish_{};
  FrankaCounters counters_;
};

}  // namespace fovea::franka
