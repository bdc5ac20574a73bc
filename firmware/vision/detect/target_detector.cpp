// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/detect/target_detector.hpp"

#include <algorithm>

namespace fovea::vision {
namespace {

constexpr double kCornerReach =
    1.9;  // distance of corners from the centre, in radii of the circle with that area
constexpr double kRoomShare = 0.3;  // largest distance from the expected place, in radii,
constexpr double kRoomPx = 14.0;    // plus this
constexpr double kSmallPx = 22.0;   // radius below which a reduction by four leaves too few pixels

}  // namespace

TargetDetector::AnyDetector TargetDetector::Make(const DetectorConfig& config) {
  switch (features::TraitsOf(config.kind).body) {
    case features::TargetBody::kBall: return AnyDetector(std::in_place_type<SphereDetector>, config);
    case features::TargetBody::kDisc: return AnyDetector(std::in_place_type<DiscDetector>, config);
    case features::TargetBody::kPlate: break;
  }
  return AnyDetector(std::in_place_type<PolygonDetector>, config);
}

TargetDetector::TargetDetector(const DetectorConfig& config) : config_(config), detector_(Make(config)) {}

Detection TargetDetector::Look(const Picture& image, const cv::Rect& area, int factor) {
  return std::visit([&](auto& detector) { return detector.Look(image, area, factor); }, detector_);
}

Detection TargetDetector::LookAgain(const Picture& image) {
  return std::visit(
      [&](auto& detector) {
        if constexpr (requires { detector.LookAgain(image); }) {
          return detector.LookAgain(image);
        } else {
          return Detection{};
        }
      },
      detector_);
}

cv::Rect TargetDetector::ExpectedArea() const {
  double u = last_.u_px + step_.u_px;
  double v = last_.v_px + step_.v_px;
  config_.intrinsics.Distort(u, v);
  const bool round = features::TraitsOf(config_.kind).body == features::TargetBody::kBall;
  const double reach = (round ? 1.2 : kCornerReach) * (last_.radius_px + std::max(step_.radius_px, 0.0)) +
                       kRoomShare * last_.radius_px + kRoomPx;
  const int left = std::max(0, static_cast<int>(u - reach));
  const int top = std::max(0, static_cast<int>(v - reach));
  const int right = std::min(config_.intrinsics.width_px, static_cast<int>(u + reach) + 1);
  const int bottom = std::min(config_.intrinsics.height_px, static_cast<int>(v + reach) + 1);
  return {left, top, std::max(right - left, 0), std::max(bottom - top, 0)};
}

cv::Rect TargetDetector::FirstLook() const {
  return has_last_ ? ExpectedArea()
                   : cv::Rect(0, 0, config_.intrinsics.width_px, config_.intrinsics.height_px);
}

Detection TargetDetector::Detect(const Picture& image) {
  const cv::Rect whole(0, 0, image.cols, image.rows);
  Detection found;
  found.kind = config_.kind;
  if (has_last_) {
    found = LookAgain(image);
    found.tracked = found.found;
  }
  if (has_last_ && !found.found) {
    const cv::Rect area = ExpectedArea();
    if (area.width > 0 && area.height > 0) {
      found = Look(image, area, last_.radius_px < kSmallPx ? 2 : 4);
      found.tracked = found.found;
    }
  }
  for (const int factor : {4, 2}) {
    if (!found.found && (factor == 4 || config_.by != FindBy::kHough)) {
      found = Look(image, whole, factor);
    }
  }
  if (!found.found) {
    Forget();
    return found;
  }
  const Place now{found.u_px, found.v_px, found.radius_px};
  step_ = has_last_ ? Place{now.u_px - last_.u_px, now.v_px - last_.v_px, now.radius_px - last_.radius_px}
                    : Place{};
  last_ = now;
  has_last_ = true;
  std::visit([](auto& detector) { detector.Keep(); }, detector_);
  return found;
}

void TargetDetector::Forget() {
  has_last_ = false;
  std::visit([](auto& detector) { detector.Forget(); }, detector_);
}

}  // namespace fovea::vision
