// SPDX-License-Identifier: Apache-2.0
// The record of one tick, and the interfaces that receive it.
#pragma once

#include <array>
#include <cstdint>

#include "fovea/hal/arm.hpp"
#include "fovea/hal/events.hpp"
#include "fovea/hal/feature.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::hal {

// A request to change a key in motion, and its answer.
struct TuningNote {
  TuningResult result = TuningResult::kNone;
  std::int32_t key = -1;  // the key's number
  double before = 0.0;    // its value when the request came; 0 for an unknown key
  double asked = 0.0;     // the value that it shall have
};

// How the arm goes to the target, and what it asks of the planner beside the tick.
struct WayNote {
  Way way = Way::kLaw;
  PlanEvent event = PlanEvent::kNone;
  std::int32_t plans_asked = 0;      // so far; one more: a plan is asked for from this tick's reference
  std::int32_t tries = 0;            // of them, since the goal was last reached
  std::int32_t outcome = 0;          // of the last plan that came: trajectory::PlanOutcome
  std::array<double, 3> normal_B{};  // a disc's axis, away from the camera; 0: none is seen
};

// Everything that a person needs to understand one tick. Grouped by the stage that computes it.
struct TickRecord {
  // The tick
  std::uint64_t tick = 0;         // counts from 0
  std::int64_t stamp_ns = 0;      // the time for which the tick computed, in the loop's Clock
  std::int32_t missed_ticks = 0;  // deadlines missed since the tick before

  // Inputs
  ArmState arm;
  bool has_feature = false;       // a measurement was taken in this tick
  FeatureMeasurement feature;     // the last one taken
  Intake intake = Intake::kNone;  // what the servo did with it, in the tick of its arrival

  TuningNote tuning;  // of the request that came in this tick

  // Modes
  Mode mode = Mode::kBoot;
  HoldReason hold_reason = HoldReason::kNone;
  Fault fault = Fault::kNone;
  std::int32_t fault_joint = -1;  // the joint at fault, -1 when none
  LimitSet limits_active = 0;

  // Prediction, frame B
  bool target_known = false;
  std::int64_t feature_age_ns = 0;                 // stamp_ns - stamp of the last accepted measurement
  std::array<double, 3> p_BO{};                    // target's centre [m]
  std::array<double, 4> q_BO{1.0, 0.0, 0.0, 0.0};  // its orientation (w, x, y, z); identity if none is seen
  std::array<double, 3> v_BO{};                    // its velocity [m/s]
  double stamp_late_s = 0.0;                       // pictures seem to be this much older than their stamps
  double stamp_late_sigma_s = 0.0;                 // standard deviation of that

  // Visual law, units as the feature's kind says
  std::int32_t dim = 0;
  std::array<double, kMaxFeatureDim> s{};       // [dim] predicted for now
  std::array<double, kMaxFeatureDim> s_star{};  // [dim] goal
  std::array<double, kMaxFeatureDim> e{};       // [dim] s_star - s
  std::array<double, 6> V_BC_C_cmd{};           // camera's twist from the reference [m/s, rad/s]

  WayNote way;

  // Reference after the guard
  JointArray q_cmd{};
  JointArray dq_cmd{};
  JointArray ddq_cmd{};
  JointArray tau_ext{};  // external torques on the joints, from the momentum of the believed arm [Nm, N]

  // Output
  ArmCommand command;
};

// Takes a copy of each tick. Real-time: Record does not allocate, lock, block or throw; what it cannot
// take is dropped and counted.
class Recorder {
 public:
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  virtual void Record(const TickRecord& record) noexcept = 0;

 protected:
  Recorder() noexcept = default;
  ~Recorder() = default;
};

// Called at the start and end of each tick, by the thread that runs it, to measure time and count heap calls.
// Real-time: yes; it makes its own system calls outside the measured part.
class TickProbe {
 public:
  TickProbe(const TickProbe&) = delete;
  TickProbe& operator=(const TickProbe&) = delete;
  virtual void Enter() noexcept = 0;
  virtual void Leave() noexcept = 0;

 protected:
  TickProbe() noexcept = default;
  ~TickProbe() = default;
};

}  // namespace fovea::hal
