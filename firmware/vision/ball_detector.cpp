#include "fovea/vision/ball_detector.hpp"

#include <algorithm>
#include <cmath>

#include "fovea/features/sphere.hpp"

namespace fovea::vision {
namespace {

constexpr double kMaxRmsPx = 0.6;        // edge points further about the outline: it is no ball's
constexpr double kMinColourShare = 0.6;  // of the inside that must look like the target

// How far the ball may be from where it is expected, before it is searched for anew.
double TrackSearchPx(const Circle& expected) { return std::max(6.0, 0.25 * expected.radius_px); }

}  // namespace

BallDetector::BallDetector(const BallDetectorConfig& config) : config_(config), finder_(config.finder) {}

BallDetection BallDetector::Detect(const cv::Mat& image) {
  BallDetection best;
  if (has_last_) {
    const Circle expected{last_.u_px + step_.u_px, last_.v_px + step_.v_px,
                          last_.radius_px + step_.radius_px};
    best = Judge(image, FitOutline(image, config_.intrinsics, expected, TrackSearchPx(expected)));
    best.tracked = best.found;
  }
  if (!best.found) {
    for (const Circle& candidate : finder_.Find(image)) {
      const double search = std::max(6.0, 0.2 * candidate.radius_px);
      const BallDetection detection = Judge(image, FitOutline(image, config_.intrinsics, candidate, search));
      if (detection.found && detection.confidence > best.confidence) {
        best = detection;
      }
    }
  }
  if (!best.found) {
    has_last_ = false;
    return best;
  }
  const Circle now{best.outline.u_px, best.outline.v_px, best.outline.radius_px};
  step_ = has_last_ ? Circle{now.u_px - last_.u_px, now.v_px - last_.v_px, now.radius_px - last_.radius_px}
                    : Circle{};
  last_ = now;
  has_last_ = true;
  return best;
}

BallDetection BallDetector::Judge(const cv::Mat& image, const OutlineFit& outline) const {
  BallDetection detection;
  detection.outline = outline;
  if (!outline.converged || outline.rms_px > kMaxRmsPx) {
    return detection;
  }
  model::Mat3 ds_dm;
  if (!features::SphereFromCone(outline.m, detection.s, ds_dm)) {
    return detection;
  }
  const double distance = detection.s.norm() * config_.radius;
  if (distance < config_.distance_min || distance > config_.distance_max) {
    return detection;
  }
  const double colour = ColourShare(image, outline);
  if (colour < kMinColourShare) {
    return detection;
  }
  detection.cov_s = ds_dm * outline.cov_m * ds_dm.transpose();
  // A whole, sharp, rightly coloured outline counts 1; half an outline counts half.
  const double sharp = 1.0 - outline.rms_px / kMaxRmsPx;
  detection.confidence = std::clamp(outline.seen * std::min(1.0, 0.5 + sharp), 0.0, 1.0);
  detection.found = detection.confidence >= config_.confidence_min;
  return detection;
}

// The share of points inside the outline, on rings out to 0.85 of its radius, that look like the target.
double BallDetector::ColourShare(const cv::Mat& image, const OutlineFit& outline) const {
  if (image.channels() == 1) {
    return 1.0;
  }
  constexpr int kRings = 5;
  constexpr int kPerRing = 16;
  double sum = 0.0;
  int count = 0;
  for (int ring = 1; ring <= kRings; ++ring) {
    const double r = 0.85 * outline.radius_px * ring / kRings;
    for (int i = 0; i < kPerRing; ++i) {
      const double angle = 2.0 * CV_PI * i / kPerRing;
      const int x = static_cast<int>(std::lround(outline.u_px + r * std::cos(angle)));
      const int y = static_cast<int>(std::lround(outline.v_px + r * std::sin(angle)));
      if (x < 1 || y < 1 || x >= image.cols - 1 || y >= image.rows - 1) {
        continue;
      }
      // The mean of a 3 x 3 patch, so that noise in a dark image does not turn the hue.
      cv::Vec3d mean(0.0, 0.0, 0.0);
      for (int dy = -1; dy <= 1; ++dy) {
        const cv::Vec3b* row = image.ptr<cv::Vec3b>(y + dy);
        for (int dx = -1; dx <= 1; ++dx) {
          mean += cv::Vec3d(row[x + dx]);
        }
      }
      sum += finder_.Likeness(mean[0] / 9.0, mean[1] / 9.0, mean[2] / 9.0) > 0.3 ? 1.0 : 0.0;
      ++count;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

}  // namespace fovea::vision
