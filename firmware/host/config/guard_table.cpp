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
      return {"a joint's reference before the end of its range",
              "the others take its part over; it slows down in time to stop there"};
    case hal::Limit::kJointVelocity:
      return {"speed of a joint's reference", "the motion slows down as a whole and keeps its direction"};
    case hal::Limit::kJointAcceleration:
      return {"acceleration of a joint's reference", "that joint's reference follows later"};
    case hal::Limit::kJointJerk:
      return {"jerk of a joint's reference", "that joint's reference follows later"};
    case hal::Limit::kWorkspace:
      return {"distance of the end effector from the base, in the tick and on the way of a stop",
              "only what can still be stopped inside is begun; along the boundary it slides"};
    case hal::Limit::kTorque: return {"torque command of a joint, in every mode", "cut to the range"};
    case hal::Limit::kTorqueRate:
      return {"change of a joint's torque command per tick, in every mode", "cut to the rate"};
    case hal::Limit::kObstacle:
      return {
          "hand, camera and tools (`safety.camera_radius`, `safety.tools`) before planes and boxes, links "
          "before planes (`safety.link_clearance`), the arm's links before each other "
          "(`safety.self_clearance`), in the tick and on the way of a stop",
          "as at the workspace's boundary; an arm that stands inside when it starts stays in Boot"};
    case hal::Limit::kCartesianSpeed:
      return {"speed of the end effector, as it is wished and on the way of a stop",
              "the motion slows down as a whole"};
    case hal::Limit::kRotationSpeed:
      return {"speed at which the end effector turns, as it is wished and on the way of a stop",
              "the motion slows down as a whole"};
    case hal::Limit::kSingularity:
      return {
          "smallest singular value of the hand's Jacobian",
          "the posture goes no deeper, but for a motion of the joints that ends clear of it; the task gives "
          "way"};
    case hal::Limit::kFieldOfView:
      return {
          "the target before the edge of the picture, less this margin; the arm's links beside the lines "
          "of sight; a disc's face (safety.disc_tilt_max)",
          "only so fast towards it; the task slides along"};
  }
  return {"", ""};
}

GuardRow RowOf(hal::Fault fault) {
  constexpr const char* kStop = "Fault: damped stop, then brakes";
  constexpr const char* kBrake = "Fault: the torque fades, then brakes";
  switch (fault) {
    case hal::Fault::kNone: return {"", ""};
    case hal::Fault::kArmLost:
      return {"an arm that answers with an error or not at all; until then the last command stays", kBrake};
    case hal::Fault::kArmStale:
      return {
          "an arm whose stamps stand still or go back; for `safety.non_finite_ticks` and more, a joint whose "
          "reading "
          "stays within a step of its encoder (`safety.encoder_quantum`) although torque, or its velocity, "
          "should have moved it by three; one whose velocity jumps, and that stays where it is; one whose "
          "velocity has flickered, and that repeats itself "
          "to the last bit (`safety.frozen_ticks`)",
          kBrake};
    case hal::Fault::kNonFiniteSensor:
      return {"a joint value that is no number; until then the last one that was", kBrake};
    case hal::Fault::kNonFiniteFeature: return {"a measurement that is no number", kStop};
    case hal::Fault::kNonFiniteControl: return {"a law or a torque that is no number", kStop};
    case hal::Fault::kDeadlineMissed: return {"deadlines missed in a row", kStop};
    case hal::Fault::kJointPosition: return {"a joint measured outside its range", kStop};
    case hal::Fault::kJointVelocity:
      return {
          "a joint measured faster than it may be, or 0.02 rad further than that allows from one state to "
          "the next; in Boot, faster than half of that; a velocity that goes on to differ from the last by "
          "0.02 rad/s beyond what twice the joint's largest acceleration makes: for "
          "`safety.non_finite_ticks` it counts only as far as motors can",
          kStop};
    case hal::Fault::kNotFollowing: return {"a joint too far from its reference", kStop};
    case hal::Fault::kContact: return {"torque from outside, by the arm's momentum", kStop};
  }
  return {"", ""};
}

std::string GuardTableAsMarkdown() {
  ServoSettings settings;
  KeyTable keys;
  AddServoKeys(settings, keys);
  std::string text =
      "# What the servo watches\n\n"
      "Printed by `fovea guards`. A limit shapes the motion and is reported; a fault is latched, and left by "
      "a reset "
      "alone.\nMeasurements that do not fit the target's motion are left out (`servo.gate_sigma`); without "
      "one the "
      "servo coasts\n(`servo.stale_s`), then holds (`servo.coast_s`). A damped stop in which the arm gets "
      "faster "
      "again, or slower\nby less than a third of what the damping should do, is given up for the brakes. A "
      "commanded "
      "motion that the arm does\nnot follow ends in Hold (`safety.motion_error`). Each row is provoked in "
      "closed loop by `guard_test`.\n";
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
