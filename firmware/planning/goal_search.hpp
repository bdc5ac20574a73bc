// SPDX-License-Identifier: Apache-2.0
// The postures that reach the goal, on as many branches of the arm's inverse kinematics as are found.
//
// Gauss-Newton on the camera's pose relative to the target, from the start's posture and from random ones. A
// square looks the same after each quarter turn: each of its goals is tried. A ball or a disc leaves the
// camera's orientation free: then only its position counts, and every descent may end elsewhere.
#pragma once

#include <vector>

#include "firmware/planning/posture_space.hpp"

namespace fovea::planning {

struct GoalPosture {
  model::VecN q;  // [num_joints]
  int turn = 0;   // equal turn of the target about its z
  double cost = 0.0;
};

class GoalSearch {
 public:
  static constexpr std::size_t kMostGoals = 24;

  GoalSearch() { goals_.reserve(kMostGoals); }

  // True if the search has a defined goal for this arm and feature.
  [[nodiscard]] static bool IsFor(const config::ServoConfig& config) noexcept;

  // Searches from `q` [num_joints] and from random postures. Keeps what earlier calls since Clear() found.
  // kFound if there is a goal; else the reason, with the limit in `blocker`.
  [[nodiscard]] trajectory::PlanOutcome Search(const PostureSpace& space, const model::VecN& q, Work& work,
                                               Draws& draws, hal::Limit& blocker) noexcept;
  void Clear() noexcept;

  // The cheapest first: near the start, and not close to limits.
  [[nodiscard]] const std::vector<GoalPosture>& goals() const noexcept { return goals_; }

 private:
  void Try(const PostureSpace& space, const model::VecN& from, const model::VecN& q, int turn,
           Work& work) noexcept;
  void Keep(const PostureSpace& space, const model::VecN& from, const Posture& posture, int turn,
            double travel) noexcept;

  std::vector<GoalPosture> goals_;
  std::array<int, 16> blocked_by_{};  // postures that reach the goal, by the limit that they are past
  int reached_ = 0;
};

}  // namespace fovea::planning
