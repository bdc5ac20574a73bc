// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/swing.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/control/camera_pull.hpp"
#include "firmware/core/control/count_tick.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::control {
namespace {

constexpr double kNearGoal = 0.03;  // distance from the goal [m]
constexpr double kAtRest = 0.05;    // speed of a disc that the arm need not follow [m/s]
constexpr double kWorthM = 3e-4;    // distance of the two centres [m]
constexpr double kRate = 0.15;      // of the line of sight [rad/s]
constexpr double kStartS = 0.3;     // until this rate
constexpr double kMost = 0.4;       // of Swing::angle; the poses differ after about 0.08 rad
constexpr double kBarredS = 0.2;    // until it turns back

// The part of the normal across the line of sight.
model::Vec3 Across(const SwungDisc& disc) noexcept {
  const model::Vec3 ray = disc.p_CO / disc.p_CO.norm();
  return disc.normal_C - disc.normal_C.dot(ray) * ray;
}

}  // namespace

bool IsWorthASwing(const SwungDisc& disc, const Swing& swing) noexcept {
  if (!((disc.p_CO - disc.p_CO_star).norm() < kNearGoal) || !(disc.v_BO.norm() < kAtRest)) {
    return false;
  }
  const double sine = Across(disc).norm();
  const double cosine = std::sqrt(std::max(1.0 - sine * sine, 0.0));
  const double apart = 2.0 * disc.radius * disc.radius / disc.p_CO.norm() * sine * cosine;
  return swing.angle < kMost && apart > kWorthM;
}

void AddSwing(const SwungDisc& disc, Swing& swing, MotionTask& task) noexcept {
  swing.pace = std::min(swing.pace + hal::kTickPeriodS / kStartS, 1.0);
  const double rate = kRate * swing.pace;
  const model::Vec3 across = Across(disc);
  const model::Vec3 w_C = (rate / across.norm()) * across;
  model::Vec6 V_BC_C;  // the disc's centre stays where it is in the picture
  V_BC_C.head<3>() = model::Cross(disc.p_CO, w_C);
  V_BC_C.tail<3>() = w_C;
  const model::VecN dq = CameraPull(disc.J_C).transpose().lazyProduct(V_BC_C);
  CountTick(disc.limits != 0, swing.barred_ns);
  if (swing.side == 0.0) {
    swing.side = task.dq_0.dot(dq) < 0.0 ? -1.0 : 1.0;
  } else if (static_cast<double>(swing.barred_ns) > kBarredS * static_cast<double>(hal::kNsPerSecond)) {
    swing.side = -swing.side;
    swing.barred_ns = 0;
  }
  task.dq_0 += swing.side * dq;
  swing.angle += rate * hal::kTickPeriodS;
}

}  // namespace fovea::control
