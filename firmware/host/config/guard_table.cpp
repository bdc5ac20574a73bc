// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/guard_table.hpp"

#include <fmt/format.h>

#include "firmware/host/config/servo_keys.hpp"

namespace fovea::config {
namespace {

std::string DefaultOf(const KeyTable& keys, const std::string& name) {
  for (const Key& key : keys.keys()) {
    if (key.name == name) {
      return fmt::format("`{}`{}", key.default_text, key.unit.empty() ? "" : " " + key.unit);
    }
  }
  return "the arm's file";
}

}  // namespace

GuardRow RowOf(hal::Limit limit) {
  switch (limit) {
    case hal::Limit::kJointPosition:
      return {"distance of a joint's reference from the end of its range",
              "the other joints take over its part; the joint slows down in time to stop there"};
    case hal::Limit::kJointVelocity:
      return {"speed of a joint's reference", "the motion slows down as a whole and keeps its direction"};
    case hal::Limit::kJointAcceleration:
      return {"acceleration of a joint's reference",
              "all joints are delayed together, so that the motion keeps its direction"};
    case hal::Limit::kJointJerk:
      return {"jerk of a joint's reference",
              "all joints are delayed together, so that the motion keeps its direction"};
    case hal::Limit::kWorkspace:
      return {
          "distance of the end effector from the base, now and on the stopping path",
          "a motion starts only if the arm can stop inside the boundary; the arm slides along the boundary"};
    case hal::Limit::kTorque: return {"torque command of a joint, in every mode", "cut to the range"};
    case hal::Limit::kTorqueRate:
      return {"change of a joint's torque command per tick, in every mode", "cut to the rate"};
    case hal::Limit::kObstacle:
      return {
          "distance of hand, camera and tools (`safety.camera_radius`, `safety.tools`) from planes and "
          "boxes, of links from both (`safety.link_clearance`), of the arm's links from each other "
          "(`safety.self_clearance`), now and on the stopping path",
          "as at the workspace's boundary; an arm that starts inside an obstacle stays in Boot"};
    case hal::Limit::kCartesianSpeed:
      return {"requested speed of the end effector, and its speed on the stopping path",
              "the motion slows down as a whole"};
    case hal::Limit::kRotationSpeed:
      return {"requested angular speed of the end effector, and its angular speed on the stopping path",
              "the motion slows down as a whole"};
    case hal::Limit::kSingularity:
      return {
          "smallest singular value of the hand's Jacobian",
          "the arm moves no nearer to the singularity, except in a joint motion that ends clear of it; this "
          "limit has priority over the task"};
    case hal::Limit::kFieldOfView:
      return {
          "distance of the target from the edge of the picture, less this margin; distance of the arm's "
          "links and of boxes from the lines of sight; tilt of a disc's face (safety.disc_tilt_max)",
          "the approach slows down; the task slides along the boundary"};
  }
  return {"", ""};
}

GuardRow RowOf(hal::Fault fault) {
  constexpr const char* kStop = "Fault: damped stop, then brakes";
  constexpr const char* kBrake = "Fault: the torque fades, then brakes";
  switch (fault) {
    case hal::Fault::kNone: return {"", ""};
    case hal::Fault::kArmLost:
      return {
          "an arm that answers with an error or not at all; the last command stays in force until the fault",
          kBrake};
    case hal::Fault::kArmStale:
      return {
          "an arm whose stamps do not increase; a joint whose reading stays within one encoder step "
          "(`safety.encoder_quantum`) for at least `safety.non_finite_ticks` although its torque, velocity "
          "or reference should have moved it by three steps; a joint whose velocity jumps while its position "
          "stays; a joint whose velocity flickered at rest and whose reading now repeats to the last bit "
          "(`safety.frozen_ticks`)",
          kBrake};
    case hal::Fault::kNonFiniteSensor:
      return {"a joint value that is NaN or infinite; the servo uses the last finite value until the fault",
              kBrake};
    case hal::Fault::kNonFiniteFeature: return {"a measurement that is NaN or infinite", kStop};
    case hal::Fault::kNonFiniteControl:
      return {"a control law's output or a torque that is NaN or infinite", kStop};
    case hal::Fault::kDeadlineMissed: return {"deadlines missed in a row", kStop};
    case hal::Fault::kJointPosition: return {"a joint measured outside its range", kStop};
    case hal::Fault::kJointVelocity:
      return {
          "a joint measured faster than its limit (in Boot, half its limit), or moved between two states by "
          "0.02 rad more than its limit allows; a velocity jump larger than 0.02 rad/s plus twice the "
          "joint's largest acceleration times the time since the last state, if it persists: for "
          "`safety.non_finite_ticks` the servo uses only the change that the motors can make",
          kStop};
    case hal::Fault::kNotFollowing: return {"a joint too far from its reference", kStop};
    case hal::Fault::kContact:
      return {
          "external torque, estimated from the arm's momentum, that is too large, or that changes too much "
          "within "
          "about 0.2 s (`safety.contact_sudden_fraction`)",
          kStop};
  }
  return {"", ""};
}

std::string GuardTableAsMarkdown() {
  ServoSettings settings;
  KeyTable keys;
  AddServoKeys(settings, keys);
  std::string text =
      "# What the servo watches\n\n"
      "Printed by `fovea guards`. A limit shapes the motion and is reported. A fault is latched; only a "
      "reset clears it.\nThe servo rejects measurements that do not fit the target's motion "
      "(`servo.gate_sigma`). Without a measurement it\ncoasts (`servo.stale_s`), then holds "
      "(`servo.coast_s`). The brakes replace a damped stop if the arm gets faster again,\nor decelerates at "
      "less than a third of the expected damping. A commanded motion that the arm does not follow\n"
      "ends in Hold (`safety.motion_error`). `guard_test` provokes each row in closed loop.\n";
  const auto head = [&](const char* title) {
    text +=
        fmt::format("\n## {}\n\n| name | watches | key | default | then |\n|---|---|---|---|---|\n", title);
  };
  const auto row = [&](const char* name, const char* key, const GuardRow& r) {
    const std::string key_text = *key == '\0' ? "-" : fmt::format("`{}`", key);
    text += fmt::format("| `{}` | {} | {} | {} | {} |\n", name, r.watches, key_text,
                        *key == '\0' ? "-" : DefaultOf(keys, key), r.then);
  };
  head("Limits");
  for (int i = 0; i < hal::kNumLimits; ++i) {
    const auto limit = static_cast<hal::Limit>(i);
    row(hal::Name(limit), hal::Key(limit), RowOf(limit));
  }
  head("Faults");
  for (int i = 1; i < hal::kNumFaults; ++i) {
    const auto fault = static_cast<hal::Fault>(i);
    row(hal::Name(fault), hal::Key(fault), RowOf(fault));
  }
  return text;
}

}  // namespace fovea::config
