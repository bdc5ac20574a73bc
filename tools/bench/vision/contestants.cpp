// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/vision/contestants.hpp"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "firmware/core/features/target_traits.hpp"
#include "firmware/vision/detect/target_detector.hpp"
#include "tools/bench/vision/picture_target.hpp"

namespace fovea::bench {
namespace {

constexpr double kRadiusMinPx = 10.0;  // range of radii that all detectors search
constexpr double kRadiusMaxPx = 190.0;

class Ours final : public Contestant {
 public:
  Ours(TargetKind kind, const PictureCamera& camera, bool colour) : detector_(Config(kind, camera, colour)) {}
  [[nodiscard]] std::string name() const override { return "fovea"; }
  Answer Look(const cv::Mat& image) override {
    detector_.Forget();
    return LookAgain(image);
  }
  Answer LookAgain(const cv::Mat& image) override {
    const vision::Detection d = detector_.Detect(image);
    return {d.found,
            d.u_px,
            d.v_px,
            d.radius_px,
            std::sqrt(0.5 * (d.cov_uvr_px2(0, 0) + d.cov_uvr_px2(1, 1))),
            CornersOf(d)};
  }
  [[nodiscard]] bool tracks() const override { return true; }

 private:
  static vision::DetectorConfig Config(TargetKind kind, const PictureCamera& camera, bool colour) {
    vision::DetectorConfig config =
        ConfigOf(kind, camera, colour ? vision::FindBy::kColour : vision::FindBy::kGray);
    config.radius_min_px = kRadiusMinPx;
    config.radius_max_px = kRadiusMaxPx;
    return config;
  }
  vision::TargetDetector detector_;
};

const cv::Mat& GrayOf(const cv::Mat& image, cv::Mat& gray) {
  if (image.channels() == 1) {
    return image;
  }
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

class Hough final : public Contestant {
 public:
  [[nodiscard]] std::string name() const override { return "blur + Hough"; }
  Answer Look(const cv::Mat& image) override {
    cv::GaussianBlur(GrayOf(image, gray_), blurred_, cv::Size(), 1.5);
    cv::HoughCircles(blurred_, circles_, cv::HOUGH_GRADIENT, 1.0, 30.0, 100.0, 30.0,
                     static_cast<int>(kRadiusMinPx), static_cast<int>(kRadiusMaxPx));
    if (circles_.empty()) {
      return {};
    }
    return {true,
            static_cast<double>(circles_[0][0]),
            static_cast<double>(circles_[0][1]),
            static_cast<double>(circles_[0][2]),
            0.0,
            {}};
  }

 private:
  cv::Mat gray_, blurred_;
  std::vector<cv::Vec3f> circles_;
};

class ThresholdEllipse final : public Contestant {
 public:
  [[nodiscard]] std::string name() const override { return "threshold + fitEllipse"; }
  Answer Look(const cv::Mat& image) override {
    cv::threshold(GrayOf(image, gray_), binary_, 0.0, 255.0, cv::THRESH_BINARY | cv::THRESH_OTSU);
    cv::findContours(binary_, contours_, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
    Answer best;
    double roundest = 0.85;
    for (const auto& contour : contours_) {
      const double area = cv::contourArea(contour);
      const double length = cv::arcLength(contour, true);
      const double round = length > 0.0 ? 4.0 * std::numbers::pi * area / (length * length) : 0.0;
      if (contour.size() < 20 || round < roundest) {
        continue;
      }
      const cv::RotatedRect e = cv::fitEllipse(contour);
      const double radius =
          0.5 * std::sqrt(static_cast<double>(e.size.width) * static_cast<double>(e.size.height));
      if (radius > kRadiusMinPx && radius < kRadiusMaxPx) {
        roundest = round;
        best = {true, static_cast<double>(e.center.x), static_cast<double>(e.center.y), radius, 0.0, {}};
      }
    }
    return best;
  }

 private:
  cv::Mat gray_, binary_;
  std::vector<std::vector<cv::Point>> contours_;
};

}  // namespace

std::vector<std::unique_ptr<Contestant>> MakeContestants(TargetKind kind, const PictureCamera& camera,
                                                         bool colour) {
  std::vector<std::unique_ptr<Contestant>> list;
  list.push_back(std::make_unique<Ours>(kind, camera, colour));
  if (features::TraitsOf(kind).body != features::TargetBody::kPlate) {
    list.push_back(std::make_unique<Hough>());
    list.push_back(std::make_unique<ThresholdEllipse>());
  }
  return list;
}

}  // namespace fovea::bench
