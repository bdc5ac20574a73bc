// SPDX-License-Identifier: Apache-2.0
// Limits of the joint velocities: a range for each joint, and inequalities across joints.
//
// In each tick every motion limit takes one of these two forms. Joint velocity, acceleration and the end of a
// joint's range give a range of dq_i. Each barrier h(q), such as workspace, planes, boxes, field of view and
// singularity, gives a row -(dh/dq) dq <= largest -dh/dt.
#pragma once

#include <array>
#include <tuple>

#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/barriers/field_of_view_barrier.hpp"
#include "firmware/core/barriers/solid_barriers.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/trajectory/reference.hpp"

namespace fovea::barriers {

struct LimitRow {
  model::VecN a;  // [num_joints]
  double b = 0.0;
  hal::Limit name = hal::Limit::kWorkspace;
};

struct MotionLimits {
  // Solid barriers, the singularity; the picture's sides, line of sight, tilt.
  static constexpr int kMaxRows =
      SolidBarriers::kMost + 1 + static_cast<int>(std::tuple_size_v<PictureBarriers>) + 2;

  model::VecN dq_min;  // [num_joints]
  model::VecN dq_max;  // [num_joints]
  int num_rows = 0;
  std::array<LimitRow, kMaxRows> rows;  // a^T dq <= b
  bool complete = true;                 // false: a row did not fit; then KeptBy is false for every dq

  // Adds the barrier as a row; nothing if it is inactive.
  void Add(const Barrier& barrier) noexcept;
  void AddRow(const model::VecN& a, double b) noexcept;

  // Whether `dq` [num_joints] keeps all limits; false if it is not finite.
  [[nodiscard]] bool KeptBy(const model::VecN& dq) const noexcept;

 private:
  // Null if there is no room; `complete` is then false.
  [[nodiscard]] LimitRow* NewRow() noexcept;
};

// Sets each joint's range from its velocity limit and, with BarrierSpeed, from its distance to the ends of
// its range of motion. Removes all rows. Real-time: yes.
void LimitJoints(const config::ServoConfig& config, const model::VecN& q, MotionLimits& limits) noexcept;

// Narrows the joints' ranges to the velocities that `reference` can reach while its acceleration ramps up at
// full jerk. If the two ranges do not overlap, the nearest end of the old range remains. (One tick would be
// too short: the guard's jerk limit plans ahead and needs a target further away.) Real-time: yes.
void LimitAcceleration(const config::ServoConfig& config, const trajectory::Reference& reference,
                       MotionLimits& limits) noexcept;

// Scales `dq` as a whole until every joint is in its range, which keeps its direction. Then moves each joint
// whose range excludes 0 into its range. Ignores the rows. Returns the scale. Real-time: yes.
double ScaleIntoRange(const MotionLimits& limits, model::VecN& dq) noexcept;

}  // namespace fovea::barriers
