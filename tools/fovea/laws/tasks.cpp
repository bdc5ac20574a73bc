// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/laws/tasks.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <numbers>

#include "firmware/core/features/target_traits.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::laws {
namespace {

using model::Pose;
using model::Vec3;

constexpr double kRad = std::numbers::pi / 180.0;

// The target lies before the arm, above the table, and faces up.
const Vec3 kPlace_B(0.35, 0.0, 0.02);
const std::array<double, 3> kRpyDeg{180.0, 0.0, 0.0};

// A start: the camera in its goal's frame D.
struct Canonical {
  std::string name;
  Pose X_DC;
};

Pose Turned(const Vec3& phi) { return {model::RotationOf(phi), Vec3::Zero()}; }
Pose Moved(const Vec3& p) { return {model::Mat3::Identity(), p}; }

// The camera after a turn about an axis through the target's centre, which is at `p_DO` when it is at its
// goal.
Pose TurnedAbout(const Vec3& p_DO, const Vec3& phi) { return Moved(p_DO) * Turned(phi) * Moved(-p_DO); }

std::vector<Canonical> CanonicalTasks(const Vec3& p_DO, int turns) {
  std::vector<Canonical> tasks;
  for (const int deg : {30, 45, 60, 90, 120, 150, 180}) {
    if (deg * turns <= 180) {
      tasks.push_back(
          {fmt::format("turn about the optical axis by {} deg", deg), Turned({0.0, 0.0, deg * kRad})});
    }
  }
  for (const int mm : {-300, -200, -100, 150}) {
    tasks.push_back(
        {fmt::format("{} by {} mm along the optical axis", mm > 0 ? "nearer" : "away", std::abs(mm)),
         Moved({0.0, 0.0, 1e-3 * mm})});
  }
  for (const int deg : {10, 20, 30, 40}) {
    tasks.push_back({fmt::format("turn of the target's plane by {} deg", deg),
                     TurnedAbout(p_DO, {deg * kRad, 0.0, 0.0})});
  }
  for (const double share : {0.5, 1.0}) {
    const Vec3 phi(0.35 * share, -0.25 * share, 0.7 * share);
    tasks.push_back({fmt::format("general motion, {}", share < 1.0 ? "half" : "whole"),
                     Moved(share * Vec3(0.06, -0.05, -0.12)) * TurnedAbout(p_DO, phi)});
  }
  return tasks;
}

}  // namespace

Tasks TasksFor(const atlas::Scene& scene, int random, std::uint64_t seed) {
  const features::TargetFeature& feature = scene.servo.feature;
  const atlas::Sampler sampler(scene);
  Tasks tasks;
  for (const Canonical& canonical :
       CanonicalTasks(feature.p_CO_C_star, features::TraitsOf(feature.target).turns)) {
    atlas::Start start;
    start.p_BO = kPlace_B;
    start.rpy_deg = kRpyDeg;
    start.run_seed = 1;
    const Pose X_BO = start.TargetPose();
    const Pose X_BD = X_BO * Pose{feature.R_CO_star, feature.p_CO_C_star}.Inverse();
    const auto is_allowed = [&](const model::VecN& q) {
      return !sampler.Refusal(sampler.goals().checks().At(q), X_BO);
    };
    const auto q = sampler.goals().WithCameraAt(X_BD * canonical.X_DC, is_allowed);
    if (!q) {
      tasks.skipped.push_back(canonical.name);
      continue;
    }
    start.q.assign(q->begin(), q->end());
    sampler.Describe(start);
    tasks.tasks.push_back({canonical.name, false, start});
  }
  for (int i = 0; i < random; ++i) {
    tasks.tasks.push_back({fmt::format("random {}", i), true, sampler.Draw(seed, i)});
  }
  return tasks;
}

}  // namespace fovea::laws
