// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/features/extraction.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>

#include "firmware/core/model/rotation.hpp"
#include "firmware/vision/detect/target_detector.hpp"
#include "firmware/vision/pose/flat_corners.hpp"
#include "tools/bench/vision/scenes.hpp"

namespace fovea {
namespace {

using features::TargetFeature;
using hal::FeatureKind;

constexpr double kWrongPx = 2.0;

vision::DetectorConfig ConfigFor(const TargetFeature& target, const bench::PictureCamera& camera) {
  vision::DetectorConfig config;
  config.LookFor(target);
  config.by = vision::FindBy::kGray;
  config.intrinsics = {camera.width_px, camera.height_px, camera.f_px,
                       camera.f_px,     camera.c_u_px,    camera.c_v_px};
  config.distance_min = 0.10;
  config.distance_max = 2.2;
  return config;
}

// s without stacked rows; empty when the feature has no value.
std::vector<double> FeatureAt(const TargetFeature& feature, const model::Pose& X_CO) {
  features::FeatureState state;
  if (!feature.Compute({X_CO, model::Vec3::Zero(), model::Vec3::Zero()}, state)) {
    return {};
  }
  return {state.s.begin(), state.s.end()};
}

// The range (largest minus smallest) of each entry of s over the poses of the benchmark's pictures.
std::vector<double> Ranges(const TargetFeature& feature) {
  constexpr unsigned kPoses = 200;
  std::vector<double> low;
  std::vector<double> high;
  for (unsigned i = 0; i < kPoses; ++i) {
    const bench::PictureScene scene =
        bench::MakeScene(bench::SceneClasses().front(), feature.target, true, i);
    const bench::Body& body = scene.bodies.front();
    const std::vector<double> s = FeatureAt(feature, {body.R, body.p});
    if (low.empty()) {
      low = high = s;
    }
    for (std::size_t k = 0; k < std::min(s.size(), low.size()); ++k) {
      low[k] = std::min(low[k], s[k]);
      high[k] = std::max(high[k], s[k]);
    }
  }
  for (std::size_t k = 0; k < low.size(); ++k) {
    high[k] -= low[k];
  }
  return high;
}

// Draws the target alone on an even ground, without noise.
cv::Mat Portrait(const TargetFeature& feature, const model::Pose& X_CO, const bench::PictureCamera& camera) {
  bench::PictureScene scene;
  scene.camera = camera;
  bench::Body body;
  body.p = X_CO.p;
  body.R = X_CO.R;
  body.radius = feature.radius;
  body.bgr = scene.ground_bgr.array() + Scatter::kContrast;
  const features::TargetBody shape = features::TraitsOf(feature.target).body;
  body.shape = shape == features::TargetBody::kBall   ? bench::Shape::kSphere
               : shape == features::TargetBody::kDisc ? bench::Shape::kDisc
                                                      : bench::Shape::kPolygon;
  if (feature.SeesOrientation()) {
    body.corners = vision::FlatCorners(feature.corners);
  }
  // In order from x to y, as bench::Body requires.
  if (body.corners.size() >= 3) {
    const Eigen::Vector2d a = body.corners[1] - body.corners[0];
    const Eigen::Vector2d b = body.corners[2] - body.corners[1];
    if (a.x() * b.y() - a.y() * b.x() < 0.0) {
      std::reverse(body.corners.begin(), body.corners.end());
    }
  }
  scene.bodies.push_back(body);
  return bench::Draw(scene);
}

// The target's pose by the detection. For a flat target, the candidate pose nearest to the truth: choosing
// the true one is the servo's task.
std::optional<model::Pose> PoseIn(const vision::Detection& d, const TargetFeature& feature,
                                  const model::Pose& X_CO) {
  if (!d.found) {
    return std::nullopt;
  }
  if (feature.SeesOrientation()) {
    const auto turned = [&](const vision::Detection::Pose& pose) {
      return model::RotationVector(pose.X_CO.R * X_CO.R.transpose()).squaredNorm();
    };
    return std::min_element(d.pose.begin(), d.pose.begin() + d.pose_count,
                            [&](const auto& a, const auto& b) { return turned(a) < turned(b); })
        ->X_CO;
  }
  hal::FeatureMeasurement measurement;
  measurement.kind = d.kind;
  measurement.found = true;
  measurement.dim = static_cast<std::int32_t>(d.s.size());
  std::copy(d.s.begin(), d.s.end(), measurement.s.begin());
  features::LiftedTarget lifted;
  if (!feature.Lift(measurement, lifted)) {
    return std::nullopt;
  }
  return model::Pose{X_CO.R, lifted.p_CO_C};
}

}  // namespace

Search MeasureSearch(FeatureKind target, int per_class) {
  const bench::PictureCamera camera;
  vision::TargetDetector detector(ConfigFor(bench::TargetOf(target), camera));
  int found = 0;
  std::vector<double> ms;
  for (const bench::SceneClass& scenes : bench::SceneClasses()) {
    for (int i = 0; i < per_class && !scenes.clutter; ++i) {  // clutter needs colour
      const bench::PictureScene scene = bench::MakeScene(scenes, target, true, static_cast<unsigned>(i));
      const cv::Mat image = bench::Draw(scene);
      const bench::TrueOutline truth = bench::OutlineOf(camera, scene.bodies.front());
      detector.Forget();
      const auto start = std::chrono::steady_clock::now();
      const vision::Detection d = detector.Detect(image);
      const auto end = std::chrono::steady_clock::now();
      ms.push_back(std::chrono::duration<double, std::milli>(end - start).count());
      found += d.found && std::hypot(d.u_px - truth.u_px, d.v_px - truth.v_px) < kWrongPx ? 1 : 0;
    }
  }
  const auto middle = ms.begin() + static_cast<std::ptrdiff_t>(ms.size() / 2);
  std::nth_element(ms.begin(), middle, ms.end());
  return {found / static_cast<double>(ms.size()), *middle};
}

Scatter MeasureScatter(const TargetFeature& feature, const model::Pose& X_CO) {
  const bench::PictureCamera camera;
  vision::TargetDetector detector(ConfigFor(feature, camera));
  const cv::Mat portrait = Portrait(feature, X_CO, camera);
  cv::RNG random(1);
  cv::Mat noise(portrait.size(), CV_16SC1);
  cv::Mat image;
  Scatter scatter;
  std::vector<double> sum;
  std::vector<double> sum2;
  const std::vector<double> truth = FeatureAt(feature, X_CO);
  for (int i = 0; i < Scatter::kPictures; ++i) {
    random.fill(noise, cv::RNG::NORMAL, 0.0, Scatter::kNoise);
    cv::add(portrait, noise, image, cv::noArray(), CV_8U);
    const vision::Detection d = detector.Detect(image);
    std::vector<double> s;
    if (const std::optional<model::Pose> seen = PoseIn(d, feature, X_CO)) {
      s = FeatureAt(feature, *seen);
    }
    if (s.size() != truth.size()) {
      continue;
    }
    ++scatter.found;
    sum.resize(s.size(), 0.0);
    sum2.resize(s.size(), 0.0);
    for (std::size_t k = 0; k < s.size(); ++k) {
      const double off = s[k] - truth[k];
      sum[k] += off;
      sum2[k] += off * off;
    }
  }
  if (scatter.found < 2) {
    return scatter;
  }
  const std::vector<double> ranges = Ranges(feature);
  const double n = scatter.found;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    const double variance = (sum2[k] - sum[k] * sum[k] / n) / (n - 1.0);
    scatter.per_level.push_back(std::sqrt(std::max(variance, 0.0)) / Scatter::kNoise);
    scatter.worst = std::max(scatter.worst, scatter.per_level.back() / ranges[k]);
  }
  return scatter;
}

}  // namespace fovea
