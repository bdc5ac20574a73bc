// SPDX-License-Identifier: Apache-2.0
// Image error: distance of the target from its goal in the picture, by the servo's prediction and by the
// measurements in a log. The same measure as the true error: rms over the corners if the feature controls the
// orientation, otherwise the error of the centre.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <vector>

#include "firmware/core/model/types.hpp"
#include "fovea/run.pb.h"
#include "fovea/tick.pb.h"

namespace fovea::report {

class ImageError {
 public:
  ImageError() = default;
  explicit ImageError(const log::Setup& setup);

  // Error of the servo's s against s_star [px]; NaN when s is missing or behind the camera.
  [[nodiscard]] float OfTick(const log::Tick& tick) const;
  // Error of a measurement against the goal [px]; NaN when nothing was found, or behind the camera.
  [[nodiscard]] float OfMeasurement(const log::Feature& feature) const;

 private:
  using Doubles = google::protobuf::RepeatedField<double>;
  [[nodiscard]] double BetweenPoses(const model::Pose& a, const model::Pose& b) const;

  enum class Form { kRay, kInPicture, kCorners, kPose };
  double f_px_ = 0.0;
  Form form_ = Form::kRay;
  int turns_ = 1;  // number of turns that look alike: 4 for a square
  std::vector<model::Vec3> points_{model::Vec3::Zero()};
  model::Pose X_CO_star_;
};

}  // namespace fovea::report
