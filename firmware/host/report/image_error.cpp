// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/report/image_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/core/features/target_traits.hpp"
#include "firmware/core/model/math.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::report {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Squared distance of two points in the normalised image; NaN when one is not in front of the camera.
double Apart2(const model::Vec3& a, const model::Vec3& b) {
  if (!(a.z() > 0.0) || !(b.z() > 0.0)) {
    return kNan;
  }
  const double dx = a.x() / a.z() - b.x() / b.z();
  const double dy = a.y() / a.z() - b.y() / b.z();
  return dx * dx + dy * dy;
}

template <typename Doubles>
model::Vec3 ThreeOf(const Doubles& values, int first) {
  return {values[first], values[first + 1], values[first + 2]};
}

}  // namespace

ImageError::ImageError(const log::Setup& setup) : f_px_(setup.f_px()) {
  const std::string& form = setup.feature();
  form_ = form == "corners"                                             ? Form::kCorners
          : form == "pose"                                              ? Form::kPose
          : form == "circle" || form == "side" || form == "corner_side" ? Form::kInPicture
                                                                        : Form::kRay;
  if (setup.p_co_c_star_size() == 3) {
    X_CO_star_.p = ThreeOf(setup.p_co_c_star(), 0);
  }
  if (setup.q_co_star_size() == 4) {
    const auto& q = setup.q_co_star();
    static_cast<void>(model::RotationOfQuaternion({q[0], q[1], q[2], q[3]}, X_CO_star_.R));
  }
  if (form_ == Form::kCorners || form_ == Form::kPose) {
    const features::TargetTraits* traits = features::FindTraits(setup.target());
    turns_ = traits != nullptr ? traits->turns : 1;
    points_.clear();
    for (int i = 0; i + 1 < setup.corners_size(); i += 2) {
      points_.emplace_back(setup.corners(i), setup.corners(i + 1), 0.0);
    }
  }
}

// Rms distance of the points in the normalised image, for the nearest of the turns of `a` that look alike.
double ImageError::BetweenPoses(const model::Pose& a, const model::Pose& b) const {
  double least2 = kNan;
  for (int turn = 0; turn < turns_; ++turn) {
    const model::Mat3 R = a.R * model::RotationOf(model::Vec3(0.0, 0.0, 2.0 * model::kPi * turn / turns_));
    double sum2 = 0.0;
    for (const model::Vec3& p : points_) {
      sum2 += Apart2(a.p + R * p, b * p);
    }
    least2 = std::fmin(least2, sum2 / static_cast<double>(points_.size()));  // ignores NaN
  }
  return std::sqrt(least2);
}

float ImageError::OfTick(const log::Tick& tick) const {
  const Doubles& s = tick.s();
  const Doubles& s_star = tick.s_star();
  const int needed = form_ == Form::kPose      ? 6
                     : form_ == Form::kCorners ? 2 * static_cast<int>(points_.size())
                                               : 3;
  double off = kNan;
  if (std::min(s.size(), s_star.size()) < needed) {
    return static_cast<float>(off);
  }
  switch (form_) {
    case Form::kRay: off = std::sqrt(Apart2(ThreeOf(s, 0), ThreeOf(s_star, 0))); break;
    case Form::kInPicture: off = std::hypot(s[0] - s_star[0], s[1] - s_star[1]); break;
    case Form::kCorners: {
      double sum2 = 0.0;
      for (int i = 0; i < needed; ++i) {
        sum2 += (s[i] - s_star[i]) * (s[i] - s_star[i]);
      }
      off = std::sqrt(2.0 * sum2 / needed);
      break;
    }
    case Form::kPose: {
      // s = (p_CO_C, phi) with exp([phi]x) = R_CO_star R_CO^T (features/pose.hpp).
      const model::Mat3 R = model::RotationOf(ThreeOf(s, 3)).transpose() * X_CO_star_.R;
      off = BetweenPoses({R, ThreeOf(s, 0)}, {X_CO_star_.R, ThreeOf(s_star, 0)});
      break;
    }
  }
  return static_cast<float>(f_px_ * off);
}

float ImageError::OfMeasurement(const log::Feature& feature) const {
  const Doubles& s = feature.s();
  double off = kNan;
  const auto kind = static_cast<std::size_t>(feature.kind());
  if (!feature.found() || kind >= features::kTargets.size()) {
    return static_cast<float>(off);
  }
  const features::TargetBody body = features::kTargets[kind].body;
  if (body == features::TargetBody::kDisc && s.size() >= 3) {
    off = std::sqrt(Apart2({s[0], s[1], 1.0}, X_CO_star_.p));
  } else if (body == features::TargetBody::kBall && s.size() >= 3) {
    off = std::sqrt(Apart2(ThreeOf(s, 0), X_CO_star_.p));
  } else if (feature.poses_size() > 0 && feature.poses(0).p_co_c_size() == 3 &&
             feature.poses(0).q_co_size() == 4) {
    // All poses look alike in the picture, so the first one is enough.
    const Doubles& q = feature.poses(0).q_co();
    model::Pose X_CO{model::Mat3::Identity(), ThreeOf(feature.poses(0).p_co_c(), 0)};
    if (model::RotationOfQuaternion({q[0], q[1], q[2], q[3]}, X_CO.R)) {
      off = BetweenPoses(X_CO, X_CO_star_);
    }
  }
  return static_cast<float>(f_px_ * off);
}

}  // namespace fovea::report
