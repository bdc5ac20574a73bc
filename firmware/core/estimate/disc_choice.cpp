#include "firmware/core/estimate/disc_choice.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/model/rotation.hpp"

namespace fovea::estimate {
namespace {

using model::Vec3;
using View = DiscChoice::View;

constexpr double kAspect = 7.0;         // of a half axis' share of noise: what a tilt must show [sigma]
constexpr double kCalibration = 0.01;   // what arm, camera and lens are not known to [rad]
constexpr double kSwitchMargin = 12.0;  // so much less misfit, and another normal is believed [sigma^2]
constexpr double kStill = 8.0;          // a disc whose best normal fits worse, per view, turns [sigma^2]
constexpr double kOther = 0.15;         // normals nearer to each other than this are one [rad]
constexpr int kRounds = 2;

// Which of a view's normals is nearer to `normal`.
std::size_t Nearer(const View& view, const Vec3& normal) noexcept {
  return view.normal_B[0].dot(normal) >= view.normal_B[1].dot(normal) ? 0 : 1;
}

// A disc's aspect is the cosine of its tilt: noise of the one, over the sine, is noise of the other, and
// where the sine vanishes its square root.
double WeightOf(const View& view, double share) noexcept {
  const double aspect = kAspect * share;
  const double cosine = view.normal_B[0].dot(view.ray_B);
  const double sine2 = std::max(1.0 - cosine * cosine, 0.0);
  const double variance = aspect * aspect / std::max(sine2, 0.5 * aspect);
  return 1.0 / (variance + kCalibration * kCalibration);
}

bool ViewOf(const hal::FeatureMeasurement& measurement, const model::Pose& X_BC, View& view) noexcept {
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

// Improves `normal` by what all views and `newest` say; how badly it then fits.
double Fit(const DiscChoice& choice, const View& newest, Vec3& normal) noexcept {
  double misfit = 0.0;
  for (int round = 0; round <= kRounds; ++round) {
    Vec3 sum = Vec3::Zero();
    misfit = 0.0;
    const auto add = [&](const View& view) {
      const Vec3& seen = view.normal_B[Nearer(view, normal)];
      misfit += view.weight * (seen - normal).squaredNorm();
      sum += view.weight * seen;
    };
    add(newest);
    std::for_each(choice.views.begin(), choice.views.begin() + choice.count, add);
    if (round < kRounds) {
      normal = sum.normalized();
    }
  }
  return misfit;
}

void Keep(const View& view, DiscChoice& choice) noexcept {
  if (choice.count > 0) {
    const View& last = choice.views[static_cast<std::size_t>(choice.count - 1)];
    if (!((last.ray_B - view.ray_B).norm() >= choice.step)) {
      return;
    }
  }
  if (choice.count == DiscChoice::kMost) {
    for (std::size_t i = 1; 2 * i < DiscChoice::kMost; ++i) {
      choice.views[i] = choice.views[2 * i];
    }
    choice.count = DiscChoice::kMost / 2;
    choice.step *= 2.0;
  }
  choice.views[static_cast<std::size_t>(choice.count++)] = view;
}

}  // namespace

int ChooseDisc(const hal::FeatureMeasurement& measurement, const model::Pose& X_BC, DiscChoice& choice,
               bool& changed) noexcept {
  changed = false;
  View view;
  if (!ViewOf(measurement, X_BC, view)) {
    return 0;
  }
  if (!choice.started) {
    choice.started = true;
    choice.normal_B = view.normal_B[0];
  }
  const Vec3 before = choice.normal_B;
  Vec3 best = before;
  double least = Fit(choice, view, best) - kSwitchMargin;
  for (const Vec3& seen : view.normal_B) {
    Vec3 normal = seen;
    const double misfit = Fit(choice, view, normal);
    if (misfit < least) {
      least = misfit;
      best = normal;
    }
  }
  if (least > kStill * static_cast<double>(choice.count + 1)) {
    // It turns: what it showed before says nothing more, but that it turned on from there.
    choice.count = 0;
    best = view.normal_B[Nearer(view, before)];
  }
  choice.normal_B = best;
  Keep(view, choice);
  changed = (best - before).norm() > kOther;
  return static_cast<int>(Nearer(view, best));
}

}  // namespace fovea::estimate
