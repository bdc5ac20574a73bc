// The robot on the network: one client at a time, a state each millisecond, and the two paces.
//
// Real pace: 1 ms by the clock, or by one that is so much slower; what has not come by then is lost.
// Lockstep: at rest the same, in a motion the robot waits for the answer to its state, for as long as a
// client may reasonably take, and then steps at once.
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
  // Of the robot's time against the clock's. In lockstep at most, 0: as fast as its client; at real pace
  // always, 0: as fast as the clock.
  double most_speed = 0.0;
  int late_ms = 0;  // a command may answer a state that is this old
  LinkFaults faults;
  std::uint64_t seed = 1;
  std::vector<std::byte> model_library;  // the file that LoadModelLibrary answers with; empty: there is none
  std::int64_t patience_ns = 2 * hal::kNsPerSecond;  // in lockstep, for the answer to a state
  std::function<void()>
      after_step;  // called by the serving thread after each millisecond of the world; may be empty
};

struct FciServerCounters {
  std::uint64_t clients = 0;
  std::uint64_t refused_clients = 0;  // while another was there
  std::uint64_t states = 0;           // sent, or given to the link that lost them
  std::uint64_t commands = 0;         // applied
  std::uint64_t missing = 0;          // states of a motion that no command was applied to
  std::uint64_t unused = 0;           // commands that came too late, or were overtaken
  std::uint64_t malformed = 0;        // datagrams that are no command
  std::uint64_t overruns = 0;         // steps that began a millisecond or more late
  std::int64_t given_up_ns = 0;       // of the clock's time that the world did not go through
};

class FciServer {
 public:
  // NetworkError when the port is taken.
  FciServer(FciRobot& robot, const FciServerConfig& config);

  // Serves until `stop`. `say` gets a line when a client comes or goes.
  void Run(const std::atomic<bool>& stop, const std::function<void(const std::string&)>& say);

  // From any thread: the stop button is pressed or released.
  void PressStop(bool pressed) { stop_button_.store(pressed, std::memory_order_relaxed); }

  // From any thread: the enabling button at the hand, and a pull at it [N, in axes of B], from now on.
  void PressGuiding(bool pressed) { guiding_button_.store(pressed, std::memory_order_relaxed); }
  void PullHand(const Eigen::Vector3d& force_B) {
    const std::lock_guard lock(hand_mutex_);
    hand_force_B_ = force_B;
  }

  // From any thread: the robot hangs, or goes on: it sends the same state each millisecond, and its time and
  // its arm stand still.
  void Hang(bool hangs) { hangs_.store(hangs, std::memory_order_relaxed); }

  // From any thread: the share of datagrams that the link loses, from now on.
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
  bool state_lost_ = false;  // the newest, by the link
  bool impatient_ = false;   // the client let the patience run out, and has not answered since
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
