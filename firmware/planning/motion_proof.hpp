// SPDX-License-Identifier: Apache-2.0
// Proves that a plan stays clear of everything the guard keeps the arm from, and that the guard lets it pass.
//
// Clear: at each tested time every point of the arm may move some distance d before a bound. In the time that
// the fastest points need for d, no bound can be reached; there the next test is. So the whole motion is
// clear by the guard's own margins, not only at the tested times. The picture, the lines of sight and a
// disc's tilt have no such bound. They are tested every kResolution of the fastest joint.
//
// Pass: one tick of the guard (firmware/core/guard/guard_motion.hpp), with its proof that the arm can stop,
// every kGuardStep. The guard has the last word in the tick, too: there it checks every tick.
#pragma once

#include "firmware/core/guard/known_clearances.hpp"
#include "firmware/planning/posture_space.hpp"

namespace fovea::planning {

inline constexpr double kResolution = 0.02;  // [rad]
inline constexpr double kGuardStep = 0.01;   // [s]

// The first time at which the plan is not clear [s]; below 0 if it is clear all along.
[[nodiscard]] double FirstBlocked(const PostureSpace& space, const trajectory::Plan& plan,
                                  Work& work) noexcept;

// Whether no limit of the guard acts on the plan's motion at `t`. `known`: as for guard::LimitsPassed.
[[nodiscard]] bool IsLetPass(const PostureSpace& space, const trajectory::Plan& plan, double t,
                             guard::KnownClearances& known, Work& work) noexcept;

}  // namespace fovea::planning
