// SPDX-License-Identifier: Apache-2.0
// Moves of several axes: all arrive together within their limits, on a straight line from rest, and take a
// new goal in any tick without a jump.
#include "firmware/core/trajectory/synchronised_move.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

#include "firmware/core/trajectory/joint_move.hpp"
#include "fovea/hal/types.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::trajectory {
namespace {

constexpr double kTickS = hal::kTickPeriodS;

using Tasks = std::array<AxisTask, SynchronisedMove::kMaxAxes>;

Tasks DrawTasks(test::RandomStates& random, bool at_rest) {
  Tasks tasks;
  for (AxisTask& task : tasks) {
    task.limits = {random.Uniform(0.1, 3.0), random.Uniform(1.0, 20.0), random.Uniform(10.0, 5000.0)};
    task.start.x = random.Uniform(-3.0, 3.0);
    task.goal_x = random.Uniform(-3.0, 3.0);
    while (!at_rest) {
      task.start.v = random.Uniform(-1.0, 1.0) * task.limits.v_max;
      task.start.a = random.Uniform(-1.0, 1.0) * task.limits.a_max;
      if (std::fabs(SettledVelocity(task.start.v, task.start.a, task.limits.j_max)) <= task.limits.v_max) {
        break;
      }
    }
    if (random.Uniform(0.0, 1.0) < 0.1) {
      task.goal_x = task.start.x;
    }
  }
  return tasks;
}

// The largest share used of the limits at `samples` times of a move; jerk by differences over a tick.
double LargestUse(const SynchronisedMove& move, const Tasks& tasks, int samples) {
  double worst = 0.0;
  SynchronisedMove::States now;
  SynchronisedMove::States next;
  for (int i = 0; i <= samples; ++i) {
    const double t = move.Duration() * i / samples;
    move.At(t, now);
    move.At(t + kTickS, next);
    for (std::size_t k = 0; k < static_cast<std::size_t>(move.NumAxes()); ++k) {
      const AxisLimits& limits = tasks[k].limits;
      worst = std::max({worst, std::fabs(now[k].v) / limits.v_max, std::fabs(now[k].a) / limits.a_max,
                        std::fabs(next[k].a - now[k].a) / kTickS / limits.j_max});
    }
  }
  return worst;
}

TEST(SynchronisedMoveTest, AxesArriveTogetherWithinLimitsFromAnyState) {
  test::RandomStates random(65);
  SynchronisedMove move;
  SynchronisedMove::States states;
  double worst_use = 0.0;
  double worst_least = 0.0;
  int axes = 0;
  int early = 0;
  for (int n = 0; n < test::Repetitions(10000); ++n) {
    const Tasks tasks = DrawTasks(random, false);
    const auto num_axes = static_cast<std::size_t>(random.Uniform(1.0, 8.999));
    ASSERT_TRUE(move.Plan(std::span(tasks).first(num_axes)));
    const double T = move.Duration();
    worst_use = std::max(worst_use, LargestUse(move, tasks, 20));
    double least_s = 0.0;
    move.At(T - 1e-3 * T, states);
    for (std::size_t k = 0; k < num_axes; ++k) {
      least_s = std::max(least_s, PlanAxisMove(tasks[k].start, tasks[k].goal_x, tasks[k].limits).Duration());
      early += states[k].v == 0.0 ? 1 : 0;
      ++axes;
    }
    worst_least = std::max(worst_least, std::fabs(T / least_s - 1.0));
    move.At(T, states);
    for (std::size_t k = 0; k < num_axes; ++k) {
      ASSERT_TRUE(states[k].x == tasks[k].goal_x && states[k].v == 0.0 && states[k].a == 0.0);
    }
  }
  std::cout << axes << " axes: largest use of a limit " << worst_use << ", off the slowest axis's own time "
            << worst_least << ", at rest before the end " << early << "\n";
  EXPECT_LE(worst_use, 1.0 + 1e-9);
  EXPECT_LE(worst_least, 1e-9);
  EXPECT_EQ(early, 0);
}

TEST(SynchronisedMoveTest, PathFromRestIsStraight) {
  test::RandomStates random(66);
  SynchronisedMove move;
  SynchronisedMove::States states;
  double worst_use = 0.0;
  double least_use = 1.0;
  double worst_off = 0.0;
  for (int n = 0; n < test::Repetitions(10000); ++n) {
    const Tasks tasks = DrawTasks(random, true);
    ASSERT_TRUE(move.Plan(tasks));
    const double use = LargestUse(move, tasks, 50);
    worst_use = std::max(worst_use, use);
    least_use = std::min(least_use, use);
    for (int i = 0; i <= 10; ++i) {
      move.At(move.Duration() * i / 10, states);
      // Compares each axis's share of its way with that of the axis with the longest way.
      std::size_t far = 0;
      for (std::size_t k = 1; k < tasks.size(); ++k) {
        if (std::fabs(tasks[k].goal_x - tasks[k].start.x) >
            std::fabs(tasks[far].goal_x - tasks[far].start.x)) {
          far = k;
        }
      }
      const double share = (states[far].x - tasks[far].start.x) / (tasks[far].goal_x - tasks[far].start.x);
      for (std::size_t k = 0; k < tasks.size(); ++k) {
        const double x = tasks[k].start.x + share * (tasks[k].goal_x - tasks[k].start.x);
        worst_off = std::max(worst_off, std::fabs(states[k].x - x));
      }
    }
  }
  std::cout << "off the line by " << worst_off << ", use of the limits " << least_use << " to " << worst_use
            << "\n";
  EXPECT_LE(worst_off, 1e-14);
  EXPECT_LE(worst_use, 1.0 + 1e-9);
  EXPECT_GE(least_use, 0.9) << "some axis is always near one of its limits";
}

TEST(SynchronisedMoveTest, RefusesInvalidTasksAndKeepsItsPlan) {
  test::RandomStates random(67);
  const Tasks good = DrawTasks(random, false);
  SynchronisedMove move;
  ASSERT_TRUE(move.Plan(good));
  const double T = move.Duration();
  Tasks bad = good;
  bad[3].goal_x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(move.Plan(bad));
  bad = good;
  bad[7].start.a = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(move.Plan(bad));
  bad = good;
  bad[0].limits.j_max = 0.0;
  EXPECT_FALSE(move.Plan(bad));
  std::array<AxisTask, SynchronisedMove::kMaxAxes + 1> many;
  many.fill(good[0]);
  EXPECT_FALSE(move.Plan(many));
  JointMove joints;
  EXPECT_FALSE(joints.Plan({test::Ready(), test::Ready(), test::Ready()}, model::VecN::Zero(6), {}));
  EXPECT_EQ(move.Duration(), T);
  EXPECT_EQ(move.NumAxes(), SynchronisedMove::kMaxAxes);
}

// A new goal in any tick, planned from the reference of that tick.
TEST(JointMoveTest, TakesANewGoalInAnyTick) {
  test::RandomStates random(68);
  const model::ArmModel& arm = test::Panda().model;
  JointMove::Limits limits;
  for (std::size_t k = 0; k < 7; ++k) {
    limits[k] = {arm.joints[k].dq_max, arm.joints[k].ddq_max, arm.joints[k].dddq_max};
  }
  double worst_use = 0.0;
  double worst_jump_q = 0.0;
  double worst_jump_dq = 0.0;
  int goals = 0;
  for (int run = 0; run < test::Repetitions(100); ++run) {
    Reference reference{random.Position(arm), model::VecN::Zero(7), model::VecN::Zero(7)};
    JointMove move;
    model::VecN q_goal = random.Position(arm);
    ASSERT_TRUE(move.Plan(reference, q_goal, limits));
    double t = 0.0;
    const int changes = 20;
    for (int change = 0; change <= changes; ++change) {
      const double until = change < changes ? random.Uniform(0.0, 0.5) : move.Duration() + kTickS;
      while (t < until) {
        const Reference last = reference;
        t += kTickS;
        move.At(t, reference);
        for (int i = 0; i < 7; ++i) {
          const AxisLimits& limit = limits[static_cast<std::size_t>(i)];
          // The most that a tick of bounded jerk may add.
          const double jerk_step = limit.j_max * kTickS;
          worst_use = std::max({worst_use, std::fabs(reference.dq[i]) / limit.v_max,
                                std::fabs(reference.ddq[i]) / limit.a_max,
                                std::fabs(reference.ddq[i] - last.ddq[i]) / jerk_step});
          const double dq = last.dq[i] + kTickS * last.ddq[i];
          const double q = last.q[i] + kTickS * (last.dq[i] + 0.5 * kTickS * last.ddq[i]);
          worst_jump_dq =
              std::max(worst_jump_dq, std::fabs(reference.dq[i] - dq) / (0.5 * kTickS * jerk_step));
          worst_jump_q = std::max(
              worst_jump_q, (std::fabs(reference.q[i] - q) - 1e-14) / (kTickS * kTickS * jerk_step / 6.0));
        }
      }
      if (change < changes) {
        q_goal = random.Position(arm);
        ASSERT_TRUE(move.Plan(reference, q_goal, limits));
        t = 0.0;
        ++goals;
      }
    }
    EXPECT_EQ(reference.q, q_goal);
    EXPECT_EQ(reference.dq.norm() + reference.ddq.norm(), 0.0);
  }
  std::cout << goals << " new goals; largest use of a limit " << worst_use
            << "; per tick, of what the jerk allows: dq " << worst_jump_dq << ", q " << worst_jump_q << "\n";
  EXPECT_LE(worst_use, 1.0 + 1e-9);
  EXPECT_LE(worst_jump_dq, 1.0 + 1e-6);
  EXPECT_LE(worst_jump_q, 1.0 + 1e-6);
}

}  // namespace
}  // namespace fovea::trajectory
