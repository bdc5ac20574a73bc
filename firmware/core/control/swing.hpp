// SPDX-License-Identifier: Apache-2.0
// Swings the camera about a disc whose two poses are not yet told apart.
//
// One picture of a disc has two poses, and their centres are up to some millimetres apart. Views from other
// directions tell which of them is true (estimate/disc_fit.hpp). A camera that only turned, or moved along
// its line of sight, has no such views, and would stop at the wrong centre in half of these cases. So near
// its goal it swings slowly about the disc's centre. The feature leaves that free: in the picture the disc
// stays where it is. It swings out of the plane of the two normals, so that the disc's tilt changes least.
#pragma once

#include <cstdint>

#include "firmware/core/control/resolve_damped.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::control {

struct Swing {
  double angle = 0.0;          // of the line of sight in both directions together, since Track began [rad]
  double pace = 0.0;           // 0 to 1: it begins smoothly
  double side = 0.0;           // 1 or -1; 0: not chosen yet
  std::int64_t barred_ns = 0;  // time with active limits less time without
};

struct SwungDisc {
  double radius = 0.0;       // [m]
  model::Vec3 p_CO;          // [m]
  model::Vec3 p_CO_star;     // its goal [m]
  model::Vec3 v_BO;          // [m/s]
  model::Vec3 normal_C;      // of the believed pose
  const model::Mat6N& J_C;   // [6 x num_joints]
  hal::LimitSet limits = 0;  // that may bar the way, active in the previous tick
};

// True near the goal of a disc at rest whose two poses have centres so far apart that a swing is worth it.
// Real-time: yes.
[[nodiscard]] bool IsWorthASwing(const SwungDisc& disc, const Swing& swing) noexcept;

// Adds one tick of the swing to the wish `dq_0` of the law's task. It goes to the side that the wish prefers,
// and turns back if limits bar it. Real-time: yes.
void AddSwing(const SwungDisc& disc, Swing& swing, MotionTask& task) noexcept;

}  // namespace fovea::control
