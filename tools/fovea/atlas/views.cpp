// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/views.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "firmware/core/model/rotation.hpp"
#include "firmware/host/config/roll_pitch_yaw.hpp"

namespace fovea::atlas {
namespace {

using model::Pose;
using model::Vec3;
using model::VecN;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kTurnLeast = 2.7 * kRadPerDeg;
constexpr double kTurnMost = 180.0 * kRadPerDeg;
constexpr double kTurnPower = 1.42;  // of a uniform number: half of all turns are below 69 degrees
constexpr double kShiftLeast = 0.013;
constexpr double kShiftMost = 0.493;
constexpr double kDistanceLeast = 0.5;
constexpr double kDistanceMost = 0.9;
constexpr double kTiltMost = 30.0 * kRadPerDeg;
constexpr int kMostDraws = 1'000'000;

// Uniform on the unit sphere.
Vec3 DrawDirection(std::mt19937_64& engine) {
  const double z = Uniform(engine, -1.0, 1.0);
  const double about = Uniform(engine, -std::numbers::pi, std::numbers::pi);
  const double across = std::sqrt(1.0 - z * z);
  return {across * std::cos(about), across * std::sin(about), z};
}

// As it stands in the file.
Pose Rounded(const Pose& X) {
  std::array<double, 3> rpy = config::RollPitchYawOf(X.R);
  for (double& angle : rpy) {
    angle = std::round(angle / 1e-3) * 1e-3;
  }
  return {config::RollPitchYaw({rpy.begin(), rpy.end()}),
          X.p.unaryExpr([](double x) { return std::round(x / 1e-5) * 1e-5; })};
}

Goal DrawGoal(std::mt19937_64& engine) {
  const double tilt = Uniform(engine, 0.0, kTiltMost);
  const double about = Uniform(engine, -std::numbers::pi, std::numbers::pi);
  const double turn = Uniform(engine, -std::numbers::pi, std::numbers::pi);
  const Pose X_CO = Rounded({model::RotationOf({tilt * std::cos(about), tilt * std::sin(about), 0.0}) *
                                 model::RotationOf({0.0, 0.0, turn}),
                             {0.0, 0.0, Uniform(engine, kDistanceLeast, kDistanceMost)}});
  const std::array<double, 3> rpy = config::RollPitchYawOf(X_CO.R);
  return {{X_CO.p.x(), X_CO.p.y(), X_CO.p.z()}, {rpy.begin(), rpy.end()}};
}

std::string PoseInCsv(const Pose& X) {
  const std::array<double, 3> rpy = config::RollPitchYawOf(X.R);
  return fmt::format("{:.5f},{:.5f},{:.5f},{:.3f},{:.3f},{:.3f}", X.p.x(), X.p.y(), X.p.z(), rpy[0], rpy[1],
                     rpy[2]);
}

}  // namespace

ViewPair DrawViewPair(const Scene& scene, std::uint64_t seed, int index) {
  std::seed_seq mixed{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                      static_cast<std::uint32_t>(index)};
  std::mt19937_64 engine(mixed);
  ViewPair pair;
  pair.turn = kTurnLeast + (kTurnMost - kTurnLeast) * std::pow(Uniform(engine, 0.0, 1.0), kTurnPower);
  pair.shift = Uniform(engine, kShiftLeast, kShiftMost);
  for (int draw = 0; draw < kMostDraws; ++draw) {
    pair.goal = DrawGoal(engine);
    const Sampler sampler(WithGoal(scene, pair.goal));
    const GoalPostures& postures = sampler.goals();
    const StartChecks& checks = postures.checks();
    const features::TargetFeature& feature = checks.scene().servo.feature;
    const StartPosture at_goal = checks.At(postures.DrawPosture(engine));
    const Pose X_CO_star{feature.R_CO_star, feature.p_CO_C_star};
    pair.X_BO = Rounded(at_goal.X_BC * X_CO_star);
    const Vec3 axis = DrawDirection(engine);
    const Vec3 shift = pair.shift * DrawDirection(engine);
    pair.X_BC = Rounded(at_goal.X_BC * Pose{model::RotationOf(pair.turn * axis), shift});
    const Pose X_CO = pair.X_BC.Inverse() * pair.X_BO;
    if (!checks.TargetAboveTable(pair.X_BO) || !checks.InPicture(X_CO) || !checks.InPicture(X_CO_star) ||
        !checks.InReach(X_CO) || !checks.StandsAtGoal(at_goal, pair.X_BO)) {
      continue;
    }
    const auto is_allowed = [&](const VecN& q) { return !sampler.Refusal(checks.At(q), pair.X_BO); };
    if (postures.WithCameraAt(pair.X_BC, is_allowed)) {
      pair.refused = draw;
      return pair;
    }
  }
  throw std::runtime_error("no feasible pair of views in a million draws");
}

std::string ViewsAsCsv(const Scene& scene, std::uint64_t seed, int pairs,
                       const std::function<void(int, int)>& on_pair) {
  std::string text = fmt::format(
      "# {} pairs of views, drawn with seed {}: the camera's turn and shift from start to goal are in the "
      "comments.\n"
      "camera_x,camera_y,camera_z,camera_roll,camera_pitch,camera_yaw,"
      "target_x,target_y,target_z,target_roll,target_pitch,target_yaw,"
      "goal_x,goal_y,goal_z,goal_roll,goal_pitch,goal_yaw,seed\n",
      pairs, seed);
  int refused = 0;
  for (int index = 0; index < pairs; ++index) {
    const ViewPair pair = DrawViewPair(scene, seed, index);
    const Pose X_CO{config::RollPitchYaw(pair.goal.rpy_deg),
                    {pair.goal.xyz[0], pair.goal.xyz[1], pair.goal.xyz[2]}};
    text += fmt::format("# {:.1f} deg, {:.0f} mm\n{},{},{},{}\n", pair.turn / kRadPerDeg, 1e3 * pair.shift,
                        PoseInCsv(pair.X_BC), PoseInCsv(pair.X_BO), PoseInCsv(X_CO), index + 1);
    refused += pair.refused;
    if (on_pair) {
      on_pair(index + 1, refused);
    }
  }
  return text;
}

}  // namespace fovea::atlas
