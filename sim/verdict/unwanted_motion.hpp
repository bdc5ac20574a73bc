// SPDX-License-Identifier: Apache-2.0
// Measures how far and how fast the hand moves while the arm must stand still (Boot, Hold, Fault), by the
// simulator's truth, from the start of each mode.
//
// Hold and Fault may start in motion. A stop then needs some distance: at most the stop's time times the
// initial speed. The initial speed includes the gain until the acceleration is reversed. Distance and speed
// beyond that are reported separately.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "fovea/hal/events.hpp"
#include "sim/verdict/summary.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// Limits of the servo's stops.
struct StopRules {
  Eigen::VectorXd ddq_max;     // in Hold: [num_joints], rad/s^2, m/s^2
  Eigen::VectorXd dddq_max;    // [num_joints], rad/s^3, m/s^3
  double brake_after_s = 0.0;  // in Fault, the brakes close after at most this time
};

// Only one thread may use it.
class UnwantedMotion {
 public:
  explicit UnwantedMotion(StopRules rules);

  // Call it in order, once per step of 1 ms. `mode`: mode of the servo that commanded this step.
  void Add(const Truth& truth, hal::Mode mode);

  // By the mode's name. Contains only modes that occurred.
  [[nodiscard]] const std::map<std::string, StandingMotion>& by_mode() const { return by_mode_; }

 private:
  [[nodiscard]] double StopTime(hal::Mode mode, const Eigen::VectorXd& dq) const;
  [[nodiscard]] double TurnTime(hal::Mode mode) const;
  [[nodiscard]] double Acceleration() const;

  StopRules rules_;
  std::map<std::string, StandingMotion> by_mode_;
  std::optional<hal::Mode> mode_;
  StandingMotion* now_ = nullptr;  // of the present mode; null if the arm may move
  Eigen::Vector3d p_start_ = Eigen::Vector3d::Zero();
  double speed_start_ = 0.0;
  double stop_mm_ = 0.0;           // allowed distance of the stop
  std::deque<Eigen::Vector3d> p_;  // hand positions of the last steps, newest last
  double speed_before_ = 0.0;
};

}  // namespace fovea::sim
