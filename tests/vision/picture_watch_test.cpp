// SPDX-License-Identifier: Apache-2.0
// Detection of pictures that differ by more than their noise.
#include "firmware/vision/detect/picture_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

// A dark square on a plain bench, its edges along the rows and columns, softened over a pixel.
cv::Mat SquareOnPlain(double left, double top, double right, double bottom) {
  cv::Mat gray(480, 640, CV_64FC1);
  const auto within = [](int at, double from, double to) {
    return std::clamp(at + 0.5 - from, 0.0, 1.0) * std::clamp(to - at + 0.5, 0.0, 1.0);
  };
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      gray.at<double>(y, x) = 170.0 - 140.0 * within(x, left, right) * within(y, top, bottom);
    }
  }
  return gray;
}

// Wherever the edges of an upright square are, some patches see them move: none fall between all patches.
TEST(PictureWatch, UprightSquareThatMovesIsAChange) {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> size(40.0, 300.0);
  std::uniform_real_distribution<double> share(0.05, 0.95);
  for (int k = 0; k < 16; ++k) {
    const double side = k == 0 ? 138.6 : size(engine);
    const double left = k == 0 ? 250.7 : share(engine) * (640.0 - side);
    const double top = k == 0 ? 170.7 : share(engine) * (480.0 - side);
    const double sigma = k % 3 == 0 ? 0.0 : 2.0;
    const cv::Mat here = SquareOnPlain(left, top, left + side, top + side);
    const cv::Mat first = Photo(here, sigma, engine);
    const cv::Mat second = Photo(here, sigma, engine);
    for (const double px : {1.0, 2.0}) {
      for (const bool down : {false, true}) {
        PictureWatch watch;
        const double x = left + (down ? 0.0 : px);
        const double y = top + (down ? px : 0.0);
        ASSERT_EQ(watch.Look(first, 0), 0);
        ASSERT_EQ(watch.Look(second, kFrameNs), kFrameNs) << "it stands still";
        const cv::Mat moved = SquareOnPlain(x, y, x + side, y + side);
        EXPECT_EQ(watch.Look(Photo(moved, sigma, engine), 2 * kFrameNs), 0)
            << side << " px at (" << left << ", " << top << "), moved " << px << " px "
            << (down ? "down" : "aside") << ", noise " << sigma;
      }
    }
  }
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
