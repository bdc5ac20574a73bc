// SPDX-License-Identifier: Apache-2.0
// The ball detector on pictures with a known truth.
#include "firmware/vision/detect/target_detector.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <iostream>
#include <random>

#include "firmware/core/features/sphere.hpp"
#include "tests/support/ray_cast_ball.hpp"

namespace fovea::vision {
namespace {

Intrinsics IntrinsicsOf(const test::BallPicture& p) {
  return {p.width_px, p.height_px, p.f_px, p.f_px, p.c_u_px, p.c_v_px};
}

DetectorConfig ConfigOf(const test::BallPicture& p) {
  DetectorConfig config;
  config.intrinsics = IntrinsicsOf(p);
  config.size = 2.0 * p.radius;
  return config;
}

struct Errors {
  int found = 0;
  double lateral2 = 0.0;  // squared, of the direction to the centre [px]
  double depth2 = 0.0;    // squared, relative
  double bias_depth = 0.0;
  double worst_px = 0.0;
  double chi2 = 0.0;  // of s against its own covariance
};

Errors Measure(test::BallPicture picture, int count, FindBy by = FindBy::kColour) {
  std::mt19937 engine(picture.seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(engine);
  };
  Errors errors;
  for (int i = 0; i < count; ++i) {
    picture.seed = static_cast<unsigned>(100 + i);
    picture.z = uniform(0.25, 0.9);
    picture.x = picture.z * uniform(-0.40, 0.40);
    picture.y = picture.z * uniform(-0.28, 0.28);
    DetectorConfig config = ConfigOf(picture);
    config.by = by;
    TargetDetector detector(config);
    const Detection d = detector.Detect(test::RayCast(picture));
    if (!d.found) {
      continue;
    }
    ++errors.found;
    const model::Vec3 truth(picture.x, picture.y, picture.z);
    const model::Vec3 s = truth / picture.radius;
    const Intrinsics in = IntrinsicsOf(picture);
    const double du = in.U(d.Middle()) - in.U(s);
    const double dv = in.V(d.Middle()) - in.V(s);
    const double depth = d.s.norm() / s.norm() - 1.0;
    errors.lateral2 += du * du + dv * dv;
    errors.worst_px = std::max(errors.worst_px, std::hypot(du, dv));
    errors.depth2 += depth * depth;
    errors.bias_depth += depth;
    errors.chi2 += (d.s - s).dot(d.cov_s.inverse() * (d.s - s));
  }
  const double n = std::max(errors.found, 1);
  std::cout << "found " << errors.found << " of " << count << ", centre "
            << std::sqrt(errors.lateral2 / n / 2) << " px rms per axis (worst " << errors.worst_px
            << "), depth " << 100.0 * std::sqrt(errors.depth2 / n) << " % rms, bias "
            << 100.0 * errors.bias_depth / n << " %, chi2/3 " << errors.chi2 / n / 3 << "\n";
  return errors;
}

TEST(SphereDetectorTest, CleanPicturesAreMeasuredAccurately) {
  const Errors errors = Measure({}, 60);
  EXPECT_EQ(errors.found, 60);
  EXPECT_LT(std::sqrt(errors.lateral2 / 120), 0.007);
  EXPECT_LT(std::sqrt(errors.depth2 / 60), 0.0002);
}

TEST(SphereDetectorTest, ShadedBallsAreMeasuredWithinTheirCovariance) {
  test::BallPicture picture;
  picture.shade = 0.7;
  const Errors errors = Measure(picture, 60);
  EXPECT_EQ(errors.found, 60);
  EXPECT_LT(std::sqrt(errors.lateral2 / 120), 0.012);
  EXPECT_LT(errors.worst_px, 0.04);
  EXPECT_LT(std::sqrt(errors.depth2 / 60), 0.0006);
  EXPECT_LT(errors.chi2 / 180, 1.5) << "the covariance is too small";
}

TEST(SphereDetectorTest, NoisyPicturesAreMeasuredWithinTheirCovariance) {
  test::BallPicture picture;
  picture.noise = 15.0;
  picture.grid = 4;
  const Errors errors = Measure(picture, 60);
  EXPECT_EQ(errors.found, 60);
  EXPECT_LT(std::sqrt(errors.lateral2 / 120), 0.016);
  EXPECT_LT(errors.worst_px, 0.05);
  EXPECT_LT(std::sqrt(errors.depth2 / 60), 0.0003);
  EXPECT_LT(errors.chi2 / 180, 1.5) << "the covariance is too small";
  EXPECT_GT(errors.chi2 / 180, 0.05) << "the covariance is far too large";
}

TEST(SphereDetectorTest, GrayPicturesAreMeasuredAccurately) {
  test::BallPicture picture;
  picture.ball_bgr = {200, 200, 200};
  picture.noise = 3.0;
  const Errors errors = Measure(picture, 60, FindBy::kGray);
  EXPECT_EQ(errors.found, 60);
  EXPECT_LT(std::sqrt(errors.lateral2 / 120), 0.009);
}

// A ball moves steadily, jumps, disappears and comes back elsewhere.
// Tracking must give the same results as a search in each image.
TEST(SphereDetectorTest, TrackingFindsTheSameAsSearchingEachImage) {
  test::BallPicture picture;
  picture.noise = 5.0;
  picture.grid = 4;
  TargetDetector following(ConfigOf(picture));
  double worst_px = 0.0;
  int followed = 0;
  const std::array<double, 9> places{-0.10, -0.09, -0.08, -0.07, 0.02, 0.03, 9.0, -0.05, -0.045};  // x [m]
  for (const double x : places) {
    picture.x = x;
    ++picture.seed;
    const cv::Mat image = test::RayCast(picture);
    const Detection one = TargetDetector(ConfigOf(picture)).Detect(image);
    const Detection next = following.Detect(image);
    ASSERT_EQ(next.found, x < 1.0) << "at " << x;
    ASSERT_EQ(one.found, next.found);
    followed += next.tracked ? 1 : 0;
    if (next.found) {
      worst_px = std::max(worst_px, std::hypot(next.u_px - one.u_px, next.v_px - one.v_px));
    }
  }
  std::cout << "tracked in " << followed << " images, " << worst_px << " px difference at most\n";
  EXPECT_GE(followed, 5);
  EXPECT_LT(worst_px, 0.01);
}

}  // namespace
}  // namespace fovea::vision
