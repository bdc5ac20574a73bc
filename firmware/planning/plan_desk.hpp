// SPDX-License-Identifier: Apache-2.0
// Answers the servo's requests for plans: on a thread of its own at real pace, or at modelled times in
// lockstep.
#pragma once

#include <cstdint>
#include <optional>
#include <thread>

#include "firmware/core/trajectory/plan_box.hpp"
#include "firmware/planning/planner.hpp"

namespace fovea::planning {

class PlanDesk {
 public:
  // As for Planner.
  explicit PlanDesk(const config::ServoConfig& config, const EyeReach& reach = {})
      : planner_(config, reach) {}
  PlanDesk(const PlanDesk&) = delete;
  PlanDesk& operator=(const PlanDesk&) = delete;

  // For ServoLoop::UsePlanner.
  [[nodiscard]] trajectory::PlanBox& box() noexcept { return box_; }

  // At real pace: the thread runs until End or the destructor.
  void Begin();
  void End();

  // In lockstep, between two ticks, from their thread: computes at once, and passes the answer on when a
  // planner on a modelled processor would have it.
  void Act(std::int64_t now_ns) noexcept;
  // What that processor needs for a request that took `work` postures [ns].
  [[nodiscard]] static std::int64_t ModelledNs(std::int64_t work) noexcept;

 private:
  void Serve(const std::stop_token& stop) noexcept;

  Planner planner_;
  trajectory::PlanBox box_;
  trajectory::Plan plan_;
  std::optional<std::int64_t> due_ns_;  // of plan_; none: nothing waits
  std::jthread thread_;                 // last: it uses the others
};

}  // namespace fovea::planning
