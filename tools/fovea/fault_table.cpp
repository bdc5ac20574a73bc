#include "fault_table.hpp"

#include <fmt/format.h>

namespace fovea::matrix {
namespace {

// Lines of 640 x 480 pixels; the goal stands in their middle. Windows of a second are longer than
// servo.coast_s, those of a tenth shorter than servo.stale_s. Joint 2 carries the whole arm, joint 4 turns
// most.
const std::vector<Fault>& Table() {
  static const std::vector<Fault> table{
      {"frame loss",
       "frame_loss",
       true,
       {{{1.0, {"frame_loss=0.3"}, "30 % of frames, 1 s", "a busy network"},
         {1.0, {"frame_loss=0.7"}, "70 % of frames, 1 s", "gaps beyond servo.stale_s"},
         {1.0, {"frame_loss=1"}, "all frames, 1 s", "longer than servo.coast_s"}}}},
      {"freeze",
       "freeze",
       true,
       {{{0.1, {}, "0.1 s", "three frames: an outlier each, the fourth would be believed"},
         {0.3, {}, "0.3 s", "nine frames: the filter starts anew on them"},
         {1.0, {}, "1 s", "the hand runs after what it carries along"}}}},
      {"latency spike",
       "latency",
       true,
       {{{1.0, {"latency_ms=30"}, "30 ms more, 1 s", "a frame's period"},
         {1.0, {"latency_ms=100"}, "100 ms more, 1 s", "near servo.stale_s"},
         {1.0, {"latency_ms=300"}, "300 ms more, 1 s", "beyond servo.stale_s"}}}},
      {"occluder",
       "occluder",
       true,
       {{{1.0, {"occluder_px=[320, 240, 20, 480]"}, "a bar of 20 px, 1 s", "a cable: the outline is there"},
         {1.0, {"occluder_px=[160, 240, 320, 480]"}, "half the picture, 1 s", "an arm of a person"},
         {1.0,
          {"occluder_px=[320, 240, 640, 480]"},
          "the whole picture, 1 s",
          "longer than servo.coast_s"}}}},
      {"glare",
       "glare",
       true,
       {{{1.0, {"glare_px=[320, 240, 20]"}, "radius 20 px, 1 s", "within the ball's picture"},
         {1.0, {"glare_px=[320, 240, 60]"}, "radius 60 px, 1 s", "as large as the ball's picture"},
         {1.0, {"glare_px=[320, 240, 300]"}, "radius 300 px, 1 s", "nearly the whole picture"}}}},
      {"wrong detection",
       "wrong_detection",
       true,
       {{{1.0,
          {"wrong_detection=0.1", "wrong_detection_shift=[1, 0, 0]"},
          "10 % one radius aside, 1 s",
          "outliers, one by one"},
         {1.0,
          {"wrong_detection=0.5", "wrong_detection_shift=[1, 0, 0]"},
          "half of them one radius aside, 1 s",
          "now and then more in a row than servo.gate_rejects_max"},
         {1.0,
          {"wrong_detection=1", "wrong_detection_shift=[3, -2, 2]"},
          "all, four radii off, 1 s",
          "another thing taken for the target"}}}},
      {"encoder stuck",
       "encoder_stuck",
       false,
       {{{0.02,
          {"encoder_stuck_joint=4"},
          "joint 4, 20 ms",
          "as many ticks as safety.arm_lost_ticks bridges"},
         {0.2, {"encoder_stuck_joint=4"}, "joint 4, 0.2 s", "five time constants of the inner loop"},
         {1.0, {"encoder_stuck_joint=2"}, "joint 2, 1 s", "the joint that carries most"}}}},
      {"encoder noise",
       "encoder_noise",
       false,
       {{{1.0,
          {"encoder_noise=1e-4", "velocity_noise=0.005"},
          "1e-4 rad, 5e-3 rad/s, 1 s",
          "ten times the arm's own"},
         {1.0, {"encoder_noise=1e-3", "velocity_noise=0.05"}, "1e-3 rad, 0.05 rad/s, 1 s", "a hundred times"},
         {1.0,
          {"encoder_noise=1e-2", "velocity_noise=0.5"},
          "1e-2 rad, 0.5 rad/s, 1 s",
          "a thousand times"}}}},
      {"torque loss",
       "torque_loss",
       false,
       {{{1.0, {"torque_loss_joint=2", "torque_loss=0.1"}, "joint 2, a tenth, 1 s", "a warm motor"},
         {1.0,
          {"torque_loss_joint=2", "torque_loss=0.5"},
          "joint 2, half, 1 s",
          "less than gravity asks for"},
         {1.0,
          {"torque_loss_joint=2", "torque_loss=1"},
          "joint 2, all, 1 s",
          "a dead motor: the arm falls"}}}},
      {"packet loss",
       "packet_loss",
       false,
       {{{1.0, {"packet_loss=0.1"}, "10 % of states, 1 s", "a bad line"},
         {1.0, {"packet_loss=0.5"}, "half of the states, 1 s", "gaps of some ticks"},
         {0.1, {"packet_loss=1"}, "all states, 0.1 s", "longer than safety.arm_lost_ticks"}}}},
      {"clock jump",
       "clock_jump",
       false,
       {{{0.5, {"clock_jump_ms=5"}, "5 ms on, after 0.5 s back", "less than a frame"},
         {0.5, {"clock_jump_ms=15"}, "15 ms on, after 0.5 s back", "less than safety.arm_lost_ticks"},
         {0.5, {"clock_jump_ms=50"}, "50 ms on, after 0.5 s back", "more than safety.arm_lost_ticks"}}}},
      {"load change",
       "load",
       false,
       {{{1.0, {"load_mass=0.5"}, "0.5 kg, 1 s", "a tool"},
         {1.0, {"load_mass=1.5"}, "1.5 kg, 1 s", "half of what a Panda carries"},
         {1.0, {"load_mass=3"}, "3 kg, 1 s", "all that a Panda carries"}}}}};
  return table;
}

}  // namespace

std::span<const Fault> Faults() { return Table(); }

std::string Window(const std::string& key, double from_s, double to_s) {
  return fmt::format("faults.{}_s=[{:.3f}, {:.3f}]", key, from_s, to_s);
}

std::vector<std::string> AssignmentsOf(const Fault& fault, const FaultLevel& level, double onset_s) {
  std::vector<std::string> assignments{Window(fault.key, onset_s, onset_s + level.lasts_s)};
  for (const std::string& setting : level.settings) {
    assignments.push_back("faults." + setting);
  }
  return assignments;
}

}  // namespace fovea::matrix
