// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/trajectory/synchronised_move.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::trajectory {
namespace {

// The smallest distance that counts for an axis, so that the line's limits stay finite [m or rad].
constexpr double kShortestWay = 1e-60;

bool IsPositive(double limit) noexcept { return std::isfinite(limit) && limit > 0.0; }

bool IsSound(const AxisTask& task) noexcept {
  return std::isfinite(task.start.x) && std::isfinite(task.start.v) && std::isfinite(task.start.a) &&
         std::isfinite(task.goal_x) && IsPositive(task.limits.v_max) && IsPositive(task.limits.a_max) &&
         IsPositive(task.limits.j_max);
}

bool IsAtRest(const AxisTask& task) noexcept { return task.start.v == 0.0 && task.start.a == 0.0; }

}  // namespace

bool SynchronisedMove::Plan(std::span<const AxisTask> tasks) noexcept {
  if (tasks.size() > static_cast<std::size_t>(kMaxAxes) ||
      !std::all_of(tasks.begin(), tasks.end(), IsSound)) {
    return false;
  }
  num_axes_ = static_cast<int>(tasks.size());
  duration_s_ = 0.0;
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    goal_[k] = tasks[k].goal_x;
    way_[k] = tasks[k].goal_x - tasks[k].start.x;
  }
  straight_ = std::all_of(tasks.begin(), tasks.end(), IsAtRest);
  if (straight_) {
    PlanLine(tasks);
  } else {
    PlanTimes(tasks);
  }
  return true;
}

void SynchronisedMove::PlanLine(std::span<const AxisTask> tasks) noexcept {
  // The line's limits, as shares of its length per s, s^2 and s^3.
  AxisLimits line;
  bool moves = false;
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    if (way_[k] == 0.0) {
      continue;
    }
    const double way = std::max(std::fabs(way_[k]), kShortestWay);
    const AxisLimits& limits = tasks[k].limits;
    line.v_max = moves ? std::min(line.v_max, limits.v_max / way) : limits.v_max / way;
    line.a_max = moves ? std::min(line.a_max, limits.a_max / way) : limits.a_max / way;
    line.j_max = moves ? std::min(line.j_max, limits.j_max / way) : limits.j_max / way;
    moves = true;
  }
  if (moves) {
    moves_[0] = PlanAxisMove({-1.0, 0.0, 0.0}, 0.0, line);
    duration_s_ = moves_[0].Duration();
  }
}

void SynchronisedMove::PlanTimes(std::span<const AxisTask> tasks) noexcept {
  double slowest_s = 0.0;
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    moves_[k] = PlanAxisMove(tasks[k].start, tasks[k].goal_x, tasks[k].limits);
    slowest_s = std::max(slowest_s, moves_[k].Duration());
  }
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    if (moves_[k].Duration() < slowest_s) {
      moves_[k] = PlanAxisMove(tasks[k].start, tasks[k].goal_x, tasks[k].limits, slowest_s);
    }
    duration_s_ = std::max(duration_s_, moves_[k].Duration());
  }
}

void SynchronisedMove::At(double t, States& states) const noexcept {
  const auto num_axes = static_cast<std::size_t>(num_axes_);
  if (!(t < duration_s_)) {
    for (std::size_t k = 0; k < num_axes; ++k) {
      states[k] = {goal_[k], 0.0, 0.0};
    }
  } else if (straight_) {
    const AxisState line = moves_[0].At(t);
    for (std::size_t k = 0; k < num_axes; ++k) {
      states[k] = {goal_[k] + way_[k] * line.x, way_[k] * line.v, way_[k] * line.a};
    }
  } else {
    for (std::size_t k = 0; k < num_axes; ++k) {
      states[k] = moves_[k].At(t);
    }
  }
}

}  // namespace fovea::trajectory
