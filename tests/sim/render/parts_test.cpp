// SPDX-License-Identifier: Apache-2.0
// Pictures that are drawn in parts, and by a renderer that has shown other scenes before: their pixels are
// those of whole pictures by a new renderer, to the last bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>

#include "fovea/hal/types.hpp"
#include "sim/camera/on_demand_camera.hpp"
#include "sim/camera/optics.hpp"
#include "sim/physics/bullet_arm.hpp"
#include "sim/render/renderer_pool.hpp"
#include "tests/support/places.hpp"

namespace fovea::sim {
namespace {

using Rgba = std::vector<std::uint8_t>;

class PartsTest : public ::testing::Test {
 protected:
  PartsTest() {
    scene_.bench = ShareBench(/*clutter=*/true, {});
    scene_.robot = LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
    scene_.X_EC.translation() = Eigen::Vector3d(0.05, 0.0, 0.04);
  }

  Exposure ExposureAt(double turn) const {
    BulletArm arm(scene_.robot, {});
    Eigen::VectorXd q(7);
    q << turn, -0.7, 0.1, -2.2, 0.2, 1.6, 0.7;
    arm.SetState(q, Eigen::VectorXd::Zero(7));
    Exposure exposure;
    for (int i = 0; i < static_cast<int>(scene_.robot.links.size()); ++i) {
      exposure.X_BL.push_back(arm.LinkPose(i));
    }
    exposure.X_BC = arm.LinkPose(scene_.robot.tip) * scene_.X_EC;
    exposure.p_BO = Eigen::Vector3d(0.55, 0.05, 0.04);
    return exposure;
  }
  Rgba Blank() const {
    return Rgba(static_cast<std::size_t>(4 * pinhole_.width_px * pinhole_.height_px), std::uint8_t{7});
  }
  Rgba DrawBy(Optics& optics, const Exposure& exposure, std::span<const PictureArea> areas = {}) const {
    Rgba rgba = Blank();
    optics.Draw(exposure, rgba, areas);
    optics.Release();
    return rgba;
  }
  std::vector<PictureArea> RandomAreas(std::mt19937& engine) const {
    std::vector<PictureArea> areas;
    const auto whole = [&](int most) { return static_cast<int>(engine() % static_cast<unsigned>(most)); };
    for (int i = 0; i < 6; ++i) {
      const int left = whole(pinhole_.width_px - 4);
      const int top = whole(pinhole_.height_px - 4);
      areas.push_back({left, top, 1 + whole(std::min(pinhole_.width_px - left, 160)),
                       1 + whole(std::min(pinhole_.height_px - top, 120))});
    }
    return areas;
  }
  // The number of pixels of `areas` that differ, and of all others.
  std::pair<int, int> Different(const Rgba& a, const Rgba& b, std::span<const PictureArea> areas) const {
    int inside = 0;
    int outside = 0;
    for (int y = 0; y < pinhole_.height_px; ++y) {
      for (int x = 0; x < pinhole_.width_px; ++x) {
        const auto k = static_cast<std::ptrdiff_t>(4 * (y * pinhole_.width_px + x));
        if (std::equal(a.begin() + k, a.begin() + k + 4, b.begin() + k)) {
          continue;
        }
        const bool is_inside = std::ranges::any_of(areas, [&](const PictureArea& area) {
          return x >= area.left_px && x < area.left_px + area.width_px && y >= area.top_px &&
                 y < area.top_px + area.height_px;
        });
        ++(is_inside ? inside : outside);
      }
    }
    return {inside, outside};
  }
  void ExpectPartsOfWhole(const Shutter& shutter, const Exposure& exposure) {
    Optics optics(scene_, pinhole_, {}, Sampling::kPlain, 0, shutter);
    std::mt19937 engine(11);
    const Rgba whole = DrawBy(optics, exposure);
    for (int i = 0; i < 3; ++i) {
      const std::vector<PictureArea> areas = RandomAreas(engine);
      const auto [inside, outside] = Different(DrawBy(optics, exposure, areas), whole, areas);
      EXPECT_EQ(inside, 0);
      EXPECT_GT(outside, 0) << "the rest was drawn too";
    }
    EXPECT_EQ(DrawBy(optics, exposure), whole) << "a picture in parts changes the next one";
  }

  const Pinhole pinhole_ = MakePinhole(320, 240, 1.0);
  RenderScene scene_;
};

TEST_F(PartsTest, PixelsOfAPartAreThoseOfTheWhole) {
  for (const auto kind : {TargetShape::Kind::kBall, TargetShape::Kind::kDisc}) {
    scene_.target.kind = kind;
    ExpectPartsOfWhole({}, ExposureAt(0.0));
  }
}

TEST_F(PartsTest, PixelsOfAPartAreThoseOfTheWholeWithBlurAndRollingShutter) {
  Exposure exposure = ExposureAt(0.0);
  auto around = std::make_shared<std::vector<Moment>>();
  for (int ms = -12; ms <= 12; ++ms) {
    Moment moment = ExposureAt(0.0005 * ms);
    moment.time_ns = ms * hal::kNsPerMs;
    moment.p_BO.y() += 2e-4 * ms;
    around->push_back(moment);
  }
  exposure.around = around;
  ExpectPartsOfWhole({.exposure_ns = 5'000'000, .sub_exposures = 3, .row_time_ns = 30e3}, exposure);
}

TEST_F(PartsTest, ARendererThatHasShownAnotherSceneDrawsAsANewOne) {
  RendererPool pool;
  const Exposure exposure = ExposureAt(0.3);
  RenderScene other = scene_;
  other.X_EC.translation() = Eigen::Vector3d(0.0, 0.08, 0.02);
  other.target.kind = TargetShape::Kind::kPolygon;
  other.target.corners = {{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}};
  other.target_colour = Eigen::Vector3f(0.1F, 0.5F, 0.2F);
  other.light = 0.4;
  const Pinhole wide = MakePinhole(400, 300, 1.3);
  {
    Optics before(other, wide, {}, Sampling::kPlain, 0, {}, nullptr, &pool);
    Rgba rgba(static_cast<std::size_t>(4 * wide.width_px * wide.height_px));
    before.Draw(exposure, rgba);
    before.Release();
  }
  const auto fitting = pool.Take(scene_, pinhole_, RenderQuality{}, 0, std::nullopt, nullptr);
  ASSERT_NE(fitting, nullptr);
  Rgba again = Blank();
  fitting->Draw(exposure, exposure.X_BC, again);
  fitting->Release();
  Optics fresh(scene_, pinhole_, {}, Sampling::kPlain);
  EXPECT_EQ(DrawBy(fresh, exposure), again);
}

TEST_F(PartsTest, APoolKeepsTheLastRendererOfEachIndexAndGivesItForTheSameBenchOnly) {
  RendererPool pool;
  auto first = pool.Take(scene_, pinhole_, RenderQuality{}, 0, std::nullopt, nullptr);
  first->Release();
  const SceneRenderer* const made = first.get();
  pool.Give(std::move(first));
  RenderScene bare = scene_;
  bare.bench = ShareBench(/*clutter=*/false, {});
  ASSERT_NE(bare.bench, scene_.bench);
  auto of_another = pool.Take(bare, pinhole_, RenderQuality{}, 0, std::nullopt, nullptr);
  EXPECT_NE(of_another.get(), made);
  of_another->Release();
  EXPECT_EQ(pool.Take(scene_, pinhole_, RenderQuality{}, 0, std::nullopt, nullptr).get(), made);
}

// Who draws and gives on one thread need not release: the next renderer's context takes the place of the last
// one's, and the last one must not delete things of the next.
TEST_F(PartsTest, ARendererThatReplacesAnotherInThePoolStaysWhole) {
  RendererPool pool;
  const Exposure exposure = ExposureAt(0.1);
  RenderScene bare = scene_;
  bare.bench = ShareBench(/*clutter=*/false, {});
  const auto draw = [&](const RenderScene& scene) {
    auto renderer = pool.Take(scene, pinhole_, RenderQuality{}, 0, std::nullopt, nullptr);
    Rgba rgba = Blank();
    renderer->Draw(exposure, exposure.X_BC, rgba);
    pool.Give(std::move(renderer));
    return rgba;
  };
  const Rgba first = draw(bare);
  const Rgba other = draw(scene_);
  EXPECT_NE(first, other);
  EXPECT_EQ(draw(scene_), other);
  EXPECT_EQ(draw(bare), first);
}

TEST_F(PartsTest, BenchesAreSharedWhileSomebodyHoldsThem) {
  const std::vector<Eigen::AlignedBox3d> boxes{
      {Eigen::Vector3d(0.2, 0.2, 0.0), Eigen::Vector3d(0.3, 0.3, 0.1)}};
  EXPECT_EQ(ShareBench(true, {}), scene_.bench);
  const auto with_box = ShareBench(true, boxes);
  EXPECT_NE(with_box, scene_.bench);
  EXPECT_EQ(with_box->boxes.size(), 1U);
  EXPECT_EQ(with_box->things.size(), scene_.bench->things.size() + 1);
}

// Each call of Make adds to the picture; the sensor's noise is that of the frame.
TEST_F(PartsTest, ACameraOnDemandGivesThePixelsOfOneThatDrawsAll) {
  const SimCameraConfig config{
      .width_px = pinhole_.width_px, .height_px = pinhole_.height_px, .exposure_ns = 1000, .queue = 4};
  Optics optics(scene_, pinhole_, {}, Sampling::kPlain);
  Exposure exposure = ExposureAt(-0.2);
  exposure.sequence = 9;
  std::vector<std::uint8_t> all;
  {
    SimCamera camera(config, Sensor({.read_sigma = 2.0}, 1),
                     {{[&](const Exposure& e, std::span<std::uint8_t> rgba) { optics.Draw(e, rgba); },
                       {},
                       [&] { optics.Release(); }}});
    camera.Expose(exposure);
    hal::Frame frame;
    ASSERT_TRUE(camera.Acquire(frame, hal::kNsPerSecond * 20).ok());
    EXPECT_EQ(frame.maker, nullptr);
    all.assign(frame.pixels.begin(), frame.pixels.end());
  }
  OnDemandCamera camera(
      config, Sensor({.read_sigma = 2.0}, 1),
      [&](const Exposure& e, std::span<const PictureArea> areas, std::span<std::uint8_t> rgba) {
        optics.Draw(e, rgba, areas);
      },
      [&] { optics.Release(); });
  camera.Expose(exposure);
  hal::Frame frame;
  ASSERT_TRUE(camera.Acquire(frame, 0).ok());
  ASSERT_NE(frame.maker, nullptr);
  const std::vector<hal::PixelArea> areas{{10, 20, 50, 40}, {200, 100, 30, 60}};
  for (const hal::PixelArea& area : areas) {
    frame.maker->Make({&area, 1});
  }
  int compared = 0;
  for (const hal::PixelArea& area : areas) {
    for (int y = area.top_px; y < area.top_px + area.height_px; ++y) {
      const auto from = static_cast<std::ptrdiff_t>(3 * (y * config.width_px + area.left_px));
      EXPECT_TRUE(std::equal(all.begin() + from, all.begin() + from + 3 * area.width_px,
                             frame.pixels.begin() + from));
      compared += area.width_px;
    }
  }
  EXPECT_EQ(compared, 50 * 40 + 30 * 60);
}

TEST_F(PartsTest, ACameraOnDemandThatCannotDrawIsADeviceFaultWithItsMessage) {
  OnDemandCamera camera(
      {.width_px = 64, .height_px = 48, .exposure_ns = 1000, .queue = 4}, Sensor({}, 1),
      [](const Exposure&, std::span<const PictureArea>, std::span<std::uint8_t>) {
        throw std::runtime_error("no light");
      },
      [] {});
  camera.Expose({});
  camera.Expose({});
  hal::Frame frame;
  ASSERT_TRUE(camera.Acquire(frame, 0).ok());
  const hal::PixelArea area{0, 0, 8, 8};
  frame.maker->Make({&area, 1});
  EXPECT_EQ(camera.fault(), "no light");
  EXPECT_EQ(camera.Acquire(frame, 0).code(), hal::StatusCode::kDeviceFault);
}

}  // namespace
}  // namespace fovea::sim
