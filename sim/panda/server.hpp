// SPDX-License-Identifier: Apache-2.0
// The robot on the network: one client at a time, one state per millisecond, two paces.
//
// Real pace: steps of 1 ms by the clock, scaled by `most_speed`. A command that arrives later is missing.
// Lockstep: at rest as real pace. In a motion, the robot waits for the answer to its state, at most
// `patience_ns`, and then steps at once.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "sim/faults/link_faults.hpp"
#include "sim/panda/command_intake.hpp"
#include "sim/panda/session.hpp"

namespace fovea::sim {

struct FciServerConfig {
  franka::Endpoint at{0x7F000001, franka::kFciPort};  // loopback
  bool lockstep = false;
  // Speed of the robot's time relative to the clock. In lockstep an upper limit; 0: as fast as the client. At
  // real pace the speed itself; 0: as fast as the clock.
  double most_speed = 0.0;
  int late_ms = 0;  // largest age of the state that a command answers
  LinkFaults faults;
  std::uint64_t seed = 1;
  std::vector<std::byte> model_library;              // file sent on LoadModelLibrary; empty: none
  std::int64_t patience_ns = 2 * hal::kNsPerSecond;  // in lockstep: longest wait for the answer to a state
  std::function<void()>
      after_step;  // called by the serving thread after each millisecond of the world; may be empty
};

struct FciServerCounters {
  std::uint64_t clients = 0;
  std::uint64_t refused_clients = 0;  // because another client was connected
  std::uint64_t states = 0;           // sent, including those that the link loses
  std::uint64_t commands = 0;         // applied
  std::uint64_t missing = 0;          // states of a motion without an applied command
  std::uint64_t unused = 0;           // commands that came too late or were overtaken
  std::uint64_t malformed = 0;        // datagrams that are no command
  std::uint64_t overruns = 0;         // steps that began a millisecond or more late
  std::int64_t given_up_ns = 0;       // clock time that the world skipped
};

class FciServer {
 public:
  // NetworkError: the port is in use.
  FciServer(FciRobot& robot, const FciServerConfig& config);

  // Serves until `stop`. Calls `say` with a line for each event, e.g. a new client.
  void Run(const std::atomic<bool>& stop, const std::function<void(const std::string&)>& say);

  // Presses or releases the stop button. Any thread may call it.
  void PressStop(bool pressed) { stop_button_.store(pressed, std::memory_order_relaxed); }

  // The enabling button at the hand, and a lasting pull at it [N, in axes of B]. Any thread may call them.
  void PressGuiding(bool pressed) { guiding_button_.store(pressed, std::memory_order_relaxed); }
  void PullHand(const Eigen::Vector3d& force_B) {
    const std::lock_guard lock(hand_mutex_);
    hand_force_B_ = force_B;
  }

  // Makes the robot hang: it sends the same state each millisecond; its time and its arm stand still. False:
  // it continues. Any thread may call it.
  void Hang(bool hangs) { hangs_.store(hangs, std::memory_order_relaxed); }

  // Sets the share of datagrams that the link loses from now on. Any thread may call it.
  void SetLoss(double share) { loss_.store(share, std::memory_order_relaxed); }

  [[nodiscard]] std::uint16_t port() const { return listener_.port(); }
  [[nodiscard]] const FciServerCounters& counters() const { return counters_; }

 private:
  void TakeHandInput();
  void Tick();
  void AwaitCommands();
  void AwaitTick();
  void ServeUntil(std::int64_t time_ns);
  void Poll(std::int64_t until_ns);
  void AcceptClient();
  void TakeDatagrams();
  void SendState();
  void FlushStates();
  void EndSession();
  [[nodiscard]] bool WaitsForAnswer() const;
  [[nodiscard]] std::int64_t LinkNowNs() const;
  [[nodiscard]] double ClockSpeed() const;

  FciRobot& robot_;
  FciServerConfig config_;
  franka::TcpListener listener_;
  franka::UdpSocket udp_;
  std::optional<FciSession> session_;
  CommandIntake intake_;
  FaultyLink<franka::RobotCommand> commands_;
  FaultyLink<franka::RobotState> states_;
  FaultDice state_dice_;
  std::atomic<double> loss_;
  std::function<void(const std::string&)> say_;
  std::int64_t next_tick_ns_ = 0;
  bool state_lost_ = false;  // the link lost the newest state
  bool impatient_ = false;   // the client exceeded patience_ns and has not answered since
  std::uint64_t newest_answered_ = 0;
  std::atomic<bool> stop_button_{false};
  bool stop_pressed_ = false;
  std::atomic<bool> hangs_{false};
  std::atomic<bool> guiding_button_{false};
  bool guiding_pressed_ = false;
  std::mutex hand_mutex_;
  Eigen::Vector3d hand_force_B_ = Eigen::Vector3d::Zero();  // guarded by hand_mutex_
  FciServerCounters counters_;
};

}  // namespace fovea::sim
