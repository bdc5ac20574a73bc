// SPDX-License-Identifier: Apache-2.0
// Plans a motion of all joints to a posture that reaches the goal: firmware/planning/README.md.
//
// It runs on a thread beside the tick. It allocates in its constructor, its memory and work are bounded, and
// the same request has the same answer.
#pragma once

#include <memory>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/trajectory/plan.hpp"
#include "firmware/core/trajectory/plan_request.hpp"
#include "firmware/planning/eye_reach.hpp"

namespace fovea::planning {

class Planner {
 public:
  // Postures beyond the budget for a proved motion along a path that was found at its end: without it, the
  // path is of no use.
  static constexpr std::int64_t kProofWork = 60'000;

  // `config` must be one that the servo accepts, and outlive the planner. May throw std::bad_alloc.
  explicit Planner(const config::ServoConfig& config, const EyeReach& reach = {});
  ~Planner();
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;

  // What a plan took.
  struct Effort {
    std::int64_t work = 0;  // postures
    int goals = 0;          // postures found that reach the goal
    double length = 0.0;    // of the path [rad]
  };

  // Fills in `plan`: its outcome says whether there is one. Not real-time: up to about 5 us for each unit of
  // the request's budget, and of kProofWork more if a path is found at its end.
  void Compute(const trajectory::PlanRequest& request, trajectory::Plan& plan) noexcept;
  [[nodiscard]] const Effort& effort() const noexcept;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace fovea::planning
