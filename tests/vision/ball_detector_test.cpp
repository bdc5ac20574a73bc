// The ball detector on pictures whose truth is known.
#include "fovea/vision/ball_detector.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <iostream>
#include <random>

#include "fovea/features/sphere.hpp"
#include "support/ray_cast_ball.hpp"

namespace fovea::vision {
namespace {

Intrinsics IntrinsicsOf(const test::BallPicture& p) {
  return {p.width_px, p.height_px, p.f_px, p.f_px, p.c_u_px, p.c_v_px};
}

BallDetectorConfig ConfigOf(const test::BallPicture& p) {
  BallDetectorConfig config;
  config.intrinsics = IntrinsicsOf(p);
  config.radius = p.radius;
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
    BallDetectorConfig config = ConfigOf(picture);
    config.finder.by = by;
    BallDetector detector(config);
    const BallDetection d = detector.Detect(test::RayCast(picture));
    if (!d.found) {
      continue;
    }
    ++errors.found;
    const model::Vec3 truth(picture.x, picture.y, picture.z);
    const model::Vec3 s = truth / picture.radius;
    const Intrinsics in = IntrinsicsOf(picture);
    const double du = in.U(d.s) - in.U(s);
    const double dv = in.V(d.s) - in.V(s);
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

TEST(BallDetectorTest, CleanPictures) {
  const Errors errors = Measure({}, 60);
  EXPECT_EQ(errors.found, 60);
  EXPECT_LT(std::sqrt(errors.lateral2 / 120), 0.02);
  EXPECT_LT(std::sqrt(errors.depth2 / 60), 0.001);
}

TEST(BallDetectorTest, ShadedBalls) {
  test::BallPicture picture;
  picture.shade = 0.7;
  const Errors errors = Measure(picture, 60);
  EXPECT_EQ(errors.found, 60);
  EXPECT_LT(std::sqrt(errors.lateral2 / 120), 0.05);
  EXPECT_LT(errors.worst_px, 0.15);
  EXPECT_LT(std::sqrt(errors.depth2 / 60), 0.001);
  EXPECT_LT(errors.chi2 / 180, 1.5) << "the covariance promises too much";
}

TEST(BallDetectorTest, NoisyPictures) {
  test::BallPicture picture;
  picture.noise = 15.0;
  picture.grid = 4;
  const Errors errors = Measure(picture, 60);
  EXPECT_EQ(errors.found, 60);
  EXPECT_LT(std::sqrt(errors.lateral2 / 120), 0.04);
  EXPECT_LT(errors.worst_px, 0.15);
  EXPECT_LT(std::sqrt(errors.depth2 / 60), 0.001);
  EXPECT_LT(errors.chi2 / 180, 1.5) << "the covariance promises too much";
  EXPECT_GT(errors.chi2 / 180, 0.05) << "the covariance says nothing";
}

TEST(BallDetectorTest, GrayPictures) {
  test::BallPicture picture;
  picture.ball_bgr = {200, 200, 200};
  picture.noise = 3.0;
  const Errors errors = Measure(picture, 60, FindBy::kGray);
  EXPECT_EQ(errors.found, 60);
  EXPECT_LT(std::sqrt(errors.lateral2 / 120), 0.03);
}

}  // namespace
}  // namespace fovea::vision
