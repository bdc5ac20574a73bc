// How far and how fast the hand moved while the arm should have stood, by the simulator's truth: in Boot,
// Hold and Fault, from where each began.
//
// Hold and Fault may begin in motion. Some way is needed to stop then: at most as far as the hand goes in the
// time of the stop at the speed that it had, or was coming to before its acceleration is turned round. What
// it went, or got faster, beyond that is told apart.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "fovea/hal/events.hpp"
#include "sim/verdict/summary.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// How an arm may stop.
struct StopRules {
  Eigen::VectorXd ddq_max;     // of Hold: [num_joints], rad/s^2, m/s^2
  Eigen::VectorXd dddq_max;    // [num_joints], rad/s^3, m/s^3
  double brake_after_s = 0.0;  // in Fault the brakes are closed after this time at the latest
};

// One thread uses it.
class UnwantedMotion {
 public:
  explicit UnwantedMotion(StopRules rules);

  // In order, one for each step of 1 ms. `mode`: the servo's, whose command was in force in this step.
  void Add(const Truth& truth, hal::Mode mode);

  // By the mode's name; those in which the servo never was are not there.
  [[nodiscard]] const std::map<std::string, StandingMotion>& by_mode() const { return by_mode_; }

 private:
  [[nodiscard]] double StopTime(hal::Mode mode, const Eigen::VectorXd& dq) const;
  [[nodiscard]] double TurnTime(hal::Mode mode) const;
  [[nodiscard]] double Acceleration() const;

  StopRules rules_;
  std::map<std::string, StandingMotion> by_mode_;
  std::optional<hal::Mode> mode_;
  StandingMotion* now_ = nullptr;  // of the mode that lasts; none where the arm may move
  Eigen::Vector3d p_start_ = Eigen::Vector3d::Zero();
  double speed_start_ = 0.0;
  double stop_mm_ = 0.0;           // what the stop from there may take
  std::deque<Eigen::Vector3d> p_;  // of the last steps, newest last
  double speed_before_ = 0.0;
};

}  // namespace fovea::sim
