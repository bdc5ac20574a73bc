// What joint velocities may be: a range for each joint, and inequalities across joints.
//
// Every limit on the motion comes down to one of these two forms at a tick: joint velocity, acceleration and
// the end of a joint's range to a range of dq_i; workspace, planes, boxes, field of view and singularity,
// each a quantity h(q) that must not pass a boundary too fast, to a row  (dh/dq) dq <= largest dh/dt.
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
  // What the arm can run into, the singularity; the picture's sides, line of sight, tilt.
  static constexpr int kMaxRows =
      SolidBarriers::kMost + 1 + static_cast<int>(std::tuple_size_v<PictureBarriers>) + 2;

  model::VecN dq_min;  // [num_joints]
  model::VecN dq_max;  // [num_joints]
  int num_rows = 0;
  std::array<LimitRow, kMaxRows> rows;  // a^T dq <= b
  bool complete = true;                 // false: there was no room for a row, and no dq keeps the limits

  // The barrier as a row; nothing where there is nothing to keep.
  void Add(const Barrier& barrier) noexcept;
  void AddRow(const model::VecN& a, double b) noexcept;

  // Whether `dq` [num_joints] keeps all of them. Not finite: no.
  [[nodiscard]] bool KeptBy(const model::VecN& dq) const noexcept;

 private:
  // Null, and no longer complete, when there is no room.
  [[nodiscard]] LimitRow* NewRow() noexcept;
};

// Sets the range of each joint by its velocity limit and, by BarrierSpeed, the end of its range of motion;
// takes all rows away. Real-time: yes.
void LimitJoints(const config::ServoConfig& config, const model::VecN& q, MotionLimits& limits) noexcept;

// Narrows the joints' ranges to what `reference` can reach while its acceleration ramps up at full jerk;
// where that excludes what was allowed, to the end nearest to it. (A shorter time, such as one tick, would
// leave the guard's jerk limit, which aims ahead, nothing to aim at.) Real-time: yes.
void LimitAcceleration(const config::ServoConfig& config, const trajectory::Reference& reference,
                       MotionLimits& limits) noexcept;

// Scales `dq` as a whole until every joint is in its range, so that its direction stays; a joint whose range
// excludes 0 is then put into it on its own. Rows are not looked at. Returns the scale. Real-time: yes.
double ScaleIntoRange(const MotionLimits& limits, model::VecN& dq) noexcept;

}  // namespace fovea::barriers
