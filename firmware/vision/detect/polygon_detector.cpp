// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/detect/polygon_detector.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "firmware/vision/detect/acceptance.hpp"
#include "firmware/vision/find/colour_share.hpp"
#include "firmware/vision/pose/flat_corners.hpp"

namespace fovea::vision {
namespace {

constexpr double kMaxOffPx = 0.8;      // limit of the corners' rms distance from the pose's corners
constexpr double kMaxOffPartPx = 0.3;  // the same if a part is hidden
constexpr double kMostAgainst = 0.08;  // share of the sides without the target or an object that hides it
constexpr int kMostCornersHidden = 1;  // with two, their places along the sides are undetermined
constexpr double kLeastSeen = 0.35;    // seen share of each side
constexpr double kLeastOn = 0.6;       // share of a side's edges on its line; less means two objects
constexpr double kPartRmsPx = 0.06;    // limit of the edges' rms distance if a part is hidden,
constexpr double kWholeRmsPx = 0.12;   // and if no part is hidden,
constexpr double kNoiseRms = 1.6;      // plus this times noise / contrast
constexpr double kPartSigmaPx = 0.3;   // limit of a corner's standard deviation if a part is hidden,
constexpr double kNoiseSigma = 2.0;    // plus this times noise / contrast
constexpr double kGoesOnShare = 0.25;  // of the contrast; low, as a covering object may have any brightness
constexpr double kGoesOnSigmas = 1.3;  // of the noise; the step is a mean over 27 pairs of samples
constexpr int kMostFits = 12;

// Whether the fitted sides belong to the target, judged by the colours beside them.
bool IsTargets(const PolygonFit& fit) {
  if (fit.against > kMostAgainst || fit.corners_hidden > kMostCornersHidden || fit.least_seen < kLeastSeen ||
      fit.least_on < kLeastOn) {
    return false;
  }
  // Next to a covering object, the edges of two objects can look like one blurred edge.
  const double noise = fit.quiet / std::max(fit.contrast, 1.0);
  const double scatter = (fit.whole ? kWholeRmsPx : kPartRmsPx) + kNoiseRms * noise;
  const double sigma = kPartSigmaPx + kNoiseSigma * noise;
  if (!fit.whole && fit.corners.cov.diagonal().maxCoeff() > sigma * sigma) {
    return false;  // such an uncertain corner may be anywhere
  }
  // Four corners need no explanation of bends: with a side of another object they fit no pose of the target.
  return fit.rms_px < scatter && (fit.whole || fit.bends_explained || fit.corners.count > 3);
}

}  // namespace

PolygonDetector::PolygonDetector(const DetectorConfig& config)
    : config_(config),
      shape_(FlatCorners(config.corners)),
      turns_(features::TraitsOf(config.kind).turns),
      colour_(config.colour),
      fitter_(config.edge_noise, config.by == FindBy::kColour) {
  if (static_cast<int>(shape_.size()) != features::TraitsOf(config.kind).num_corners) {
    throw std::invalid_argument("the number of corners does not match the kind of target");
  }
  double area = 0.0;
  double side = 1e9;
  for (std::size_t i = 0; i < shape_.size(); ++i) {
    const Eigen::Vector2d& a = shape_[i];
    const Eigen::Vector2d& b = shape_[(i + 1) % shape_.size()];
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
    side = std::min(side, (b - a).norm());
  }
  const double f = std::max(config.intrinsics.f_u_px, config.intrinsics.f_v_px);
  const double r = f * std::sqrt(area / std::numbers::pi);
  limits_.radius_min_px = std::max(config.radius_min_px, 0.5 * r / config.distance_max);
  limits_.radius_max_px = std::min(config.radius_max_px, 1.6 * r / config.distance_min);
  limits_.side_min_px = std::max(10.0, 0.3 * f * side / config.distance_max);
}

Detection PolygonDetector::Look(const Picture& image, const cv::Rect& area, int factor) {
  Detection best;
  best.kind = config_.kind;
  map_.Find(image, area, factor, config_.by == FindBy::kColour && image.channels() == 3 ? &colour_ : nullptr);
  int fits = 0;
  for (const PolygonCandidate& candidate : finder_.Find(map_, static_cast<int>(shape_.size()), limits_)) {
    if (best.confidence > kSureConfidence || ++fits > kMostFits) {
      break;
    }
    Judge(image, candidate, best);
  }
  return best;
}

// Fits from `start`. Replaces `best` if the fit has a higher confidence.
void PolygonDetector::Judge(const Picture& image, const PolygonCandidate& start, Detection& best) {
  const auto n = shape_.size();
  const PolygonFit fit = fitter_.Fit(image, config_.intrinsics, std::span(start.corner).first(n));
  const double radius = RadiusOf(std::span(fit.corners.corner).first(n));
  const double most = MostRmsPx(fit.noise_px, radius);
  if (!fit.converged || fit.rms_px > most || !IsTargets(fit)) {
    return;
  }
  const double sharp = 1.0 - fit.rms_px / most;
  const double confidence = std::clamp(fit.seen * std::min(1.0, 0.6 + sharp), 0.0, 1.0);
  if (confidence < config_.confidence_min || confidence <= best.confidence) {
    return;
  }
  const std::span corners = std::span(fit.corners.corner).first(n);
  if (config_.by == FindBy::kColour && ColourShare(image, corners) < kMinColourShare) {
    return;
  }
  // Skipped if the target's colour is known: a shadow beside the target would look the same.
  const double step = std::max(kGoesOnShare * fit.contrast, kGoesOnSigmas * fit.quiet);
  if (config_.by == FindBy::kGray &&
      fitter_.evidence().SideGoesOn(image, config_.intrinsics, corners, step)) {
    return;
  }
  CornerPoses found =
      PosesOfCorners(fit.corners, config_.intrinsics, shape_, turns_, X_CO_ ? &*X_CO_ : nullptr);
  DropPosesOutOfReach(found);
  if (found.count == 0) {
    return;
  }
  const auto poses = std::span(found.pose).first(static_cast<std::size_t>(found.count));
  const CornerPose& pose = poses.front();
  const double corner_sigma = std::sqrt(fit.corners.cov.trace() / static_cast<double>(n));
  if (pose.off_px > (fit.whole ? kMaxOffPx : kMaxOffPartPx) + 3.0 * corner_sigma) {
    return;
  }
  Detection d;
  d.kind = config_.kind;
  d.found = true;
  d.confidence = confidence;
  d.rms_px = fit.rms_px;
  d.contrast = fit.contrast;
  d.seen = fit.seen;
  // Sides that a border beside the target has shifted fit no pose: the misfit shows their error.
  CornerFit honest = fit.corners;
  honest.cov *= pose.misfit;
  SetCorners(honest, pose.first, d);
  for (const CornerPose& p : poses) {
    const int first = (p.first - pose.first + static_cast<int>(n)) % static_cast<int>(n);
    d.pose[static_cast<std::size_t>(d.pose_count++)] = {p.X_CO, first};
  }
  d.cov_pose = pose.cov;
  d.corner_count = static_cast<int>(n);
  d.outline_count = d.corner_count;
  d.radius_px = RadiusOf(corners);
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, CornerFit::kMaxSize> uvr(3,
                                                                                        2 * d.corner_count);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t from = (static_cast<std::size_t>(pose.first) + i) % n;
    d.corner[i] = corners[from];
    d.outline[i] = corners[from];
    d.u_px += corners[i].u_px / static_cast<double>(n);
    d.v_px += corners[i].v_px / static_cast<double>(n);
    // d(area)/d(corner) is half the diagonal across the corner, turned by 90 deg; radius = sqrt(area / pi).
    const ImagePoint& before = corners[(i + n - 1) % n];
    const ImagePoint& after = corners[(i + 1) % n];
    const double scale = 0.5 / (2.0 * std::numbers::pi * d.radius_px);
    const auto k = static_cast<Eigen::Index>(2 * i);
    uvr.col(k) << 1.0 / static_cast<double>(n), 0.0, scale * (after.v_px - before.v_px);
    uvr.col(k + 1) << 0.0, 1.0 / static_cast<double>(n), -scale * (after.u_px - before.u_px);
  }
  d.cov_uvr_px2 = uvr * fit.corners.cov * uvr.transpose();
  best = d;
  best_X_CO_ = pose.X_CO;
}

// Removes poses at impossible distances: three corners allow several poses, and the first can be false.
void PolygonDetector::DropPosesOutOfReach(CornerPoses& found) const {
  const auto out = [this](const CornerPose& pose) {
    const double distance = pose.X_CO.p.norm();
    return distance < config_.distance_min || distance > config_.distance_max;
  };
  const auto end = found.pose.begin() + found.count;
  found.count = static_cast<int>(std::remove_if(found.pose.begin(), end, out) - found.pose.begin());
}

// Sets s and cov_s: the corners in the normalised image, starting with `first`.
void PolygonDetector::SetCorners(const CornerFit& fit, int first, Detection& d) const {
  const int n = fit.count;
  const Intrinsics& in = config_.intrinsics;
  const Eigen::Vector2d scale(1.0 / in.f_u_px, 1.0 / in.f_v_px);
  d.s.resize(2 * n);
  d.cov_s.resize(2 * n, 2 * n);
  for (int i = 0; i < n; ++i) {
    const int from = (first + i) % n;
    const ImagePoint& c = fit.corner[static_cast<std::size_t>(from)];
    d.s.segment<2>(2 * i) = in.Ray(c.u_px, c.v_px).head<2>();
    for (int j = 0; j < n; ++j) {
      d.cov_s.block<2, 2>(2 * i, 2 * j) =
          scale.asDiagonal() * fit.cov.block<2, 2>(2 * from, 2 * ((first + j) % n)) * scale.asDiagonal();
    }
  }
}

// Over points between the centre and the outline.
double PolygonDetector::ColourShare(const Picture& image, std::span<const ImagePoint> corners) const {
  constexpr int kPerSide = 8;
  constexpr std::array<double, 3> kOut{0.25, 0.55, 0.8};
  std::array<ImagePoint, Detection::kMaxCorners * kPerSide * kOut.size()> points;
  ImagePoint middle;
  for (const ImagePoint& corner : corners) {
    middle.u_px += corner.u_px / static_cast<double>(corners.size());
    middle.v_px += corner.v_px / static_cast<double>(corners.size());
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const ImagePoint& a = corners[i];
    const ImagePoint& b = corners[(i + 1) % corners.size()];
    for (int k = 0; k < kPerSide; ++k) {
      const double t = (k + 0.5) / kPerSide;
      for (const double out : kOut) {
        ImagePoint p{middle.u_px + out * (a.u_px + t * (b.u_px - a.u_px) - middle.u_px),
                     middle.v_px + out * (a.v_px + t * (b.v_px - a.v_px) - middle.v_px)};
        config_.intrinsics.Distort(p.u_px, p.v_px);
        points[count++] = p;
      }
    }
  }
  return vision::ColourShare(image, colour_, std::span(points).first(count));
}

}  // namespace fovea::vision
