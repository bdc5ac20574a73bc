// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/faults/table.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace fovea::matrix {
namespace {

// Pictures of 640 x 480 pixels, with the goal in the centre. A window of 1 s is longer than servo.coast_s,
// one of 0.1 s shorter than servo.stale_s. Joint 2 carries the whole arm, joint 4 turns most.
const std::vector<Fault>& Table() {
  static const std::vector<Fault> table{
      {"frame loss",
       "frame_loss",
       "frame_loss",
       true,
       {{1.0, {"frame_loss=0.3"}, "30 % of frames, 1 s", "a busy network"},
        {1.0, {"frame_loss=0.7"}, "70 % of frames, 1 s", "gaps beyond servo.stale_s"},
        {1.0, {"frame_loss=1"}, "all frames, 1 s", "longer than servo.coast_s"}}},
      {"freeze",
       "freeze",
       "freeze",
       true,
       {{0.2, {}, "0.2 s", "six frames: more than servo.gate_rejects_max"},
        {1.0, {}, "1 s", "the target seems to move with the hand"},
        {5.0, {}, "5 s", "long enough for the arm to run away"},
        {kForever, {}, "for ever", "a camera that hangs"}}},
      {"freeze, equal pixels",
       "freeze_pixels",
       "freeze",
       true,
       {{0.2, {"freeze_pixels=true"}, "0.2 s", "six frames: more than servo.gate_rejects_max"},
        {1.0, {"freeze_pixels=true"}, "1 s", "the target seems to move with the hand"},
        {5.0, {"freeze_pixels=true"}, "5 s", "long enough for the arm to run away"},
        {kForever, {"freeze_pixels=true"}, "for ever", "a buffer that is sent again and again"}}},
      {"replay",
       "replay",
       "replay",
       true,
       {{1.0, {"replay_delay_s=0.2"}, "picture of 0.2 s ago, 1 s", "a queue of frames"},
        {1.0, {"replay_delay_s=1"}, "picture of 1 s ago, 1 s", "longer than the prediction of the target"},
        {5.0, {"replay_delay_s=1"}, "picture of 1 s ago, 5 s", "long enough to oscillate"},
        {kForever, {"replay_delay_s=1"}, "picture of 1 s ago, for ever", "a film instead of a camera"}}},
      {"mirror",
       "mirror",
       "mirror",
       true,
       {{0.2, {}, "0.2 s", "six frames: more than servo.gate_rejects_max"},
        {1.0, {}, "1 s", "the target moves the wrong way"},
        {5.0, {}, "5 s", "long enough for the arm to run away"},
        {kForever, {}, "for ever", "a wrong setting of the camera"}}},
      {"stamps",
       "stamp",
       "stamp",
       true,
       {{3.0, {"stamp_ms=8"}, "8 ms too young, 3 s", "more than the exposure's start instead of its middle"},
        {3.0, {"stamp_ms=20"}, "20 ms too young, 3 s", "half of camera.latency_ms"},
        {3.0, {"stamp_ms=-60"}, "60 ms too old, 3 s", "older than servo.stale_s on arrival"}}},
      {"latency spike",
       "latency",
       "latency",
       true,
       {{1.0, {"latency_ms=30"}, "30 ms more, 1 s", "a frame's period"},
        {1.0, {"latency_ms=100"}, "100 ms more, 1 s", "near servo.stale_s"},
        {1.0, {"latency_ms=300"}, "300 ms more, 1 s", "beyond servo.stale_s"}}},
      {"occluder",
       "occluder",
       "occluder",
       true,
       {{1.0,
         {"occluder_px=[320, 240, 20, 480]"},
         "a bar of 20 px, 1 s",
         "a cable: the outline stays visible"},
        {1.0, {"occluder_px=[160, 240, 320, 480]"}, "half the picture, 1 s", "a person's arm"},
        {1.0, {"occluder_px=[320, 240, 640, 480]"}, "the whole picture, 1 s", "longer than servo.coast_s"}}},
      {"glare",
       "glare",
       "glare",
       true,
       {{1.0, {"glare_px=[320, 240, 20]"}, "radius 20 px, 1 s", "within the ball's picture"},
        {1.0, {"glare_px=[320, 240, 60]"}, "radius 60 px, 1 s", "as large as the ball's picture"},
        {1.0, {"glare_px=[320, 240, 300]"}, "radius 300 px, 1 s", "nearly the whole picture"}}},
      {"wrong detection",
       "wrong_detection",
       "wrong_detection",
       true,
       {{1.0,
         {"wrong_detection=0.1", "wrong_detection_shift=[1, 0, 0]"},
         "10 % one radius off, 1 s",
         "outliers, one by one"},
        {1.0,
         {"wrong_detection=0.5", "wrong_detection_shift=[1, 0, 0]"},
         "half of them one radius off, 1 s",
         "at times more in a row than servo.gate_rejects_max"},
        {1.0,
         {"wrong_detection=1", "wrong_detection_shift=[3, -2, 2]"},
         "all, four radii off, 1 s",
         "another object detected as the target"}}},
      {"encoder stuck",
       "encoder_stuck",
       "encoder_stuck",
       false,
       {{0.02, {"encoder_stuck_joint=4"}, "joint 4, 20 ms", "as many ticks as safety.arm_lost_ticks bridges"},
        {0.2, {"encoder_stuck_joint=4"}, "joint 4, 0.2 s", "five time constants of the inner loop"},
        {1.0, {"encoder_stuck_joint=2"}, "joint 2, 1 s", "the joint with the largest load"}}},
      {"encoder noise",
       "encoder_noise",
       "encoder_noise",
       false,
       {{1.0,
         {"encoder_noise=1e-4", "velocity_noise=0.005"},
         "1e-4 rad, 5e-3 rad/s, 1 s",
         "ten times the arm's own noise"},
        {1.0, {"encoder_noise=1e-3", "velocity_noise=0.05"}, "1e-3 rad, 0.05 rad/s, 1 s", "a hundred times"},
        {1.0, {"encoder_noise=1e-2", "velocity_noise=0.5"}, "1e-2 rad, 0.5 rad/s, 1 s", "a thousand times"}}},
      {"torque loss",
       "torque_loss",
       "torque_loss",
       false,
       {{1.0, {"torque_loss_joint=2", "torque_loss=0.1"}, "joint 2, a tenth, 1 s", "a warm motor"},
        {1.0,
         {"torque_loss_joint=2", "torque_loss=0.5"},
         "joint 2, half, 1 s",
         "less torque than gravity needs"},
        {1.0, {"torque_loss_joint=2", "torque_loss=1"}, "joint 2, all, 1 s", "a dead motor: the arm falls"}}},
      {"packet loss",
       "packet_loss",
       "packet_loss",
       false,
       {{1.0, {"packet_loss=0.1"}, "10 % of states, 1 s", "a bad line"},
        {1.0, {"packet_loss=0.5"}, "half of the states, 1 s", "gaps of several ticks"},
        {0.1, {"packet_loss=1"}, "all states, 0.1 s", "longer than safety.arm_lost_ticks"}}},
      {"clock jump",
       "clock_jump",
       "clock_jump",
       false,
       {{0.5, {"clock_jump_ms=5"}, "5 ms forward, back after 0.5 s", "less than a frame"},
        {0.5, {"clock_jump_ms=15"}, "15 ms forward, back after 0.5 s", "less than safety.arm_lost_ticks"},
        {0.5, {"clock_jump_ms=50"}, "50 ms forward, back after 0.5 s", "more than safety.arm_lost_ticks"}}},
      {"load change",
       "load",
       "load",
       false,
       {{1.0, {"load_mass=0.5"}, "0.5 kg, 1 s", "a tool"},
        {1.0, {"load_mass=1.5"}, "1.5 kg, 1 s", "half of a Panda's payload"},
        {1.0, {"load_mass=3"}, "3 kg, 1 s", "a Panda's payload"}}},
      {"all encoders stuck",
       "encoders_stuck",
       "encoder_stuck",
       false,
       {{0.02,
         {"encoder_stuck_joint=0"},
         "all joints, 20 ms",
         "as many ticks as safety.arm_lost_ticks bridges"},
        {0.2, {"encoder_stuck_joint=0"}, "all joints, 0.2 s", "five time constants of the inner loop"},
        {1.0, {"encoder_stuck_joint=0"}, "all joints, 1 s", "long enough for the arm to run away"},
        {kForever, {"encoder_stuck_joint=0"}, "all joints, for ever", "a connection that repeats a state"}}},
      {"load from the start",
       "load_from_start",
       "load",
       false,
       {{kForever, {"load_mass=0.3"}, "0.3 kg", "a tool that is not in the model"},
        {kForever, {"load_mass=0.7"}, "0.7 kg", "a gripper"},
        {kForever, {"load_mass=1.5"}, "1.5 kg", "half of a Panda's payload"}},
       true},
      {"gravity",
       "gravity",
       "gravity",
       false,
       {{kForever, {"gravity_tilt_deg=1"}, "base tilted by 1 deg", "a bench that is not levelled"},
        {kForever, {"gravity_tilt_deg=5"}, "base tilted by 5 deg", "a bench on a slope"},
        {kForever, {"gravity_tilt_deg=30"}, "base tilted by 30 deg", "another mounting than configured"}},
       true},
      {"planner loss",
       "planner_loss",
       "planner_loss",
       true,
       {{0.2, {}, "0.2 s", "a busy computer: the plan comes late"},
        {3.0, {}, "3 s", "longer than the servo waits for a plan"},
        {kForever, {}, "for ever", "a planner that has died"}}}};
  return table;
}

}  // namespace

std::span<const Fault> Faults() { return Table(); }

const Fault& FaultOf(const std::string& id) {
  for (const Fault& fault : Table()) {
    if (id == fault.id) {
      return fault;
    }
  }
  throw std::out_of_range("no fault " + id);
}

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
