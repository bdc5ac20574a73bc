// An arm whose states go wrong on the way to the servo: encoders, the stamps' clock, the line.
//
// The states of the arm behind it are spoiled in this order: one joint's encoder or all stand still, noise, a
// value that is no number, stamps that are off; then the state as a whole may be lost. Commands pass as they
// are.
#pragma once

#include <cstdint>
#include <random>

#include "fovea/hal/arm.hpp"
#include "sim/faults/fault_fields.hpp"

namespace fovea::sim {

struct ArmFaults {
  struct {
    TimeWindow window;
    int joint = 0;  // or kAllJoints: positions stay what they were when the window began, velocities are 0
  } stuck;
  struct {
    TimeWindow window;
    double position = 1e-3;  // standard deviation, on every joint [rad, m]
    double velocity = 0.05;  // [rad/s, m/s]
  } noise;
  struct {
    TimeWindow window;
    int joint = 0;  // its position is not a number
  } not_a_number;
  struct {
    TimeWindow window;
    std::int64_t by_ns = 50'000'000;  // the stamps are off by this; below 0 they go back
  } clock_jump;
  struct {
    TimeWindow window;
    double share = 1.0;  // of the states that do not come
  } packet_loss;
  std::uint64_t seed = 1;
};

template <class Visitor, Struct<ArmFaults> Faults>
void Fields(Visitor& v, Faults& f) {
  constexpr const char* kKept = "a Panda keeps its encoders' faults";
  v.Window({"encoder_stuck", "s", "an encoder stays at its value from the first time to the second"},
           f.stuck.window, kKept);
  v.Joint({"encoder_stuck_joint", "", "which joint's, counted from 1; 0: all of them"}, f.stuck.joint,
          f.stuck.window, 0);
  v.Window({"encoder_noise", "s", "a burst of noise on all encoders"}, f.noise.window,
           "arm.encoder_noise has a lasting one");
  v.Number({"encoder_noise", "rad", "its standard deviation on positions"}, f.noise.position, 0.0, 10.0);
  v.Number({"velocity_noise", "rad/s", "and on velocities"}, f.noise.velocity, 0.0, 100.0);
  v.Window({"encoder_nan", "s", "an encoder gives a value that is no number"}, f.not_a_number.window, kKept);
  v.Joint({"encoder_nan_joint", "", "which joint's, counted from 1"}, f.not_a_number.joint,
          f.not_a_number.window, 1);
  v.Window({"packet_loss", "s", "states of the arm get lost"}, f.packet_loss.window, "--loss loses packets");
  v.Number({"packet_loss", "", "share of them, by chance"}, f.packet_loss.share, 0.0, 1.0);
  v.Window({"clock_jump", "s", "the arm's stamps are off"}, f.clock_jump.window,
           "stamps are the robot's own time");
  v.Scaled({"clock_jump_ms", "ms", "by so much; below 0 they go back"}, f.clock_jump.by_ns, kNsOfMs, -1e4,
           1e4);
}

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
