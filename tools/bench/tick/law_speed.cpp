// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/tick/law_speed.hpp"

#include <random>

#include "firmware/core/barriers/motion_limits.hpp"
#include "firmware/core/control/resolve_constrained.hpp"
#include "firmware/core/control/visual_law.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "tools/bench/common/spread.hpp"

namespace fovea::bench {
namespace {

constexpr int kCases = 500;
constexpr int kRounds = 41;
constexpr int kFeatures = 8;

constexpr double kGoalNs = 500.0;
constexpr double kSmallestRatio = 1e-6;  // relative singular value down to which the inverse is exact

struct Case {
  features::FeatureState feature;
  model::Mat6N J_C;
  trajectory::Reference reference;
  control::VisualLawOutput law;         // for the arm
  control::VisualLawOutput camera_law;  // for a free camera, without an arm
};

std::vector<Case> RandomCases(const model::ArmModel& arm) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<Case> cases(kCases);
  for (Case& c : cases) {
    c.reference.q = model::ToVector(arm.q_ready, arm.num_joints);
    c.reference.dq = c.reference.ddq = model::VecN::Zero(arm.num_joints);
    for (int i = 0; i < arm.num_joints; ++i) {
      c.reference.q[i] += 0.4 * unit(engine);
    }
    model::ArmPoses poses;
    model::ComputePoses(arm, c.reference.q, poses);
    model::ComputeJacobian(arm, poses, model::Pose{}, c.J_C);
    // Four corners of a square at about 0.4 m, as normalised image points.
    c.feature.s.resize(kFeatures);
    c.feature.L_s.resize(kFeatures, 6);
    for (Eigen::Index k = 0; k < kFeatures / 2; ++k) {
      const double x = (k % 2 == 0 ? -0.12 : 0.12) + 0.03 * unit(engine);
      const double y = (k < 2 ? -0.12 : 0.12) + 0.03 * unit(engine);
      const double Z = 0.4 + 0.05 * unit(engine);
      c.feature.s.segment<2>(2 * k) << x, y;
      c.feature.L_s.middleRows<2>(2 * k) << -1 / Z, 0, x / Z, x * y, -(1 + x * x), y,  //
          0, -1 / Z, y / Z, 1 + y * y, -x * y, -x;
    }
    c.feature.s_star = c.feature.s + 0.05 * features::FeatureVector::Random(kFeatures);
    c.feature.ds_dt_target = features::FeatureVector::Zero(kFeatures);
  }
  return cases;
}

}  // namespace

std::vector<Figure> LawSpeed(const model::ArmModel& arm) {
  std::vector<Case> cases = RandomCases(arm);
  config::ServoConfig config;
  config.arm = arm;
  config.law.q_posture = arm.q_ready;
  control::DampingConfig exact;
  exact.threshold = kSmallestRatio;
  const control::DampingConfig damped;

  model::ArmModel free_camera;
  free_camera.num_joints = 6;
  const model::Mat6N along_itself = model::Mat6::Identity();
  const model::VecN nowhere = model::VecN::Zero(6);
  control::DampedMotion motion;
  const auto twist = [&](const control::DampingConfig& damping) {
    return MedianNs(kRounds, cases, [&](Case& c) {
      control::VisualLaw(config.law, free_camera, c.feature, {along_itself, nowhere, nowhere}, c.camera_law);
      control::ResolveDamped(damping, c.camera_law.task, motion);
    });
  };
  const auto joints = [&](const control::DampingConfig& damping) {
    return MedianNs(kRounds, cases, [&](Case& c) {
      control::VisualLaw(config.law, arm, c.feature, {c.J_C, c.reference.q, c.reference.dq}, c.law);
      control::ResolveDamped(damping, c.law.task, motion);
    });
  };
  std::vector<Figure> figures{{"visual_law_ns", twist(exact), "ns", kGoalNs},
                              {"visual_law_damped_ns", twist(damped), "ns", kGoalNs},
                              {"visual_law_joints_ns", joints(exact), "ns", kGoalNs},
                              {"visual_law_joints_damped_ns", joints(damped), "ns", kGoalNs}};

  control::ConstrainedMotion constrained;
  barriers::MotionLimits limits;
  const double resolved = MedianNs(kRounds, cases, [&](Case& c) {
    barriers::LimitJoints(config, c.reference.q, limits);
    barriers::LimitAcceleration(config, c.reference, limits);
    control::ResolveConstrained({}, c.law.task, limits, constrained);
  });
  figures.push_back({"resolve_constrained_ns", resolved, "ns", {}});
  return figures;
}

}  // namespace fovea::bench
