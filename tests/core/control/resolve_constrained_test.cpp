// SPDX-License-Identifier: Apache-2.0
// The constrained resolution: its priorities, its continuity, and its behaviour with any input.
#include "firmware/core/control/resolve_constrained.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "tests/core/control/limit_checks.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::control {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MotionTask RandomTask(test::RandomStates& random, int m) {
  MotionTask task;
  task.J = MatrixXd::NullaryExpr(m, 7, [&] { return random.Uniform(-1.0, 1.0); });
  task.v = RandomVector(random, m, 1.0);
  task.dq_0 = RandomVector(random, 7, 0.5);
  task.weight = model::VecN::Ones(7) + RandomVector(random, 7, 0.8);
  return task;
}

barriers::MotionLimits Ranges(double size) {
  barriers::MotionLimits limits;
  limits.dq_min = model::VecN::Constant(7, -size);
  limits.dq_max = model::VecN::Constant(7, size);
  return limits;
}

TEST(ResolveConstrainedTest, NullSpaceYieldsFirstAndTheTaskKeepsItsDirection) {
  test::RandomStates random(515);
  const ConstrainedConfig config;
  int free = 0;
  int kept = 0;
  int slowed = 0;
  double worst_kept = 0.0;
  double worst_slowed = 1.0;
  for (int k = 0; k < test::Repetitions(5000); ++k) {
    const MotionTask task = RandomTask(random, 3);
    ConstrainedMotion motion;
    ResolveConstrained(config, task, Ranges(random.Uniform(0.2, 1.5)), motion);
    const VectorXd done = task.J * motion.limited.dq;
    if (motion.limited.outcome == LimitOutcome::kFree) {
      ++free;
      EXPECT_EQ(motion.limited.dq, motion.wish.dq);
      continue;
    }
    ASSERT_EQ(motion.limited.outcome, LimitOutcome::kLimited);
    if (motion.wish.sigma_min < motion.wish.threshold) {
      continue;
    }
    if (motion.task_share > 0.95) {
      ++kept;
      worst_kept = std::max(worst_kept, (done - task.v).norm() / task.v.norm());
    } else if (motion.task_share > 0.3) {
      ++slowed;
      worst_slowed = std::min(worst_slowed, done.dot(task.v) / (done.norm() * task.v.norm()));
    }
  }
  std::cout << free << " free; " << kept << " kept the task, to " << worst_kept << "; " << slowed
            << " slowed it, cosine to its direction at least " << worst_slowed << "\n";
  EXPECT_GT(kept, test::Repetitions(5000) / 20);
  EXPECT_GT(slowed, test::Repetitions(5000) / 50);
  EXPECT_LT(worst_kept, 0.1);
  EXPECT_GT(worst_slowed, 0.85);
}

// A task of zero velocity stays at zero, however the wish dq_0 pulls against limits or through a damped
// direction: otherwise the arm would come to rest off its goal. (With task and wish in one problem with
// null_weight 0.04 the largest was 0.1 rad/s on the rms singular value, with damping alone 0.003.)
TEST(ResolveConstrainedTest, NullSpaceWishAgainstALimitLeavesTheTaskUnchanged) {
  test::RandomStates random(518);
  int limited = 0;
  int damped = 0;
  double worst = 0.0;
  for (int k = 0; k < test::Repetitions(5000); ++k) {
    MotionTask task = RandomTask(random, 3);
    task.v.setZero();
    if (k % 2 == 0) {
      task.J.row(2) = task.J.row(2) * 0.02 + task.J.row(0);  // a damped direction
    }
    barriers::MotionLimits limits = Ranges(0.8);
    limits.AddRow(RandomVector(random, 7, 1.0), 0.0);
    limits.AddRow(RandomVector(random, 7, 1.0), 0.0);
    ConstrainedMotion motion;
    ResolveConstrained(ConstrainedConfig{}, task, limits, motion);
    limited += motion.limited.outcome == LimitOutcome::kLimited ? 1 : 0;
    damped += motion.wish.sigma_min < motion.wish.threshold ? 1 : 0;
    const double unit = task.J.norm() / std::sqrt(3.0);
    worst = std::max(worst, (task.J * motion.limited.dq).norm() / unit);
  }
  std::cout << limited << " limited, " << damped << " damped; the task moved by " << worst
            << " rad/s of the rms singular value at most\n";
  EXPECT_GT(limited, test::Repetitions(5000) / 4);
  EXPECT_GT(damped, test::Repetitions(5000) / 4);
  EXPECT_LT(worst, 1e-4);
}

// The task's velocity, Jacobian and limits change linearly: half the step must give half the change.
TEST(ResolveConstrainedTest, IsContinuousInWishJacobianAndLimits) {
  test::RandomStates random(516);
  double steps[2] = {0.0, 0.0};
  for (int way = 0; way < test::Repetitions(60); ++way) {
    const MotionTask a = RandomTask(random, 3);
    const MotionTask b = RandomTask(random, 3);
    const model::VecN normal_a = RandomVector(random, 7, 1.0);
    const model::VecN normal_b = RandomVector(random, 7, 1.0);
    for (int fine = 0; fine < 2; ++fine) {
      const int count = fine == 0 ? 2000 : 4000;
      model::VecN before;
      for (int k = 0; k <= count; ++k) {
        const double to = static_cast<double>(k) / count;
        MotionTask task = a;
        task.J = (1.0 - to) * a.J + to * b.J;
        task.v = (1.0 - 2.0 * to) * a.v;  // through zero
        barriers::MotionLimits limits = Ranges(0.7 - 0.4 * to);
        limits.AddRow((1.0 - to) * normal_a + to * normal_b, 0.1);
        ConstrainedMotion motion;
        ResolveConstrained(ConstrainedConfig{}, task, limits, motion);
        ASSERT_LE(Broken(limits, motion.limited.dq), kRowTolerance);
        if (k > 0) {
          steps[fine] = std::max(steps[fine], (motion.limited.dq - before).norm());
        }
        before = motion.limited.dq;
      }
    }
  }
  std::cout << "largest step of dq " << steps[0] << " rad/s per 1/2000 of the way, " << steps[1]
            << " per 1/4000\n";
  EXPECT_LT(steps[1], 0.6 * steps[0]);
}

TEST(ResolveConstrainedTest, StaysWithinLimitsForAnyJacobian) {
  test::RandomStates random(517);
  double worst = 0.0;
  for (int k = 0; k < test::Repetitions(20000); ++k) {
    MotionTask task = RandomTask(random, 1 + k % 8);
    switch (k % 5) {
      case 0: task.J.setZero(); break;
      case 1: task.J.row(task.J.rows() - 1) = task.J.row(0); break;
      case 2: task.J *= std::pow(10.0, random.Uniform(-30.0, 30.0)); break;
      case 3: task.v *= std::pow(10.0, random.Uniform(-30.0, 30.0)); break;
      default: task.v.setZero(); break;
    }
    barriers::MotionLimits limits = Ranges(0.5);
    for (int row = 0; row < k % 13; ++row) {
      limits.AddRow(RandomVector(random, 7, 1.0), random.Uniform(0.0, 0.2));
    }
    ConstrainedMotion motion;
    ResolveConstrained(ConstrainedConfig{}, task, limits, motion);
    ASSERT_TRUE(motion.limited.dq.allFinite() && std::isfinite(motion.task_share));
    ASSERT_LE(static_cast<int>(motion.limited.outcome), static_cast<int>(LimitOutcome::kScaled));
    worst = std::max(worst, Broken(limits, motion.limited.dq));
  }
  std::cout << "limits passed by " << worst << "\n";
  EXPECT_LE(worst, kRowTolerance);

  MotionTask task = RandomTask(random, 3);
  task.v[1] = std::nan("");
  ConstrainedMotion motion;
  ResolveConstrained(ConstrainedConfig{}, task, Ranges(0.5), motion);
  EXPECT_EQ(motion.limited.outcome, LimitOutcome::kNotFinite);
  EXPECT_EQ(motion.limited.dq, model::VecN::Zero(7));
}

}  // namespace
}  // namespace fovea::control
