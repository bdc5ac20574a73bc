// How far and how fast the hand moved while the arm should have stood, by the simulator's truth: in Boot,
// Hold and Fault, from where each began.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "fovea/hal/events.hpp"
#include "sim/app/summary.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// One thread uses it.
class UnwantedMotion {
 public:
  // In order, one for each step of 1 ms. `mode`: the servo's, whose command was in force in this step.
  void Add(const Truth& truth, hal::Mode mode);

  // By the mode's name; those in which the servo never was are not there.
  [[nodiscard]] const std::map<std::string, StandingMotion>& by_mode() const { return by_mode_; }

 private:
  std::map<std::string, StandingMotion> by_mode_;
  std::optional<hal::Mode> mode_;
  StandingMotion* now_ = nullptr;  // of the mode that lasts; none where the arm may move
  Eigen::Vector3d p_start_ = Eigen::Vector3d::Zero();
  double speed_start_ = 0.0;
  std::optional<Eigen::Vector3d> p_before_;
  double speed_before_ = 0.0;
};

}  // namespace fovea::sim
