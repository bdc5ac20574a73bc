// SPDX-License-Identifier: Apache-2.0
// The visual laws against ViSP's: the same twist of a free camera from the same view, to 1e-9.
#include <gtest/gtest.h>

#include <iostream>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/control/resolve_damped.hpp"
#include "firmware/core/control/visual_law.hpp"
#include "firmware/core/model/rotation.hpp"
#include "tests/support/random_states.hpp"
#include "tests/visp/visp_laws.hpp"

namespace fovea::test {
namespace {

using features::FeatureForm;

constexpr double kLambda = 2.0;
constexpr double kSame = 1e-9;  // of the twist

features::TargetFeature SquareBy(config::Law law) {
  features::TargetFeature square;
  square.target = hal::FeatureKind::kSquare;
  square.form = config::TraitsOf(law).form.value_or(FeatureForm::kCorners);
  square.corners = features::MakeSquare(square.side);
  square.p_CO_C_star = {0.03, -0.02, 0.4};
  square.R_CO_star = model::RotationOf({0.2, -0.1, 0.3});
  return square;
}

VispView ViewOf(const features::TargetFeature& square, const model::Pose& X_CO) {
  VispView view;
  for (std::size_t k = 0; k < view.p_CP_C.size(); ++k) {
    const model::Vec3 p = X_CO * square.corners.corners[k];
    view.p_CP_C[k] = {p.x(), p.y(), p.z()};
  }
  view.X_CO = {X_CO.R(0, 0), X_CO.R(0, 1), X_CO.R(0, 2), X_CO.p.x(),   X_CO.R(1, 0), X_CO.R(1, 1),
               X_CO.R(1, 2), X_CO.p.y(),   X_CO.R(2, 0), X_CO.R(2, 1), X_CO.R(2, 2), X_CO.p.z(),
               0.0,          0.0,          0.0,          1.0};
  return view;
}

// Any turn about the optical axis short of half a turn from the goal, tilted by up to 50 degrees.
model::Pose RandomPose(RandomStates& random) {
  const double z = random.Uniform(0.3, 0.8);
  const model::Mat3 turn = model::RotationOf({0.0, 0.0, random.Uniform(-2.2, 2.2)});
  const double direction = random.Uniform(-M_PI, M_PI);
  const double tilt = random.Uniform(0.0, 0.87);
  const model::Mat3 tilted = model::RotationOf({tilt * std::cos(direction), tilt * std::sin(direction), 0.0});
  return {tilted * turn, {z * random.Uniform(-0.3, 0.3), z * random.Uniform(-0.3, 0.3), z}};
}

// The twist of a free camera: its "joints" are the entries of its twist.
model::Vec6 FoveaTwist(config::Law law, const features::TargetFeature& square, const model::Pose& X_CO) {
  config::LawConfig config;
  config.law = law;
  config.lambda = kLambda;
  config.lambda_near = 0.0;
  model::ArmModel camera;
  camera.num_joints = 6;
  features::FeatureState goal;
  features::FeatureState feature;
  EXPECT_TRUE(square.ComputeAtGoal(goal));
  EXPECT_TRUE(square.Compute({X_CO, model::Vec3::Zero(), model::Vec3::Zero()}, feature));
  control::ChooseInteraction(config, goal.L_s, feature);
  const model::Mat6N along_itself = model::Mat6::Identity();
  const model::VecN zero = model::VecN::Zero(6);
  control::VisualLawOutput output;
  control::VisualLaw(config, camera, feature, {along_itself, zero, zero}, output);
  control::DampingConfig exact;
  exact.threshold = 1e-9;
  control::DampedMotion motion;
  control::ResolveDamped(exact, output.task, motion);
  return motion.dq;
}

struct Pair {
  config::Law ours;
  VispLaw theirs;
};

class VispLaws : public testing::TestWithParam<Pair> {};

TEST_P(VispLaws, SameTwist) {
  const auto [ours, theirs] = GetParam();
  const features::TargetFeature square = SquareBy(ours);
  const VispView goal = ViewOf(square, {square.R_CO_star, square.p_CO_C_star});
  RandomStates random(31);
  double worst = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const model::Pose X_CO = RandomPose(random);
    const model::Vec6 V = FoveaTwist(ours, square, X_CO);
    const std::array<double, 6> visp = VispTwist(theirs, ViewOf(square, X_CO), goal, kLambda);
    const model::Vec6 V_visp = Eigen::Map<const model::Vec6>(visp.data());
    ASSERT_GT(V_visp.norm(), 1e-3);
    worst = std::max(worst, (V - V_visp).norm() / V_visp.norm());
  }
  std::cout << config::TraitsOf(ours).name << ": largest relative difference of 1000 twists " << worst
            << "\n";
  EXPECT_LT(worst, kSame);
}

INSTANTIATE_TEST_SUITE_P(All, VispLaws,
                         testing::Values(Pair{config::Law::kIbvs, VispLaw::kIbvs},
                                         Pair{config::Law::kMean, VispLaw::kMean},
                                         Pair{config::Law::kDesired, VispLaw::kDesired},
                                         Pair{config::Law::kPbvs, VispLaw::kPbvs},
                                         Pair{config::Law::kHybrid, VispLaw::kHybrid}),
                         [](const auto& given) { return config::TraitsOf(given.param.ours).name; });

}  // namespace
}  // namespace fovea::test
