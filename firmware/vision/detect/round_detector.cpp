// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/detect/round_detector.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "firmware/core/features/sphere.hpp"
#include "firmware/vision/detect/acceptance.hpp"
#include "firmware/vision/find/colour_share.hpp"

namespace fovea::vision {
namespace {

using model::Mat3;
using model::Vec3;

constexpr double kHalfSharp = 0.4;  // an rms distance above 0.4 of the limit reduces the confidence
constexpr int kMostCurveFits = 8;
constexpr double kAsSure = 0.85;     // least share of the last confidence, at the expected place
constexpr double kAsClear = 0.5;     // least share of the last contrast
constexpr double kSameSize = 0.1;    // relative difference of the radius from the expected one
constexpr double kRoundSigma = 7.0;  // an ellipse rounder than this many sigma is taken for a circle

template <class Curve>
constexpr bool kIsSphere = std::is_same_v<Curve, ConeCurve>;

// Sets `curve` to the circle `c` in the image, near enough to start a fit.
void SetCircle(const Intrinsics& in, const Circle& c, ConeCurve& curve) {
  const Vec3 centre = in.Ray(c.u_px, c.v_px);
  const Vec3 rim = in.Ray(c.u_px + c.radius_px, c.v_px);
  const double cosine = centre.dot(rim) / (centre.norm() * rim.norm());
  curve.p = centre / (centre.norm() * cosine);
}
void SetCircle(const Intrinsics& /*in*/, const Circle& c, EllipseCurve& curve) {
  curve.u0_px = c.u_px;
  curve.v0_px = c.v_px;
  curve.size_px = c.radius_px;
  curve.p << 1.0, 0.0, 1.0, 0.0, 0.0;
}

// An orientation with z along `normal`; the turn about z is arbitrary for a disc.
Mat3 AxesAbout(const Vec3& normal) {
  Mat3 R;
  R.col(2) = normal.normalized();
  R.col(1) = R.col(2).cross(std::fabs(R(0, 2)) < 0.9 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
  R.col(0) = R.col(1).cross(R.col(2));
  return R;
}

}  // namespace

template <class Curve>
RoundDetector<Curve>::RoundDetector(const DetectorConfig& config)
    : config_(config), colour_(config.colour), fitter_(config.edge_noise) {
  const double r = 0.5 * config.size * std::max(config.intrinsics.f_u_px, config.intrinsics.f_v_px);
  // An outline is larger away from the optical axis; a tilted disc's is smaller.
  limits_.radius_min_px =
      std::max(config.radius_min_px, (kIsSphere<Curve> ? 0.9 : 0.5) * r / config.distance_max);
  limits_.radius_max_px = std::min(config.radius_max_px, 1.6 * r / config.distance_min);
  limits_.aspect_min = kIsSphere<Curve> ? 0.6 : 0.3;
}

template <class Curve>
Detection RoundDetector<Curve>::Look(const Picture& image, const cv::Rect& area, int factor) {
  Detection best;
  best.kind = config_.kind;
  if (config_.by == FindBy::kHough) {
    for (const Circle& circle :
         hough_.Find(image.Cut(area), config_.hough, limits_.radius_min_px, limits_.radius_max_px)) {
      Curve curve;
      SetCircle(config_.intrinsics, {circle.u_px + area.x, circle.v_px + area.y, circle.radius_px}, curve);
      Judge(image, curve, best);
    }
    return best;
  }
  map_.Find(image, area, factor, config_.by == FindBy::kColour && image.channels() == 3 ? &colour_ : nullptr);
  int fits = 0;
  for (const auto& candidate : finder_.Find(map_, config_.intrinsics, limits_)) {
    if (best.confidence > kSureConfidence || ++fits > kMostCurveFits) {
      break;
    }
    Judge(image, candidate.curve, best);
  }
  return best;
}

template <class Curve>
Detection RoundDetector<Curve>::LookAgain(const Picture& image) {
  Detection found;
  found.kind = config_.kind;
  if (!last_ || config_.by == FindBy::kHough) {
    return found;
  }
  Judge(image, last_->next, found);
  const double radius = EllipseOf(last_->next.Conic(config_.intrinsics)).radius_px;
  if (found.found &&
      (found.confidence < kAsSure * last_->confidence || found.contrast < kAsClear * last_->contrast ||
       std::fabs(found.radius_px - radius) > kSameSize * radius)) {
    found = Detection{};
    found.kind = config_.kind;
  }
  return found;
}

template <class Curve>
void RoundDetector<Curve>::Keep() {
  best_.next = last_ ? best_.curve.Next(last_->curve) : best_.curve;
  last_ = best_;
}

// Fits from `start`. Replaces `best` if the fit has a higher confidence.
template <class Curve>
void RoundDetector<Curve>::Judge(const Picture& image, const Curve& start, Detection& best) {
  const CurveFit<Curve> fit = fitter_.Fit(image, config_.intrinsics, start, kIsSphere<Curve>);
  const double most = MostRmsPx(fit.noise_px, fit.ellipse.radius_px);
  if (!fit.converged || fit.rms_px > most || fit.ellipse.radius_px < 0.8 * limits_.radius_min_px ||
      fit.ellipse.minor_px < 0.9 * limits_.aspect_min * fit.ellipse.major_px) {
    return;
  }
  // A whole and sharp outline has confidence 1, half an outline 0.5.
  const double sharp = 1.0 - fit.rms_px / most;
  const double confidence = std::clamp(fit.seen * std::min(1.0, kHalfSharp + sharp), 0.0, 1.0);
  if (confidence < config_.confidence_min || confidence <= best.confidence) {
    return;
  }
  if (config_.by == FindBy::kColour && ColourShare(image, fit.ellipse) < kMinColourShare) {
    return;
  }
  Detection detection;
  detection.kind = config_.kind;
  detection.confidence = confidence;
  detection.rms_px = fit.rms_px;
  detection.contrast = fit.contrast;
  detection.seen = fit.seen;
  if (FeatureOf(fit, detection)) {
    detection.found = true;
    best = detection;
    best_.curve = fit.curve;
    best_.normal_C = candidate_normal_;
    best_.confidence = confidence;
    best_.contrast = fit.contrast;
  }
}

template <class Curve>
double RoundDetector<Curve>::ColourShare(const Picture& image, const Ellipse& ellipse) const {
  constexpr int kRings = 5;
  constexpr int kPerRing = 16;
  std::array<ImagePoint, kRings * kPerRing> points;
  for (int ring = 0; ring < kRings; ++ring) {
    const double r = 0.85 * ellipse.minor_px * (ring + 1) / kRings;
    for (int i = 0; i < kPerRing; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kPerRing;
      ImagePoint& p = points[static_cast<std::size_t>(ring * kPerRing + i)];
      p = {ellipse.u_px + r * std::cos(angle), ellipse.v_px + r * std::sin(angle)};
      config_.intrinsics.Distort(p.u_px, p.v_px);
    }
  }
  return vision::ColourShare(image, colour_, points);
}

template <class Curve>
bool RoundDetector<Curve>::DiscOf(const EllipseCurve& curve, double round_below,
                                  std::array<DiscPose, 2>& poses) const {
  if (!PosesOfDisc(curve.Conic(config_.intrinsics), config_.intrinsics, config_.size, round_below, poses)) {
    return false;
  }
  const auto likeness = [&](const DiscPose& p) {
    return last_ ? last_->normal_C.dot(p.normal_C) : p.normal_C.z();
  };
  if (likeness(poses[1]) > likeness(poses[0])) {
    std::swap(poses[0], poses[1]);
  }
  return true;
}

// Computes s, its covariance and the outline's description from the curve.
template <class Curve>
bool RoundDetector<Curve>::FeatureOf(const CurveFit<Curve>& fit, Detection& d) {
  const Intrinsics& in = config_.intrinsics;
  const Ellipse& e = fit.ellipse;
  d.u_px = e.u_px;
  d.v_px = e.v_px;
  d.radius_px = e.radius_px;
  constexpr int kN = Curve::kDim;
  // Derivatives by differences over +-0.1 standard deviations, where the curve is smooth.
  Eigen::Matrix<double, 3, kN> uvr;
  Curve moved = fit.curve;
  for (int i = 0; i < kN; ++i) {
    const double step = 0.1 * std::sqrt(fit.cov(i, i)) + 1e-12;
    Vec3 change = Vec3::Zero();
    for (const double sign : {1.0, -1.0}) {
      moved.p[i] = fit.curve.p[i] + sign * step;
      const Ellipse m = EllipseOf(moved.Conic(in));
      change += sign * Vec3(m.u_px, m.v_px, m.radius_px);
    }
    moved.p[i] = fit.curve.p[i];
    uvr.col(i) = change / (2.0 * step);
  }
  d.cov_uvr_px2 = uvr * fit.cov * uvr.transpose();
  double distance = 0.0;
  if constexpr (kIsSphere<Curve>) {
    Vec3 s;
    Mat3 ds_dm;
    if (!features::SphereFromCone(fit.curve.p, s, ds_dm)) {
      return false;
    }
    d.s = s;
    d.cov_s = ds_dm * fit.cov * ds_dm.transpose();
    distance = s.norm() * 0.5 * config_.size;
  } else {
    // The value of 1 - minor / major that noise gives a circle.
    const double round_below = kRoundSigma * std::sqrt(d.cov_uvr_px2(2, 2)) / e.radius_px;
    std::array<DiscPose, 2> poses;
    if (!DiscOf(fit.curve, round_below, poses)) {
      return false;
    }
    const DiscPose& pose = poses[0];
    candidate_normal_ = pose.normal_C;
    const auto feature = [&](const DiscPose& p) {
      return Vec3(p.p_CO_C.x() / p.p_CO_C.z(), p.p_CO_C.y() / p.p_CO_C.z(), config_.size / p.p_CO_C.z());
    };
    const Vec3 s = feature(pose);
    Eigen::Matrix<double, 3, kN> ds;
    for (int i = 0; i < kN; ++i) {
      const double step = 0.1 * std::sqrt(fit.cov(i, i)) + 1e-12;
      std::array<DiscPose, 2> up;
      std::array<DiscPose, 2> down;
      moved.p[i] = fit.curve.p[i] + step;
      const bool first = DiscOf(moved, round_below, up);
      moved.p[i] = fit.curve.p[i] - step;
      const bool second = DiscOf(moved, round_below, down);
      moved.p[i] = fit.curve.p[i];
      if (!first || !second) {
        return false;
      }
      ds.col(i) = (feature(up[0]) - feature(down[0])) / (2.0 * step);
    }
    d.s = s;
    d.cov_s = ds * fit.cov * ds.transpose();
    // A tilt too small to measure still shifts the centre: by (R / Z)^2 sin(tilt) in s.
    const double sine = std::sqrt(std::min(1.0, 2.0 * round_below));
    const double tilt = std::max(e.minor_px / e.major_px, 0.05);
    const double shown = std::sqrt(std::max(1.0 - tilt * tilt, 0.0));
    const double unsure = 0.25 * s[2] * s[2] * 0.5 * sine * std::min(1.0, sine / std::max(shown, 1e-6));
    d.cov_s(0, 0) += unsure * unsure;
    d.cov_s(1, 1) += unsure * unsure;
    distance = pose.p_CO_C.norm();
    for (const DiscPose& p : poses) {
      d.pose[static_cast<std::size_t>(d.pose_count++)] = {{AxesAbout(p.normal_C), p.p_CO_C}, 0};
    }
  }
  if (distance < config_.distance_min || distance > config_.distance_max || !d.cov_s.allFinite()) {
    return false;
  }
  d.outline_count = Detection::kOutlinePoints;
  std::array<Eigen::Vector2d, Detection::kOutlinePoints> points;
  EllipsePoints(fit.curve.Conic(in), points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    d.outline[i] = {points[i].x(), points[i].y()};
  }
  return true;
}

template class RoundDetector<ConeCurve>;
template class RoundDetector<EllipseCurve>;

}  // namespace fovea::vision
