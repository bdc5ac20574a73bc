// How far the target is from its goal in the picture, from what a log says the servo and the eye knew of it.
// The same measure as the truth's error: rms over what is judged, which is the corners where the feature
// controls the orientation and the middle where it does not.
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

  // Of s against s_star, as the servo's feature has them [px]; NaN when that is not in the picture.
  [[nodiscard]] float OfTick(const log::Tick& tick) const;
  // Of a measurement against the goal [px]; NaN when nothing was found, or behind the camera.
  [[nodiscard]] float OfMeasurement(const log::Feature& feature) const;

 private:
  using Doubles = google::protobuf::RepeatedField<double>;
  [[nodiscard]] double BetweenPoses(const model::Pose& a, const model::Pose& b) const;

  enum class Form { kRay, kInPicture, kCorners, kPose };
  double f_px_ = 0.0;
  Form form_ = Form::kRay;
  int turns_ = 1;  // of a full one that look alike: 4 of a square
  std::vector<model::Vec3> points_{model::Vec3::Zero()};
  model::Pose X_CO_star_;
};

}  // namespace fovea::report
