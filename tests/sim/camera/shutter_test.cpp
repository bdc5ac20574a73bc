// SPDX-License-Identifier: Apache-2.0
// Motion blur and rolling shutter: the rendered pictures of a moving target against an independent ray-cast,
// through the detector; and the blur's convergence.
#include "sim/camera/shutter.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "firmware/vision/detect/target_detector.hpp"
#include "sim/camera/optics.hpp"
#include "tests/sim/camera/ray_cast.hpp"

namespace fovea::sim {
namespace {

constexpr double kSide = 0.10;
constexpr std::int64_t kMs = 1'000'000;
const Pinhole kPinhole = MakePinhole(640, 480, 1.0471975511965976);

// A target that moves uniformly before a camera that stands over the bench and looks straight down.
struct Motion {
  Eigen::Vector3d p_CO{0.02, -0.015, 0.30};
  Eigen::Vector3d v_CO{0.0, 0.0, 0.0};  // [m/s]
  double turn = 0.0;                    // about z of C [rad]
  double w = 0.0;                       // [rad/s]

  [[nodiscard]] Eigen::Isometry3d X_CO(double t) const {
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.linear() = Eigen::AngleAxisd(turn + w * t, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    X.translation() = p_CO + t * v_CO;
    return X;
  }
};

// The exposure of that motion; `by_camera`: the target stands still in B and the camera moves instead.
Exposure Expose(const Motion& motion, bool by_camera) {
  Eigen::Isometry3d X_BC = Eigen::Isometry3d::Identity();
  X_BC.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  X_BC.translation() = Eigen::Vector3d(0.5, 0.0, 0.5);
  const auto at = [&](std::int64_t time_ns) {
    const Eigen::Isometry3d X_CO = motion.X_CO(1e-9 * static_cast<double>(time_ns));
    Moment moment;
    moment.time_ns = time_ns;
    moment.X_BC = by_camera ? X_BC * motion.X_CO(0.0) * X_CO.inverse() : X_BC;
    const Eigen::Isometry3d X_BO = moment.X_BC * X_CO;
    moment.p_BO = X_BO.translation();
    moment.R_BO = X_BO.linear();
    return moment;
  };
  Exposure exposure;
  static_cast<Moment&>(exposure) = at(0);
  auto around = std::make_shared<std::vector<Moment>>();
  for (int i = -20; i <= 20; ++i) {
    around->push_back(at(i * kMs));
  }
  exposure.around = around;
  return exposure;
}

RenderScene MakeScene(bool square) {
  RenderScene scene;  // nothing but the target, before the renderer's gray ground
  if (square) {
    scene.target.kind = TargetShape::Kind::kPolygon;
    const double h = 0.5 * kSide;
    scene.target.corners = {{-h, -h}, {h, -h}, {h, h}, {-h, h}};
  }
  return scene;
}

cv::Mat Render(const RenderScene& scene, const Shutter& shutter, const Exposure& exposure,
               const Pinhole& pinhole = kPinhole, const Lens& lens = {}) {
  Optics optics(scene, pinhole, lens, Sampling::kPlain, 0, shutter);
  cv::Mat rgba(pinhole.height_px, pinhole.width_px, CV_8UC4);
  optics.Draw(exposure, {rgba.data, rgba.total() * 4});
  cv::Mat bgr;
  cv::cvtColor(rgba, bgr, cv::COLOR_RGBA2BGR);
  optics.Release();
  return bgr;
}

vision::Detection Detect(const cv::Mat& bgr, bool square, const Lens& lens) {
  vision::DetectorConfig config;
  config.intrinsics = {640,
                       480,
                       kPinhole.f_px,
                       kPinhole.f_px,
                       kPinhole.c_u_px,
                       kPinhole.c_v_px,
                       {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3}};
  if (square) {
    config.kind = hal::FeatureKind::kSquare;
    features::TargetFeature feature;
    feature.target = hal::FeatureKind::kSquare;
    feature.corners = features::MakeSquare(kSide);
    config.LookFor(feature);
  } else {
    config.size = 0.08;
  }
  return vision::TargetDetector(config).Detect(bgr);
}

cv::Rect WindowOf(const Motion& motion) {
  const cv::Point middle(static_cast<int>(kPinhole.U(motion.p_CO)),
                         static_cast<int>(kPinhole.V(motion.p_CO)));
  return cv::Rect(middle - cv::Point(140, 140), cv::Size(280, 280)) & cv::Rect(0, 0, 640, 480);
}

struct Case {
  const char* name;
  Shutter shutter;
  Eigen::Vector3d v_CO;
  double w;
  bool by_camera;
  Lens lens{};
};

class ShutterTest : public testing::TestWithParam<Case> {
 protected:
  [[nodiscard]] Motion MotionOf(double turn) const {
    Motion motion;
    motion.v_CO = GetParam().v_CO;
    motion.turn = turn;
    motion.w = GetParam().w;
    return motion;
  }
  [[nodiscard]] test::CastCamera Camera() const {
    test::CastCamera camera;
    camera.exposure_s = GetParam().shutter.sub_exposures > 1 ? 0.005 : 0.0;
    camera.times = GetParam().shutter.sub_exposures > 1 ? 20 : 1;
    camera.row_time_s = 1e-9 * GetParam().shutter.row_time_ns;
    camera.k1 = GetParam().lens.k1;
    camera.k2 = GetParam().lens.k2;
    camera.p1 = GetParam().lens.p1;
    camera.p2 = GetParam().lens.p2;
    return camera;
  }
};
class MovingBallTest : public ShutterTest {};

// What the shutter does to the feature: its place in the picture of the moving target, relative to that in
// the picture of the same target at rest. The detector's own error for a shaded ball is in both.
TEST_P(MovingBallTest, BallIsMovedAsInTheRayCast) {
  const Motion motion = MotionOf(0.0);
  const auto at = [](const Motion& m) {
    return test::Ball(0.04, [m](double t) { return m.X_CO(t).translation().eval(); });
  };
  const auto cast = [&](const Motion& m) {
    return Detect(test::CastRays(Camera(), at(m), WindowOf(motion)), false, GetParam().lens);
  };
  const auto drawn = [&](const Motion& m) {
    return Detect(Render(MakeScene(false), GetParam().shutter, Expose(m, GetParam().by_camera), kPinhole,
                         GetParam().lens),
                  false, GetParam().lens);
  };
  const vision::Detection cast_moving = cast(motion);
  const vision::Detection cast_still = cast(Motion{});
  const vision::Detection drawn_moving = drawn(motion);
  const vision::Detection drawn_still = drawn(Motion{});
  ASSERT_TRUE(cast_moving.found && cast_still.found && drawn_moving.found && drawn_still.found);
  const auto shift = [](const vision::Detection& moving, const vision::Detection& still) {
    return Eigen::Vector3d(moving.u_px - still.u_px, moving.v_px - still.v_px,
                           moving.radius_px - still.radius_px);
  };
  const Eigen::Vector3d expected = shift(cast_moving, cast_still);
  const Eigen::Vector3d off = shift(drawn_moving, drawn_still) - expected;
  std::cout << "the shutter moves centre and radius by " << expected.transpose()
            << " px; rendered differs by " << off.transpose() << " px\n";
  EXPECT_LT(off.head<2>().norm(), 0.02);
  EXPECT_LT(std::fabs(off.z()), 0.02);
}

TEST_P(ShutterTest, SquaresCornersAreWhereTheRayCastShowsThem) {
  const Motion motion = MotionOf(0.3);
  const auto meets = test::Square(kSide, [&](double t) { return motion.X_CO(t); });
  const Lens& lens = GetParam().lens;
  const vision::Detection cast = Detect(test::CastRays(Camera(), meets, WindowOf(motion)), true, lens);
  const vision::Detection drawn = Detect(
      Render(MakeScene(true), GetParam().shutter, Expose(motion, GetParam().by_camera), kPinhole, lens), true,
      lens);
  ASSERT_TRUE(cast.found && drawn.found);
  double worst_px = 0.0;
  for (const vision::ImagePoint& a : drawn.Corners()) {
    double nearest_px = 1e9;
    for (const vision::ImagePoint& b : cast.Corners()) {
      nearest_px = std::min(nearest_px, std::hypot(a.u_px - b.u_px, a.v_px - b.v_px));
    }
    worst_px = std::max(worst_px, nearest_px);
  }
  std::cout << "corners: rendered and cast differ by at most " << worst_px << " px\n";
  EXPECT_LT(worst_px, 0.02);
}

// 0.3 m/s at 0.3 m is 550 px/s: 2.8 px in 5 ms. The detector takes an outline that is sheared by half of it.
const Lens kBarrel{-0.20, 0.06, 0.0015, -0.001, 0.0};
const auto kMoving =
    testing::Values(Case{"blurred_sideways", {5 * kMs, 16, 0.0}, {0.3, 0.1, 0.0}, 0.0, false},
                    Case{"blurred_turning", {5 * kMs, 16, 0.0}, {0.1, -0.2, 0.1}, 1.0, false},
                    Case{"rolling_sideways", {5 * kMs, 1, 30e3}, {0.15, 0.0, 0.0}, 0.0, false},
                    Case{"rolling_down", {5 * kMs, 1, 30e3}, {0.0, 0.15, 0.0}, 0.0, false},
                    Case{"rolling_by_camera", {5 * kMs, 1, 30e3}, {-0.1, 0.1, 0.1}, 0.5, true},
                    Case{"rolling_blurred", {5 * kMs, 16, 30e3}, {0.1, -0.1, 0.1}, 1.0, false},
                    Case{"rolling_lens_sideways", {5 * kMs, 1, 30e3}, {0.15, 0.0, 0.0}, 0.0, false, kBarrel},
                    Case{"rolling_lens_down", {5 * kMs, 1, 30e3}, {0.0, 0.15, 0.0}, 0.0, false, kBarrel},
                    Case{"rolling_lens_by_camera", {5 * kMs, 1, 30e3}, {-0.1, 0.1, 0.1}, 0.5, true, kBarrel});
std::string NameOf(const testing::TestParamInfo<Case>& given) { return given.param.name; }
INSTANTIATE_TEST_SUITE_P(Cameras, MovingBallTest, kMoving, NameOf);
INSTANTIATE_TEST_SUITE_P(Cameras, ShutterTest, kMoving, NameOf);
INSTANTIATE_TEST_SUITE_P(
    Still, ShutterTest,
    testing::Values(Case{"global", {5 * kMs, 1, 0.0}, {0.0, 0.0, 0.0}, 0.0, false},
                    Case{"lens", {5 * kMs, 1, 0.0}, {0.0, 0.0, 0.0}, 0.0, false, kBarrel}),
    NameOf);

// The covered share of the pixels in one row, from a dark and a bright square.
std::vector<double> CoverInRow(const Shutter& shutter, const Exposure& exposure, int row) {
  RenderScene scene = MakeScene(true);
  scene.target_colour.setConstant(0.0F);
  const cv::Mat dark = Render(scene, shutter, exposure);
  scene.target_colour.setConstant(0.7F);
  const cv::Mat bright = Render(scene, shutter, exposure);
  std::vector<double> cover;
  for (int u = 0; u < 640; ++u) {
    cover.push_back(bright.at<cv::Vec3b>(row, u)[1] - dark.at<cv::Vec3b>(row, u)[1]);
  }
  const double full = cover[static_cast<std::size_t>(kPinhole.U(Motion{}.p_CO))];
  for (double& c : cover) {
    c /= full;
  }
  return cover;
}

// The left side of a square that moves 8 px during the exposure. Its blurred edge is a box of that width, or
// n steps of it: with variance d^2 / 12 (1 - 1 / n^2), plus 1/12 for the area of a pixel and 1/12 for the
// difference of two pixels.
TEST(BlurTest, OutlineStaysAndItsWidthConverges) {
  constexpr double kMoved_px = 8.0;
  Motion motion;
  motion.v_CO.x() = kMoved_px / kPinhole.f_px * motion.p_CO.z() / 0.005;
  const Exposure exposure = Expose(motion, false);
  const double side_px = kPinhole.U(
      motion.p_CO - Eigen::Vector3d(0.5 * kSide, 0.0, 0.0));  // where the left side is in the middle
  const int row = static_cast<int>(kPinhole.V(motion.p_CO));
  for (const int n : {1, 2, 4, 8, 16, 32}) {
    const std::vector<double> cover = CoverInRow({5 * kMs, n, 0.0}, exposure, row);
    double sum = 0.0;
    double mean = 0.0;
    double square = 0.0;
    const int middle = static_cast<int>(kPinhole.U(motion.p_CO));
    for (int u = 100; u < middle; ++u) {  // across the left side only
      const double step = cover[static_cast<std::size_t>(u + 1)] - cover[static_cast<std::size_t>(u)];
      sum += step;
      mean += step * (u + 0.5);
      square += step * (u + 0.5) * (u + 0.5);
    }
    mean /= sum;
    const double variance = square / sum - mean * mean;
    const double expected = kMoved_px * kMoved_px / 12.0 * (1.0 - 1.0 / (n * n)) + 1.0 / 6.0;
    const double width = std::sqrt(12.0 * std::max(variance - 1.0 / 6.0, 0.0));
    std::cout << n << " sub-exposures: outline shifted by " << mean - side_px << " px, width " << width
              << " px, of 8\n";
    EXPECT_NEAR(mean, side_px, 0.03) << n;  // half a gray level of rounding, of 180, on 8 px is 0.022 px
    EXPECT_NEAR(variance, expected, 0.15) << n;
  }
}

}  // namespace
}  // namespace fovea::sim
