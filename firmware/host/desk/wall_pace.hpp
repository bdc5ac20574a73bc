// SPDX-License-Identifier: Apache-2.0
// Paces virtual time to the wall clock as an operator sets it: speed, pause, single ticks.
//
// A simulation that is slower than its pace falls behind. The time that it lost is not made up for: otherwise
// the arm would suddenly move in fast motion.
#pragma once

#include <cstdint>
#include <deque>

namespace fovea::desk {

class WallPace {
 public:
  // Time by which the run may be behind before it gives up that time.
  static constexpr std::int64_t kMostBehindNs = 100'000'000;
  static constexpr double kSlowest = 0.1;
  static constexpr double kFree = 0.0;  // speed without a limit
  static constexpr std::int64_t kPaused = INT64_MAX;

  // `speed`: virtual time per wall time, kSlowest to 1, or kFree.
  explicit WallPace(double speed) : speed_(speed) {}

  void SetSpeed(double speed);
  void Pause();
  void Resume();
  // While paused: permits `ticks` [>= 1] more, by the wall clock.
  void Step(int ticks) { steps_ += ticks; }

  // Time to wait before the tick at virtual time `next_ns` may begin, at wall time `wall_ns`; 0 or less: it
  // may begin now. kPaused: not before Resume or Step. Call it again after each wait.
  [[nodiscard]] std::int64_t WaitNs(std::int64_t next_ns, std::int64_t wall_ns);
  // Tells that this tick begins.
  void Begin(std::int64_t next_ns, std::int64_t wall_ns);

  [[nodiscard]] double speed() const { return speed_; }
  [[nodiscard]] bool paused() const { return paused_ && steps_ == 0; }
  // Virtual time per wall time over the last half second of motion; 0 while paused or before it is known.
  [[nodiscard]] double achieved() const;

 private:
  struct Instant {
    std::int64_t virtual_ns;
    std::int64_t wall_ns;
  };

  double speed_;
  bool paused_ = false;
  int steps_ = 0;
  bool anchored_ = false;
  Instant anchor_{};            // a time at which the run was on its pace
  std::deque<Instant> recent_;  // ticks of the last half second, a few per second
};

}  // namespace fovea::desk
