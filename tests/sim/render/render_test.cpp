// SPDX-License-Identifier: Apache-2.0
// The renderer compared with the truth: in its pictures the detector finds the ball where it is.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <iostream>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>

#include "firmware/vision/detect/target_detector.hpp"
#include "sim/physics/bullet_arm.hpp"
#include "sim/render/cover.hpp"
#include "sim/render/egl_context.hpp"
#include "sim/render/scene_renderer.hpp"
#include "tests/support/places.hpp"

namespace fovea::sim {
namespace {

constexpr double kRadius = 0.04;

class RenderTest : public ::testing::Test {
 protected:
  RenderTest() {
    scene_.bench = ShareBench(/*clutter=*/false, {});
    scene_.robot = LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
    scene_.X_EC.translation() = Eigen::Vector3d(0.05, 0.0, 0.04);
    scene_.target.radius = kRadius;
    BulletArm arm(scene_.robot, {});
    Eigen::VectorXd q(7);
    q << 0.0, -0.7, 0.0, -2.2, 0.0, 1.6, 0.7;
    arm.SetState(q, Eigen::VectorXd::Zero(7));
    for (int i = 0; i < static_cast<int>(scene_.robot.links.size()); ++i) {
      exposure_.X_BL.push_back(arm.LinkPose(i));
    }
    exposure_.X_BC = arm.LinkPose(scene_.robot.tip) * scene_.X_EC;
  }

  cv::Mat Draw(SceneRenderer& renderer) {
    cv::Mat rgba(pinhole_.height_px, pinhole_.width_px, CV_8UC4);
    renderer.Draw(exposure_, exposure_.X_BC, {rgba.data, rgba.total() * 4});
    return rgba;
  }

  vision::Detection Detect(const cv::Mat& rgba) const {
    cv::Mat bgr;
    cv::cvtColor(rgba, bgr, cv::COLOR_RGBA2BGR);
    vision::DetectorConfig config;
    config.intrinsics = intrinsics_;
    config.size = 2.0 * kRadius;
    return vision::TargetDetector(config).Detect(bgr);
  }

  const Pinhole pinhole_ = MakePinhole(640, 480, 1.0471975511965976);
  const vision::Intrinsics intrinsics_{
      640, 480, pinhole_.f_px, pinhole_.f_px, pinhole_.c_u_px, pinhole_.c_v_px};
  RenderScene scene_;
  Exposure exposure_;
};

TEST_F(RenderTest, BallIsRenderedAtItsPosition) {
  SceneRenderer renderer(scene_, pinhole_, {});
  std::mt19937 engine(1);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(engine);
  };
  double centre2 = 0.0;
  double worst_px = 0.0;
  double worst_depth = 0.0;
  double chi2 = 0.0;
  constexpr int kCount = 40;
  for (int i = 0; i < kCount; ++i) {
    const double z = uniform(0.22, 0.40);
    const Eigen::Vector3d p_CO_C(z * uniform(-0.38, 0.38), z * uniform(-0.26, 0.26), z);
    exposure_.p_BO = exposure_.X_BC * p_CO_C;
    const vision::Detection d = Detect(Draw(renderer));
    ASSERT_TRUE(d.found) << "at " << p_CO_C.transpose();
    const Eigen::Vector3d s = p_CO_C / kRadius;
    const double error_px = std::hypot(intrinsics_.U(d.Middle()) - intrinsics_.U(s),
                                       intrinsics_.V(d.Middle()) - intrinsics_.V(s));
    centre2 += error_px * error_px;
    worst_px = std::max(worst_px, error_px);
    worst_depth = std::max(worst_depth, std::fabs(d.s.norm() / s.norm() - 1.0));
    chi2 += (d.s - s).dot(d.cov_s.inverse() * (d.s - s));
  }
  const double rms_px = std::sqrt(centre2 / kCount);
  std::cout << "centre " << rms_px << " px rms, worst " << worst_px << " px; distance, worst "
            << 100 * worst_depth << " %; chi2/3 " << chi2 / kCount / 3 << "\n";
  EXPECT_LT(chi2 / kCount / 3, 1.5) << "the covariance is too small";
  EXPECT_LT(rms_px, 0.035);
  EXPECT_LT(worst_px, 0.07);
  EXPECT_LT(worst_depth, 0.0005);
}

TEST_F(RenderTest, ObjectInFrontHidesTheBall) {
  SceneRenderer renderer(scene_, pinhole_, {});
  exposure_.p_BO = exposure_.X_BC * Eigen::Vector3d(0.0, 0.0, 0.3);
  ASSERT_TRUE(Detect(Draw(renderer)).found);
  exposure_.p_BO.z() = -0.06;  // just below the table's top
  EXPECT_FALSE(Detect(Draw(renderer)).found);
}

// Also one that copies what the first has painted, from views that use different levels of the textures.
TEST_F(RenderTest, TwoRenderersDrawTheSameBytes) {
  SceneRenderer first(scene_, pinhole_, {}, 0);
  SceneRenderer second(scene_, pinhole_, {}, 1);
  SceneRenderer twin(scene_, pinhole_, {}, 1, std::nullopt, &first);
  const auto draw = [this](SceneRenderer& renderer) {
    const cv::Mat picture = Draw(renderer).clone();
    renderer.Release();
    return picture;
  };
  exposure_.p_BO = exposure_.X_BC * Eigen::Vector3d(0.03, -0.02, 0.3);
  cv::Mat before;
  for (const double back : {0.0, 0.6, 1.2}) {
    exposure_.X_BC.translation() -= back * exposure_.X_BC.linear().col(2);
    const cv::Mat a = draw(first);
    EXPECT_EQ(cv::norm(a, draw(second), cv::NORM_INF), 0.0) << back;
    EXPECT_EQ(cv::norm(a, draw(twin), cv::NORM_INF), 0.0) << back;
    EXPECT_TRUE(before.empty() || cv::norm(a, before, cv::NORM_INF) > 0.0) << "another view";
    before = a;
  }
}

// Skipping geometry that the table hides gives the same bytes:
// from above the bench, from its edge and from beside it.
TEST_F(RenderTest, SkippingHiddenGeometryGivesTheSamePicture) {
  SceneRenderer renderer(scene_, pinhole_, {});
  SceneRenderer whole(scene_, pinhole_, {.skip_hidden = false}, 1);
  std::mt19937 engine(3);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(engine);
  };
  exposure_.p_BO = Eigen::Vector3d(0.5, 0.0, 0.04);
  int covered = 0;
  constexpr int kCount = 60;
  for (int i = 0; i < kCount; ++i) {
    exposure_.X_BC = Eigen::Translation3d(uniform(-0.3, 1.2), uniform(-0.6, 0.6), uniform(0.15, 0.9)) *
                     Eigen::AngleAxisd(uniform(-3.1, 3.1), Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(3.1416 + uniform(-0.6, 0.6), Eigen::Vector3d::UnitX());
    const bool is_covered =
        SeenOver(scene_.bench->planes.front(), pinhole_, exposure_.X_BC.cast<float>()).has_value();
    covered += is_covered ? 1 : 0;
    renderer.Release();
    const cv::Mat drawn = Draw(renderer).clone();
    renderer.Release();
    const cv::Mat expected = Draw(whole);
    whole.Release();
    EXPECT_EQ(cv::norm(drawn, expected, cv::NORM_INF), 0.0) << "picture " << i;
  }
  std::cout << covered << " of " << kCount << " pictures are filled by the table\n";
  EXPECT_GE(covered, 5);
  EXPECT_LE(covered, kCount - 5);
}

// Looking straight down from height h, the picture's corners meet the plane at h times their rays.
TEST(Cover, VisiblePartOfATableMatchesTheViewRays) {
  const Pinhole pinhole = MakePinhole(640, 480, 1.0471975511965976);
  TexturedPlane plane;
  plane.size = {1.6F, 1.3F};
  const auto from = [](float x, float y, float z) {
    return Eigen::Isometry3f(Eigen::Translation3f(x, y, z) *
                             Eigen::AngleAxisf(3.14159265F, Eigen::Vector3f::UnitX()));
  };
  const auto seen = SeenOver(plane, pinhole, from(0.1F, 0.0F, 0.5F));
  ASSERT_TRUE(seen.has_value());
  const auto reach = static_cast<float>(0.5 * (319.5 + 2.0) / pinhole.f_px);
  EXPECT_NEAR(seen->min().x(), 0.1F - reach - 0.02F, 1e-5F);
  EXPECT_NEAR(seen->max().x(), 0.1F + reach + 0.02F, 1e-5F);
  EXPECT_FLOAT_EQ(seen->min().z(), -0.03F);
  EXPECT_NEAR(seen->max().z(), 0.52F, 1e-6F);
  EXPECT_FALSE(SeenOver(plane, pinhole, from(0.55F, 0.0F, 0.5F)).has_value()) << "over the edge";
  EXPECT_FALSE(SeenOver(plane, pinhole, from(0.0F, 0.0F, -0.5F)).has_value()) << "from below";
  EXPECT_FALSE(SeenOver(plane, pinhole, from(0.0F, 0.0F, 2.0F)).has_value()) << "from too far";
  const Eigen::Isometry3f level(Eigen::AngleAxisf(1.57079633F, Eigen::Vector3f::UnitX()));
  EXPECT_FALSE(SeenOver(plane, pinhole, Eigen::Translation3f(0.0F, 0.0F, 0.5F) * level).has_value());
}

TEST_F(RenderTest, BrightnessIsProportionalToTheLight) {
  exposure_.p_BO = exposure_.X_BC * Eigen::Vector3d(0.0, 0.0, 0.3);
  const auto mean = [&](double light) {
    scene_.light = light;
    SceneRenderer renderer(scene_, pinhole_, {});
    return cv::mean(Draw(renderer))[1];
  };
  const double full = mean(1.0);
  EXPECT_NEAR(mean(0.1) / full, 0.1, 0.02);
}

}  // namespace
}  // namespace fovea::sim
