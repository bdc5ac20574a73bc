// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/disc_fit.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/model/rotation.hpp"

namespace fovea::estimate {
namespace {

using model::Vec3;

constexpr double kAspect = 7.0;           // noise of the aspect, in units of a half axis' relative noise
constexpr double kCalibrationRad = 0.01;  // uncertainty of arm, camera and lens [rad]
constexpr int kRounds = 2;

// A disc's aspect is the cosine of its tilt. The tilt's noise is the aspect's noise over the sine, or the
// square root of the aspect's noise where the sine vanishes.
double WeightOf(const DiscView& view, double share) noexcept {
  const double aspect = kAspect * share;
  const double cosine = view.normal_B[0].dot(view.ray_B);
  const double sine2 = std::max(1.0 - cosine * cosine, 0.0);
  const double variance = aspect * aspect / std::max(sine2, 0.5 * aspect);
  return 1.0 / (variance + kCalibrationRad * kCalibrationRad);
}

}  // namespace

bool SeeDisc(const hal::FeatureMeasurement& measurement, const model::Pose& X_BC, DiscView& view) noexcept {
  for (std::size_t i = 0; i < 2; ++i) {
    model::Mat3 R_CO;
    if (!model::RotationOfQuaternion(measurement.poses[i].q_CO, R_CO)) {
      return false;
    }
    view.normal_B[i] = X_BC.R * R_CO.col(2);
  }
  const auto& p = measurement.poses[0].p_CO_C;
  view.ray_B = X_BC.R * Vec3(p[0], p[1], p[2]).normalized();
  view.weight = WeightOf(view, std::sqrt(measurement.cov_s[2 * hal::kMaxFeatureDim + 2]) / measurement.s[2]);
  return view.ray_B.allFinite() && std::isfinite(view.weight);
}

double FitNormal(std::span<const DiscView> views, const DiscView& newest, Vec3& normal) noexcept {
  double misfit = 0.0;
  for (int round = 0; round <= kRounds; ++round) {
    Vec3 sum = Vec3::Zero();
    misfit = 0.0;
    const auto add = [&](const DiscView& view) {
      const Vec3& seen = view.normal_B[static_cast<std::size_t>(Nearer(view, normal))];
      misfit += view.weight * (seen - normal).squaredNorm();
      sum += view.weight * seen;
    };
    add(newest);
    std::for_each(views.begin(), views.end(), add);
    if (round < kRounds) {
      normal = sum.normalized();
    }
  }
  return misfit;
}

}  // namespace fovea::estimate
