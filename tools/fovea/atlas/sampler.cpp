// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/sampler.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "firmware/core/model/rotation.hpp"
#include "firmware/host/config/roll_pitch_yaw.hpp"

namespace fovea::atlas {
namespace {

using model::Mat3;
using model::Pose;
using model::Vec3;
using model::VecN;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kDepthLeast = 0.25;  // [m]
constexpr double kDepthMost = 0.90;
constexpr double kTiltMostDeg = 45.0;
constexpr int kMostDraws = 1'000'000;

double Rounded(double value, double step) { return std::round(value / step) * step; }

}  // namespace

Pose Start::TargetPose() const { return {config::RollPitchYaw({rpy_deg.begin(), rpy_deg.end()}), p_BO}; }

// X_CO of a target at a random place in the picture.
Pose Sampler::DrawTarget(std::mt19937_64& engine) const {
  const vision::Intrinsics& camera = goals_.checks().scene().camera;
  const double u = Uniform(engine, 0.0, camera.width_px - 1.0);
  const double v = Uniform(engine, 0.0, camera.height_px - 1.0);
  const double depth = Uniform(engine, kDepthLeast, kDepthMost);
  const double tilt = kRadPerDeg * Uniform(engine, 0.0, kTiltMostDeg);
  const double about = Uniform(engine, -std::numbers::pi, std::numbers::pi);
  const double turn = Uniform(engine, -std::numbers::pi, std::numbers::pi);
  Pose X_CO;
  X_CO.p = depth * camera.Ray(u, v);
  X_CO.R = model::RotationOf({tilt * std::cos(about), tilt * std::sin(about), 0.0}) *
           model::RotationOf({0.0, 0.0, turn});
  return X_CO;
}

double Sampler::ErrorPx(const Pose& X_CO) const {
  const Scene& scene = goals_.checks().scene();
  const features::TargetFeature& feature = scene.servo.feature;
  const bool turned = feature.SeesOrientation();
  const Pose goal{turned ? goals_.NearestGoal(X_CO.R) : Mat3::Identity(), feature.p_CO_C_star};
  const int points = turned ? feature.corners.num_corners : 1;
  double sum2 = 0.0;
  for (int i = 0; i < points; ++i) {
    const Vec3 p_OP = turned ? feature.corners.corners[static_cast<std::size_t>(i)] : Vec3(Vec3::Zero());
    const Vec3 p = X_CO * p_OP;
    const Vec3 p_star = goal * p_OP;
    sum2 += std::pow(scene.camera.U(p) - scene.camera.U(p_star), 2) +
            std::pow(scene.camera.V(p) - scene.camera.V(p_star), 2);
  }
  return std::sqrt(sum2 / points);
}

std::optional<Rejection> Sampler::Refusal(const StartPosture& posture, const Pose& X_BO) const {
  const StartChecks& checks = goals_.checks();
  return !checks.InsideBarrier(posture)                     ? std::optional(Rejection::kStartOutsideBarrier)
         : !checks.ClearOfSolids(posture)                   ? std::optional(Rejection::kStartNearSolid)
         : !checks.InPicture(posture.X_BC.Inverse() * X_BO) ? std::optional(Rejection::kTargetNearEdge)
         : !checks.InReach(posture.X_BC.Inverse() * X_BO)   ? std::optional(Rejection::kTargetOutOfReach)
         : !checks.TargetAboveTable(X_BO)                   ? std::optional(Rejection::kTargetBelowTable)
         : checks.ArmInTheWay(posture, X_BO)                ? std::optional(Rejection::kArmInTheWay)
         : checks.BenchInTheWay(posture, X_BO)              ? std::optional(Rejection::kThingInTheWay)
                                                            : std::nullopt;
}

void Sampler::Describe(Start& start) const {
  const Scene& scene = goals_.checks().scene();
  const VecN q = Eigen::Map<const VecN>(start.q.data(), static_cast<Eigen::Index>(start.q.size()));
  const Pose X_CO = goals_.checks().At(q).X_BC.Inverse() * start.TargetPose();
  start.u_px = scene.camera.U(X_CO.p);
  start.v_px = scene.camera.V(X_CO.p);
  start.depth = X_CO.p.z();
  start.tilt_deg = std::acos(std::clamp(X_CO.R(2, 2), -1.0, 1.0)) / kRadPerDeg;
  start.error_px = ErrorPx(X_CO);
}

Start Sampler::Draw(std::uint64_t seed, int index) const {
  std::seed_seq mixed{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                      static_cast<std::uint32_t>(index)};
  std::mt19937_64 engine(mixed);
  Start start;
  const auto refuse = [&](Rejection reason) { ++start.rejections[static_cast<std::size_t>(reason)]; };
  for (int draw = 0; draw < kMostDraws; ++draw) {
    const StartPosture posture = goals_.checks().At(goals_.DrawPosture(engine));
    // Rounded as in the settings of the run.
    const Pose X_BO = posture.X_BC * DrawTarget(engine);
    start.p_BO = X_BO.p.unaryExpr([](double x) { return Rounded(x, 1e-4); });
    start.rpy_deg = config::RollPitchYawOf(X_BO.R);
    for (double& angle : start.rpy_deg) {
      angle = Rounded(angle, 0.01);
    }
    if (const std::optional<Rejection> refusal = Refusal(posture, start.TargetPose())) {
      refuse(*refusal);
      continue;
    }
    if (goals_.Find(posture.q, start.TargetPose(), {}, engine).empty()) {
      refuse(Rejection::kNoGoalPosture);
      continue;
    }
    start.q.assign(posture.q.begin(), posture.q.end());
    start.way_seed = engine();
    start.run_seed = static_cast<std::uint32_t>(engine() >> 33U);
    Describe(start);
    return start;
  }
  throw std::runtime_error("no feasible start in a million draws");
}

}  // namespace fovea::atlas
