// SPDX-License-Identifier: Apache-2.0
// Decorates an arm with faults of its states: encoders, clock, line.
//
// Each state passes through these faults in this order: stuck encoders, noise, NaN, wrong stamp, loss of the
// whole state. Commands pass unchanged.
#pragma once

#include <cstdint>
#include <random>

#include "fovea/hal/arm.hpp"
#include "sim/faults/fault_fields.hpp"

namespace fovea::sim {

struct ArmFaults {
  struct {
    TimeWindow window;
    int joint = 0;  // or kAllJoints. Positions keep their value from the window's start; velocities are 0
  } stuck;
  struct {
    TimeWindow window;
    double position = 1e-3;  // standard deviation for every joint [rad, m]
    double velocity = 0.05;  // [rad/s, m/s]
  } noise;
  struct {
    TimeWindow window;
    int joint = 0;  // its position is NaN
  } not_a_number;
  struct {
    TimeWindow window;
    std::int64_t by_ns = 50'000'000;  // offset of the stamps; negative: back in time
  } clock_jump;
  struct {
    TimeWindow window;
    double share = 1.0;  // share of lost states
  } packet_loss;
  std::uint64_t seed = 1;
};

template <class Visitor, Struct<ArmFaults> Faults>
void Fields(Visitor& v, Faults& f) {
  constexpr const char* kKept = "a Panda handles encoder faults itself";
  v.Window({"encoder_stuck", "s", "an encoder stays at its value"}, f.stuck.window, kKept);
  v.Joint({"encoder_stuck_joint", "", "joint with the stuck encoder, counted from 1; 0: all joints"},
          f.stuck.joint, f.stuck.window, 0);
  v.Window({"encoder_noise", "s", "a burst of noise on all encoders"}, f.noise.window,
           "use arm.encoder_noise, which is constant");
  v.Number({"encoder_noise", "rad", "standard deviation of this noise on positions"}, f.noise.position, 0.0,
           10.0);
  v.Number({"velocity_noise", "rad/s", "standard deviation of this noise on velocities"}, f.noise.velocity,
           0.0, 100.0);
  v.Window({"encoder_nan", "s", "an encoder reports NaN"}, f.not_a_number.window, kKept);
  v.Joint({"encoder_nan_joint", "", "joint whose encoder reports NaN, counted from 1"}, f.not_a_number.joint,
          f.not_a_number.window, 1);
  v.Window({"packet_loss", "s", "states of the arm get lost"}, f.packet_loss.window, "use --loss");
  v.Number({"packet_loss", "", "share of lost states, at random"}, f.packet_loss.share, 0.0, 1.0);
  v.Window({"clock_jump", "s", "the arm's stamps have an offset"}, f.clock_jump.window,
           "the stamps are the robot's own time");
  v.Scaled({"clock_jump_ms", "ms", "offset of the stamps; negative: back in time"}, f.clock_jump.by_ns,
           kNsOfMs, -1e4, 1e4);
}

class FaultyArm final : public hal::Arm {
 public:
  // `arm` is borrowed.
  FaultyArm(hal::Arm& arm, const ArmFaults& faults);

  // Changes the faults from the next state on, except their seed. From the thread that reads the arm.
  void SetFaults(const ArmFaults& faults);

 private:
  hal::Status DoRead(hal::ArmState& state) noexcept override;
  hal::Status DoWrite(const hal::ArmCommand& command) noexcept override { return arm_.Write(command); }
  void Spoil(hal::ArmState& state) noexcept;

  hal::Arm& arm_;
  ArmFaults faults_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0.0, 1.0};
  bool is_stuck_ = false;
  hal::JointArray stuck_at_{};
};

}  // namespace fovea::sim
