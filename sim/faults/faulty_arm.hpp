// An arm whose states go wrong on the way to the servo: encoders, the stamps' clock, the line.
//
// The states of the arm behind it are spoiled in this order: one joint's encoder or all stand still, noise, a
// value that is no number, stamps that are off; then the state as a whole may be lost. Commands pass as they
// are.
#pragma once

#include <cstdint>
#include <random>

#include "fovea/hal/arm.hpp"
#include "sim/faults/time_window.hpp"

namespace fovea::sim {

inline constexpr int kAllJoints = -1;

struct ArmFaults {
  struct {
    TimeWindow window;
    int joint = 0;  // or kAllJoints: positions stay what they were when the window began, velocities are 0
  } stuck;
  struct {
    TimeWindow window;
    double position = 0.0;  // standard deviation, on every joint [rad, m]
    double velocity = 0.0;  // [rad/s, m/s]
  } noise;
  struct {
    TimeWindow window;
    int joint = 0;  // its position is not a number
  } not_a_number;
  struct {
    TimeWindow window;
    std::int64_t by_ns = 0;  // the stamps are off by this; below 0 they go back
  } clock_jump;
  struct {
    TimeWindow window;
    double share = 1.0;  // of the states that do not come
  } packet_loss;
  std::uint64_t seed = 1;
};

class FaultyArm final : public hal::Arm {
 public:
  // `arm` is borrowed.
  FaultyArm(hal::Arm& arm, const ArmFaults& faults);

 private:
  hal::Status DoRead(hal::ArmState& state) noexcept override;
  hal::Status DoWrite(const hal::ArmCommand& command) noexcept override { return arm_.Write(command); }
  void Spoil(hal::ArmState& state) noexcept;

  hal::Arm& arm_;
  const ArmFaults faults_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0.0, 1.0};
  bool is_stuck_ = false;
  hal::JointArray stuck_at_{};
};

}  // namespace fovea::sim
