// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/visual_law.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <iostream>

#include "firmware/core/model/kinematics.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::control {
namespace {

struct Scene {
  features::FeatureState feature;
  model::Mat6N J_C;
  model::VecN q;
};

// A random posture well inside the range, with a sphere in front of the camera.
Scene RandomScene(test::RandomStates& random, const config::ServoConfig& config) {
  Scene scene;
  scene.q = test::Ready() + random.Joints(config.arm, 0.5);
  model::ArmPoses poses;
  model::ComputePoses(config.arm, scene.q, poses);
  model::ComputeJacobian(config.arm, poses, config.X_EC, scene.J_C);
  const double z = random.Uniform(0.25, 0.8);
  const model::Vec3 p(z * random.Uniform(-0.4, 0.4), z * random.Uniform(-0.3, 0.3), z);
  EXPECT_TRUE(config.feature.Compute({{model::Mat3::Identity(), p}, random.Vector(0.2)}, scene.feature));
  return scene;
}

// The law's joint velocities when no limit is near.
model::VecN Unlimited(const config::ServoConfig& config, const config::LawConfig& law,
                      const features::FeatureState& feature, const model::Mat6N& J_C, const model::VecN& q,
                      VisualLawOutput& out) {
  VisualLaw(law, config.arm, feature, {J_C, q, model::VecN::Zero(q.size())}, out);
  DampingConfig damping;
  damping.threshold = law.damping;
  DampedMotion motion;
  ResolveDamped(damping, out.task, motion);
  return motion.dq;
}

TEST(VisualLawTest, CommandsExponentialDecayOfTheFeatureError) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(21);
  double worst = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const Scene s = RandomScene(random, config);
    VisualLawOutput out;
    const model::VecN dq_des = Unlimited(config, config.law, s.feature, s.J_C, s.q, out);
    // Joints and target together must change s by ds/dt = lambda e, with e = goal - actual.
    const Eigen::VectorXd ds = s.feature.L_s * (s.J_C * dq_des) + s.feature.ds_dt_target;
    const Eigen::VectorXd wanted = config.law.lambda * (s.feature.s_star - s.feature.s);
    worst = std::max(worst, (ds - wanted).norm() / wanted.norm());
    EXPECT_EQ(Eigen::VectorXd(out.e), Eigen::VectorXd(s.feature.s_star - s.feature.s));
  }
  std::cout << "worst departure from lambda e: " << worst << " relative (the damping's share)\n";
  EXPECT_LT(worst, 0.01);
}

// Without damping the law is the pseudo-inverse with the posture in its null space.
TEST(VisualLawTest, WithoutDampingEqualsThePseudoInversePlusNullSpacePosture) {
  config::ServoConfig config = test::PandaConfig();
  config.law.damping = 1e-9;
  test::RandomStates random(22);
  double worst = 0.0;
  double worst_posture = 0.0;
  for (int k = 0; k < 500; ++k) {
    const Scene s = RandomScene(random, config);
    VisualLawOutput out;
    const model::VecN dq_des = Unlimited(config, config.law, s.feature, s.J_C, s.q, out);
    const Eigen::MatrixXd J_s = s.feature.L_s * s.J_C;
    const Eigen::MatrixXd pinv = J_s.completeOrthogonalDecomposition().pseudoInverse();
    const Eigen::VectorXd dq_0 = FreeWish(config.law, config.arm, s.q, s.J_C);
    const Eigen::VectorXd expected = pinv * (out.ds_cmd - J_s * dq_0) + dq_0;
    worst = std::max(worst, (expected - dq_des).norm() / expected.norm());

    config::LawConfig no_posture = config.law;
    no_posture.posture_gain = 0.0;
    VisualLawOutput without;
    const model::VecN dq_without = Unlimited(config, no_posture, s.feature, s.J_C, s.q, without);
    worst_posture = std::max(worst_posture, (J_s * (dq_des - dq_without)).norm());
  }
  std::cout << "worst difference from the pseudo-inverse " << worst << ", the posture moves the feature by "
            << worst_posture << " 1/s\n";
  EXPECT_LT(worst, 1e-9);
  EXPECT_LT(worst_posture, 1e-8);
}

TEST(VisualLawTest, StaysBoundedWhereTheTaskIsSingular) {
  // Arm stretched out: the task Jacobian loses rank or comes near it.
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(23);
  for (int k = 0; k < 500; ++k) {
    model::VecN q(7);
    q << random.Uniform(-1, 1), random.Uniform(0, 0.5), 0.0, -0.0698, 0.0, random.Uniform(0.0, 0.3), 0.7;
    model::ArmPoses poses;
    model::ComputePoses(config.arm, q, poses);
    model::Mat6N J_C;
    model::ComputeJacobian(config.arm, poses, config.X_EC, J_C);
    features::FeatureState feature;
    ASSERT_TRUE(config.feature.Compute({{model::Mat3::Identity(), {0.0, 0.0, 1.0}}}, feature));
    VisualLawOutput out;
    const model::VecN dq_des = Unlimited(config, config.law, feature, J_C, q, out);
    EXPECT_TRUE(dq_des.allFinite());
    EXPECT_LT(dq_des.norm(), 100.0);
  }
}

TEST(ProgressTest, EqualsTheAchievedShareOfTheCommandedMotion) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(24);
  const Scene s = RandomScene(random, config);
  VisualLawOutput out;
  const model::VecN dq_des = Unlimited(config, config.law, s.feature, s.J_C, s.q, out);
  EXPECT_NEAR(Progress(s.feature, out.ds_cmd, s.J_C, dq_des), 1.0, 0.01);
  EXPECT_NEAR(Progress(s.feature, out.ds_cmd, s.J_C, 0.5 * dq_des), 0.5, 0.01);
  EXPECT_NEAR(Progress(s.feature, out.ds_cmd, s.J_C, model::VecN::Zero(7)), 0.0, 1e-12);
  EXPECT_EQ(Progress(s.feature, features::FeatureVector::Zero(3), s.J_C, dq_des), 1.0);
}

TEST(GainTest, ChangesFromNearToFarValueWithTheSetSlope) {
  config::LawConfig law;
  law.lambda = 1.5;
  EXPECT_EQ(GainAt(law, 0.0), 1.5) << "constant while lambda_near is 0";
  EXPECT_EQ(GainAt(law, 10.0), 1.5);
  for (const double near : {4.0, 0.5}) {
    law.lambda_near = near;
    EXPECT_EQ(GainAt(law, 0.0), near);
    EXPECT_NEAR(GainAt(law, 1e9), law.lambda, 1e-6);
    const double slope = (GainAt(law, 1e-7) - GainAt(law, 0.0)) / 1e-7;
    EXPECT_NEAR(slope, near > law.lambda ? -law.lambda_slope : law.lambda_slope, 1e-3);
    double before = near;
    for (double e = 0.01; e < 3.0; e += 0.01) {  // monotonic
      const double gain = GainAt(law, e);
      EXPECT_GT((gain - before) * (law.lambda - near), 0.0);
      before = gain;
    }
  }
}

TEST(InteractionTest, UsesCurrentGoalOrMeanMatrixAsConfigured) {
  config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(25);
  const Scene s = RandomScene(random, config);
  features::FeatureState goal;
  ASSERT_TRUE(config.feature.ComputeAtGoal(goal));
  for (const config::Law which : {config::Law::kIbvs, config::Law::kDesired, config::Law::kMean}) {
    config.law.law = which;
    features::FeatureState feature = s.feature;
    ChooseInteraction(config.law, goal.L_s, feature);
    const double of_goal = which == config::Law::kIbvs ? 0.0 : which == config::Law::kDesired ? 1.0 : 0.5;
    EXPECT_LT((feature.L_s - (of_goal * goal.L_s + (1.0 - of_goal) * s.feature.L_s)).norm(), 1e-13);
    EXPECT_EQ(feature.s, s.feature.s);
  }
}

// A feature that is the camera's position, whose target moves at `ds_dt_target`, under the law's own wish.
struct FreeFeature {
  explicit FreeFeature(const Eigen::Vector3d& e, const Eigen::Vector3d& ds_dt_target) {
    feature.Resize(3);
    feature.s_star = e;
    feature.ds_dt_target = ds_dt_target;
    feature.L_s.leftCols<3>().setIdentity();
  }
  void Tick(const config::LawConfig& law) {
    VisualLaw(law, camera, feature, {along_itself, zero, V}, output);
    V.head<3>() = output.ds_cmd;
    feature.s += hal::kTickPeriodS * (output.ds_cmd + feature.ds_dt_target);
  }

  features::FeatureState feature;
  const model::ArmModel camera = [] {
    model::ArmModel free;
    free.num_joints = 6;
    return free;
  }();
  const model::Mat6N along_itself = model::Mat6::Identity();
  const model::VecN zero = model::VecN::Zero(6);
  model::VecN V = model::VecN::Zero(6);
  VisualLawOutput output;
};

// e(t) = e(0) (1 + omega t) exp(-omega t), and the wish starts at rest.
TEST(SecondOrderTest, DecaysCriticallyDamped) {
  config::LawConfig law;
  law.law = config::Law::kSecondOrder;
  law.lambda = 2.0;
  const double omega = 3.0;
  FreeFeature free({0.4, -0.2, 0.1}, Eigen::Vector3d::Zero());
  const Eigen::Vector3d start = free.feature.s_star;
  double worst = 0.0;
  for (int ms = 1; ms <= 4000; ++ms) {
    free.Tick(law);
    const double t = 1e-3 * ms;
    const Eigen::Vector3d e = free.feature.s_star - free.feature.s;
    worst = std::max(worst, (e - start * (1.0 + omega * t) * std::exp(-omega * t)).norm());
    ASSERT_LT(free.output.ds_cmd.norm(), start.norm() * omega * omega * t + 1e-12) << "from rest, at " << ms;
    ASSERT_GE(e.dot(start), 0.0) << "no overshoot";
  }
  std::cout << "largest deviation from the analytic error: " << worst << " of " << start.norm() << "\n";
  EXPECT_LT(worst, 2e-3 * start.norm());
  EXPECT_LT((free.feature.s_star - free.feature.s).norm(), 1e-4);
}

// A target that moves steadily leaves no error behind.
TEST(SecondOrderTest, FollowsAMovingTargetWithoutLag) {
  config::LawConfig law;
  law.law = config::Law::kSecondOrder;
  FreeFeature free({0.1, 0.0, 0.0}, {0.3, -0.2, 0.1});
  for (int ms = 0; ms < 8000; ++ms) {
    free.Tick(law);
  }
  EXPECT_LT((free.feature.s_star - free.feature.s).norm(), 1e-6);
  EXPECT_LT((free.V.head<3>() + free.feature.ds_dt_target).norm(), 1e-6);
}

}  // namespace
}  // namespace fovea::control
