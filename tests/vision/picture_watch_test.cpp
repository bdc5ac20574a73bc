// SPDX-License-Identifier: Apache-2.0
// Detection of pictures that differ by more than their noise.
#include "firmware/vision/detect/picture_watch.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <opencv2/imgproc.hpp>
#include <random>

#include "fovea/hal/types.hpp"

namespace fovea::vision {
namespace {

constexpr std::int64_t kFrameNs = 33 * hal::kNsPerMs;

// A bench with a smooth texture of `contrast` gray levels, shifted sideways by `shift_px`.
cv::Mat Bench(double contrast, double shift_px) {
  cv::Mat gray(480, 640, CV_64FC1);
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      const double u = x + shift_px;
      gray.at<double>(y, x) = 128.0 + contrast * std::sin(0.05 * u) * std::cos(0.07 * y + 0.01 * u);
    }
  }
  return gray;
}

cv::Mat Photo(const cv::Mat& gray, double sigma, std::mt19937_64& engine) {
  std::normal_distribution<double> normal(0.0, sigma);
  cv::Mat picture(gray.size(), CV_8UC3);
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      for (int c = 0; c < 3; ++c) {
        picture.at<cv::Vec3b>(y, x)[c] =
            cv::saturate_cast<std::uint8_t>(gray.at<double>(y, x) + normal(engine));
      }
    }
  }
  return picture;
}

class PictureWatchTest : public testing::TestWithParam<double> {};

TEST_P(PictureWatchTest, FreshNoiseIsNoChange) {
  std::mt19937_64 engine(1);
  PictureWatch watch;
  const cv::Mat bench = Bench(40.0, 0.0);
  for (int k = 0; k < 60; ++k) {
    EXPECT_EQ(watch.Look(Photo(bench, GetParam(), engine), k * kFrameNs), k * kFrameNs);
  }
}

TEST_P(PictureWatchTest, OnePixelShiftIsAChange) {
  std::mt19937_64 engine(2);
  PictureWatch watch;
  EXPECT_EQ(watch.Look(Photo(Bench(40.0, 0.0), GetParam(), engine), 0), 0);
  EXPECT_EQ(watch.Look(Photo(Bench(40.0, 0.0), GetParam(), engine), kFrameNs), kFrameNs);
  for (int k = 2; k < 30; ++k) {
    // In strong noise one pixel may be too little to detect; two pixels are detected.
    EXPECT_LE(watch.Look(Photo(Bench(40.0, 1.0 * k), GetParam(), engine), k * kFrameNs),
              GetParam() > 3.0 ? kFrameNs : 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Noise, PictureWatchTest, testing::Values(0.0, 1.0, 3.0, 6.0));

// A slow drift adds up, because each picture is compared with the first of the series, not with the last.
TEST(PictureWatch, SlowDriftIsDetectedWithinTwoPixels) {
  std::mt19937_64 engine(3);
  PictureWatch watch;
  double longest_px = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double same =
        static_cast<double>(watch.Look(Photo(Bench(40.0, 0.05 * k), 3.0, engine), k * kFrameNs));
    longest_px = std::max(longest_px, 0.05 * same / static_cast<double>(kFrameNs));
  }
  std::cout << "counted as the same over at most " << longest_px << " px\n";
  EXPECT_LT(longest_px, 2.0);
}

TEST(PictureWatch, HandlesGrayPicturesAndChangesOfSize) {
  std::mt19937_64 engine(4);
  PictureWatch watch;
  const cv::Mat gray(30, 40, CV_8UC1, cv::Scalar(7));
  EXPECT_EQ(watch.Look(gray, 0), 0);
  EXPECT_EQ(watch.Look(gray, kFrameNs), kFrameNs);
  EXPECT_EQ(watch.Look(Photo(Bench(40.0, 0.0), 3.0, engine), 2 * kFrameNs), 0);
  EXPECT_EQ(watch.Look(cv::Mat(2, 2, CV_8UC1, cv::Scalar(7)), 3 * kFrameNs), 0);
}

}  // namespace
}  // namespace fovea::vision
