// SPDX-License-Identifier: Apache-2.0
// A camera that makes only the pixels that vision asks for (hal::PixelMaker): each measurement is that of the
// whole picture, to the last bit. Pixels that nobody asked for are noise here.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <random>
#include <vector>

#include "firmware/core/model/rotation.hpp"
#include "firmware/vision/detect/vision_task.hpp"
#include "tools/bench/vision/picture.hpp"
#include "tools/bench/vision/scenes.hpp"

namespace fovea::vision {
namespace {

using model::Vec3;

// Shows parts of `whole`, and noise elsewhere.
class Peephole final : public hal::PixelMaker {
 public:
  explicit Peephole(const cv::Mat& whole, unsigned seed) : whole_(whole), shown_(whole.size(), whole.type()) {
    std::mt19937 engine(seed);
    for (int y = 0; y < shown_.rows; ++y) {
      std::generate_n(shown_.ptr(y), shown_.step[0], [&] { return static_cast<std::uint8_t>(engine()); });
    }
  }
  void Make(std::span<const hal::PixelArea> areas) noexcept override {
    ++calls;
    for (const hal::PixelArea& area : areas) {
      const cv::Rect rect(area.left_px, area.top_px, area.width_px, area.height_px);
      whole_(rect).copyTo(shown_(rect));
      made += rect.area();
    }
  }
  hal::Frame FrameOf(const cv::Mat& image, hal::PixelMaker* maker) {
    hal::Frame frame;
    frame.width_px = image.cols;
    frame.height_px = image.rows;
    frame.stride_bytes = static_cast<std::int32_t>(image.step);
    frame.format = image.channels() == 1 ? hal::PixelFormat::kMono8 : hal::PixelFormat::kBgr8;
    frame.pixels = {image.data, image.step * static_cast<std::size_t>(image.rows)};
    frame.maker = maker;
    return frame;
  }
  hal::Frame Whole() { return FrameOf(whole_, nullptr); }
  hal::Frame Partial() { return FrameOf(shown_, this); }

  int calls = 0;
  std::int64_t made = 0;  // pixels

 private:
  const cv::Mat whole_;
  cv::Mat shown_;
};

void ExpectSame(const hal::FeatureMeasurement& a, const hal::FeatureMeasurement& b) {
  EXPECT_EQ(a.found, b.found);
  EXPECT_EQ(a.same_for_ns, b.same_for_ns);
  EXPECT_EQ(a.confidence, b.confidence);
  EXPECT_EQ(a.s, b.s);
  EXPECT_EQ(a.cov_s, b.cov_s);
  EXPECT_EQ(a.num_poses, b.num_poses);
  for (std::size_t i = 0; i < static_cast<std::size_t>(a.num_poses); ++i) {
    EXPECT_EQ(a.poses[i].p_CO_C, b.poses[i].p_CO_C);
    EXPECT_EQ(a.poses[i].q_CO, b.poses[i].q_CO);
  }
}

struct Case {
  hal::FeatureKind kind;
  FindBy by;
};

class PartialPictureTest : public testing::TestWithParam<Case> {};

// The target wanders, in front of other things, is partly hidden, leaves the picture, and jumps.
TEST_P(PartialPictureTest, MeasurementsAreThoseOfWholePictures) {
  constexpr int kPictures = 60;
  const auto [kind, by] = GetParam();
  DetectorConfig config;
  config.LookFor(bench::TargetOf(kind));
  config.by = by;
  const bench::PictureCamera camera;
  config.intrinsics = {camera.width_px, camera.height_px, camera.f_px,
                       camera.f_px,     camera.c_u_px,    camera.c_v_px};
  VisionTask whole(config);
  VisionTask partial(config);
  std::mt19937 engine(3);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(engine);
  };
  int found = 0;
  int tracked = 0;
  std::int64_t pixels_of_tracked = 0;
  Vec3 p(0.0, 0.0, 0.4);
  Vec3 step = Vec3::Zero();
  bench::PictureScene scene = bench::MakeScene(bench::SceneClasses().front(), kind, true, 5);
  for (int i = 0; i < kPictures; ++i) {
    step = 0.7 * step + 0.004 * Vec3(uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0));
    p += step;
    if (i % 17 == 16) {
      p = Vec3(uniform(-0.2, 0.2), uniform(-0.14, 0.14), uniform(0.3, 0.7));
    }
    scene.gray = by == FindBy::kGray;
    scene.noise = 2.0;
    scene.seed = static_cast<unsigned>(i + 1);
    scene.grid = 3;
    scene.bodies.front().p = p;
    scene.bodies.front().R =
        model::RotationOf(Vec3(0.3 * uniform(-1.0, 1.0), 0.3 * uniform(-1.0, 1.0), 0.01 * i));
    if (kind != hal::FeatureKind::kSphere && kind != hal::FeatureKind::kCircle && i % 9 == 8) {
      scene.bodies.front().p.x() += 0.25;  // at the picture's edge, or out of it
    }
    if (by == FindBy::kColour) {
      scene.bodies.front().bgr = Vec3(20.0, 25.0, 190.0);
    }
    Peephole peephole(bench::Draw(scene), static_cast<unsigned>(i));
    hal::FeatureMeasurement by_all;
    hal::FeatureMeasurement by_parts;
    ASSERT_TRUE(whole.Process(peephole.Whole(), by_all).ok());
    ASSERT_TRUE(partial.Process(peephole.Partial(), by_parts).ok());
    ExpectSame(by_all, by_parts);
    ASSERT_EQ(whole.last().tracked, partial.last().tracked);
    found += by_all.found ? 1 : 0;
    if (whole.last().tracked) {
      ++tracked;
      pixels_of_tracked += peephole.made;
    }
  }
  const double share =
      static_cast<double>(pixels_of_tracked) / (tracked * camera.width_px * camera.height_px);
  std::cout << "found in " << found << " of " << kPictures << " pictures, " << tracked
            << " by tracking, which looked at " << 100.0 * share << " % of the pixels\n";
  EXPECT_GT(tracked, kPictures / 2);
  // Without colour, whether a triangle's sides go on is looked for far beyond its corners.
  EXPECT_LT(share, by == FindBy::kColour ? 0.4 : 0.9) << "some of the picture is left alone";
}

INSTANTIATE_TEST_SUITE_P(Targets, PartialPictureTest,
                         testing::Values(Case{hal::FeatureKind::kSphere, FindBy::kColour},
                                         Case{hal::FeatureKind::kSphere, FindBy::kGray},
                                         Case{hal::FeatureKind::kCircle, FindBy::kColour},
                                         Case{hal::FeatureKind::kCircle, FindBy::kGray},
                                         Case{hal::FeatureKind::kSquare, FindBy::kColour},
                                         Case{hal::FeatureKind::kSquare, FindBy::kGray},
                                         Case{hal::FeatureKind::kTriangle, FindBy::kColour},
                                         Case{hal::FeatureKind::kTriangle, FindBy::kGray}));

}  // namespace
}  // namespace fovea::vision
