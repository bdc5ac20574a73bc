// SPDX-License-Identifier: Apache-2.0
// Attacks on the workspace boundary in Bullet: 1 m/s towards it, along it and obliquely, from every side.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "tests/closed_loop/guard_bench.hpp"
#include "tests/support/random_states.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::test {
namespace {

constexpr double kBoundary = 0.85;
constexpr double kSlack = 1e-3;

// A random posture in any direction from the base, with the hand at least 5 cm inside the boundary.
Eigen::VectorXd Posture(RandomStates& random, const Eigen::VectorXd& q_start) {
  while (true) {
    Eigen::VectorXd q = q_start + Eigen::VectorXd(random.Joints(Panda().model, 0.3));
    q[0] = random.Uniform(-2.5, 2.5);
    model::ArmPoses poses;
    model::ComputePoses(Panda().model, q, poses);
    if (poses.X_BE.p.norm() < kBoundary - 0.05) {
      return q;
    }
  }
}

enum class Way { kTowards, kAlong, kAslant, kFromSide };

TEST(GuardAttack, HandNeverCrossesTheWorkspaceBoundary) {
  RandomStates random(41);
  GuardFigures worst;
  int reached = 0;
  constexpr int kAttacks = Repetitions(120);
  for (int attack = 0; attack < kAttacks; ++attack) {
    GuardSetup setup;
    setup.servo.move.pose_error_max = 10.0;
    setup.world.q_start = Posture(random, setup.world.q_start);
    setup.world.physics.table = false;  // it would block some attacks
    setup.world.seed = static_cast<std::uint64_t>(attack) + 1;
    const Eigen::Vector3d side = Eigen::Vector3d(random.Vector(1.0)).normalized();
    const auto way = static_cast<Way>(attack % 4);
    setup.motion = Attack(0.1, [side, way](const sim::Truth& truth) {
      const Eigen::Vector3d p = truth.X_BE.translation();
      const Eigen::Vector3d outward = p.normalized();
      const Eigen::Vector3d along = outward.cross(side).normalized();
      const double near = std::clamp((p.norm() - 0.75) / 0.08, 0.0, 1.0);
      switch (way) {
        case Way::kTowards: return outward;
        case Way::kAlong: return Eigen::Vector3d(((1.0 - near) * outward + near * along).normalized());
        case Way::kAslant: return Eigen::Vector3d((outward + along).normalized());
        case Way::kFromSide: return side;
      }
      return outward;
    });
    GuardBench bench(setup);
    bench.RunUntil(1.6);
    const GuardFigures& f = bench.figures();
    worst.radius = std::max(worst.radius, f.radius);
    worst.speed = std::max(worst.speed, f.speed);
    worst.velocity = std::max(worst.velocity, f.velocity);
    worst.torque = std::max(worst.torque, f.torque);
    worst.torque_rate = std::max(worst.torque_rate, f.torque_rate);
    reached += f.radius > kBoundary - 0.01 ? 1 : 0;
    ExpectInsideLimits(bench);
    EXPECT_EQ(bench.FirstFault(), -1) << "attack " << attack << ": " << hal::Name(bench.last().record.fault);
  }
  std::cout << kAttacks << " attacks, " << reached << " reached the last centimetre; furthest |p_BE| "
            << worst.radius << " m, fastest " << worst.speed << " m/s; largest shares: joint velocity "
            << worst.velocity << ", torque " << worst.torque << ", its rate " << worst.torque_rate << '\n';
  EXPECT_LE(worst.radius, kBoundary + kSlack);
  EXPECT_GT(reached, kAttacks / 2) << "too few attacks reach the boundary";
}

// The camera leads the hand there: a target that runs away at 1 m/s in every direction.
TEST(GuardAttack, RunawayTargetDoesNotDrawTheHandAcrossTheBoundary) {
  double furthest = 0.0;
  int reached = 0;
  constexpr int kTargets = 16;
  for (int k = 0; k < kTargets; ++k) {
    GuardSetup setup;
    setup.servo.auto_track = true;
    setup.servo.law.lambda = 4.0;
    const double angle = 2.0 * M_PI * k / kTargets;
    const Eigen::Vector3d velocity(std::cos(angle), std::sin(angle), k % 3 == 0 ? 0.3 : 0.0);
    setup.target = [velocity](double t_s) {
      return Eigen::Vector3d(Eigen::Vector3d(0.5, 0.05, 0.04) +
                             std::clamp(t_s - 0.6, 0.0, 1.0) * velocity.normalized());
    };
    GuardBench bench(setup);
    bench.RunUntil(3.5);
    furthest = std::max(furthest, bench.figures().radius);
    reached += bench.figures().radius > kBoundary - 0.02 ? 1 : 0;
    ExpectInsideLimits(bench);
    EXPECT_EQ(bench.FirstFault(), -1) << hal::Name(bench.last().record.fault);
  }
  std::cout << kTargets << " targets, " << reached
            << " drew the hand into the last two centimetres; furthest " << furthest << " m\n";
  EXPECT_LE(furthest, kBoundary + kSlack);
  EXPECT_GT(reached, 3);
}

}  // namespace
}  // namespace fovea::test
