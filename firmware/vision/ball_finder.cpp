#include "fovea/vision/ball_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

namespace fovea::vision {
namespace {

// OpenCV's 8-bit HSV: hue in steps of 2 degrees, saturation and value 0 to 255.
constexpr int kHueBins = 60;  // 3 of OpenCV's steps each
constexpr int kSaturationBins = 32;
constexpr double kDegPerBin = 360.0 / kHueBins;

// The Hough transform's time grows with the square of the edges that vote: this share of the pixels is
// enough.
constexpr double kMostEdges = 0.01;

constexpr double kRoundness = 0.7;  // of circles in a gray picture; 1 is perfect

double HueDistance(double a_deg, double b_deg) {
  const double d = std::fabs(std::remainder(a_deg - b_deg, 360.0));
  return d;
}

}  // namespace

BallFinder::BallFinder(const FinderConfig& config)
    : config_(config), histogram_(kHueBins, kSaturationBins, CV_32F) {
  for (int h = 0; h < kHueBins; ++h) {
    const double d = HueDistance((h + 0.5) * kDegPerBin, config.hue_deg) / config.hue_width_deg;
    for (int s = 0; s < kSaturationBins; ++s) {
      const double saturation = (s + 0.5) / kSaturationBins;
      // A colour counts from saturation_min on, fully 0.2 above.
      const double coloured = std::clamp((saturation - config.saturation_min) / 0.2, 0.0, 1.0);
      histogram_.at<float>(h, s) = static_cast<float>(255.0 * std::exp(-0.5 * d * d) * coloured);
    }
  }
}

double BallFinder::Likeness(double blue, double green, double red) const {
  if (config_.by == FindBy::kGray) {
    return 1.0;
  }
  const double high = std::max({blue, green, red});
  const double low = std::min({blue, green, red});
  const double chroma = high - low;
  if (high <= 0.0 || chroma <= 0.0) {
    return 0.0;
  }
  double hue = 0.0;
  if (high == red) {
    hue = 60.0 * (green - blue) / chroma;
  } else if (high == green) {
    hue = 60.0 * (blue - red) / chroma + 120.0;
  } else {
    hue = 60.0 * (red - green) / chroma + 240.0;
  }
  hue = hue < 0.0 ? hue + 360.0 : hue;
  const int h = std::min(static_cast<int>(hue / kDegPerBin), kHueBins - 1);
  const int s = std::min(static_cast<int>(chroma / high * kSaturationBins), kSaturationBins - 1);
  return static_cast<double>(histogram_.at<float>(h, s)) / 255.0;
}

const std::vector<Circle>& BallFinder::Find(const cv::Mat& image) {
  circles_.clear();
  cv::resize(image, half_, cv::Size(), 0.5, 0.5, cv::INTER_AREA);
  if (half_.channels() == 1) {
    likeness_ = half_;
  } else if (config_.by == FindBy::kGray) {
    cv::cvtColor(half_, likeness_, cv::COLOR_BGR2GRAY);
  } else {
    cv::cvtColor(half_, hsv_, cv::COLOR_BGR2HSV);
    const int channels[] = {0, 1};
    const float hue_range[] = {0.0F, 180.0F};
    const float saturation_range[] = {0.0F, 256.0F};
    const float* ranges[] = {hue_range, saturation_range};
    cv::calcBackProject(&hsv_, 1, channels, histogram_, likeness_, ranges, 1.0, true);
  }
  cv::GaussianBlur(likeness_, blurred_, cv::Size(), config_.blur_sigma_px);
  const double spacing = 0.5 * config_.radius_min_px + 4.0;
  const int radius_min = static_cast<int>(0.5 * config_.radius_min_px);
  const int radius_max = static_cast<int>(std::ceil(0.5 * config_.radius_max_px));
  if (config_.by == FindBy::kGray || image.channels() == 1) {
    // A gray picture is full of edges that are no circle's. This variant asks how round a circle's edge is,
    // not only how many points vote for it, in a time that does not depend on how many there are.
    cv::normalize(blurred_, blurred_, 0.0, 255.0, cv::NORM_MINMAX);  // thresholds mean the same in any light
    cv::HoughCircles(blurred_, hough_, cv::HOUGH_GRADIENT_ALT, 1.5, spacing, config_.canny_threshold,
                     kRoundness, radius_min, radius_max);
  } else {
    cv::HoughCircles(blurred_, hough_, cv::HOUGH_GRADIENT, 1.5, spacing, EdgeThreshold(), config_.votes,
                     radius_min, radius_max);
  }
  const auto count = std::min(hough_.size(), static_cast<std::size_t>(config_.candidates_max));
  for (std::size_t i = 0; i < count; ++i) {
    // Pixel (i, j) of the half image is the mean of pixels 2i, 2i + 1: its centre is at 2i + 0.5.
    const cv::Vec3f& c = hough_[i];
    circles_.push_back({2.0 * static_cast<double>(c[0]) + 0.5, 2.0 * static_cast<double>(c[1]) + 0.5,
                        2.0 * static_cast<double>(c[2])});
  }
  return circles_;
}

// The configured threshold, or the one that only the strongest edges of a picture full of them pass.
double BallFinder::EdgeThreshold() {
  constexpr int kLevels = 2048;  // |dx| + |dy| of a 3 x 3 Sobel is at most 2040
  cv::Sobel(blurred_, dx_, CV_16S, 1, 0);
  cv::Sobel(blurred_, dy_, CV_16S, 0, 1);
  std::array<int, kLevels> counts{};
  for (int v = 0; v < dx_.rows; ++v) {
    const auto* dx = dx_.ptr<std::int16_t>(v);
    const auto* dy = dy_.ptr<std::int16_t>(v);
    for (int u = 0; u < dx_.cols; ++u) {
      const int size = std::abs(dx[u]) + std::abs(dy[u]);
      ++counts[static_cast<std::size_t>(std::min(size, kLevels - 1))];
    }
  }
  const int most = static_cast<int>(kMostEdges * static_cast<double>(dx_.total()));
  int level = kLevels - 1;
  for (int above = 0; level > 0; --level) {
    above += counts[static_cast<std::size_t>(level)];
    if (above > most) {
      break;
    }
  }
  return std::max(config_.canny_threshold, static_cast<double>(level));
}

}  // namespace fovea::vision
