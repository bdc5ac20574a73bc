// SPDX-License-Identifier: Apache-2.0
// Each target partly hidden, or moving out of the picture and back: found correctly or refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>

#include "firmware/vision/detect/target_detector.hpp"
#include "tools/bench/vision/picture_target.hpp"
#include "tools/bench/vision/scenes.hpp"

namespace fovea::vision {
namespace {

using bench::TargetKind;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kWrongPx = 2.0;  // a larger error counts as wrong

DetectorConfig ByBrightness(TargetKind kind) { return bench::ConfigOf(kind, {}, FindBy::kGray); }

struct Score {
  int found = 0;
  int wrong = 0;
  double rms_px = 0.0;
};

// Measures `pictures` of a target whose outline is hidden by a bar over the share
// `hidden`, then half as many pictures of the bar alone.
Score Look(TargetKind kind, double hidden, int pictures) {
  const bench::SceneClass scenes{.name = "hidden", .noise = 3.0, .hidden = hidden};
  Score score;
  double sum2 = 0.0;
  for (int i = 0; i < pictures + pictures / 2; ++i) {
    const bench::PictureScene scene = MakeScene(scenes, kind, i < pictures, static_cast<unsigned>(1000 + i));
    const Detection d = TargetDetector(ByBrightness(kind)).Detect(Draw(scene));
    const double off = !d.found       ? 0.0
                       : i < pictures ? OffOf(d, scene)
                                      : std::numeric_limits<double>::infinity();
    score.wrong += off > kWrongPx ? 1 : 0;
    if (d.found && off <= kWrongPx) {
      ++score.found;
      sum2 += off * off;
    }
  }
  score.rms_px = std::sqrt(sum2 / std::max(score.found, 1));
  std::cout << 100.0 * hidden << " % hidden: found " << score.found << " of " << pictures << ", wrong "
            << score.wrong << ", worst corner or centre " << score.rms_px << " px rms\n";
  return score;
}

// Required results with 10, 20 and 30 % hidden.
struct Least {
  TargetKind kind;
  std::array<int, 3> found;  // of 20
  std::array<double, 3> rms_px;
  double way_px;  // largest error on the way out and back
};

class HiddenTargetTest : public testing::TestWithParam<Least> {};

// If one side of a square is hidden completely, the other three fit many squares: such pictures are refused.
INSTANTIATE_TEST_SUITE_P(
    Kinds, HiddenTargetTest,
    testing::Values(Least{TargetKind::kSphere, {20, 19, 20}, {0.034, 0.017, 0.026}, 0.036},
                    Least{TargetKind::kCircle, {20, 20, 19}, {0.043, 0.070, 0.039}, 0.30},
                    Least{TargetKind::kSquare, {16, 12, 2}, {0.36, 0.46, 1.0}, 0.040},
                    Least{TargetKind::kTriangle, {17, 17, 16}, {0.054, 0.085, 0.43}, 0.165}));

TEST_P(HiddenTargetTest, IsFoundCorrectlyOrNotAtAll) {
  const Least& least = GetParam();
  for (std::size_t i = 0; i < least.found.size(); ++i) {
    const Score score = Look(least.kind, 0.1 * (static_cast<double>(i) + 1.0), 20);
    EXPECT_EQ(score.wrong, 0);
    EXPECT_GE(score.found, least.found[i]);
    EXPECT_LT(score.rms_px, least.rms_px[i]);
  }
}

// Moves out over the right border and back in; one detector processes all pictures.
TEST_P(HiddenTargetTest, IsLostOutsideThePictureAndFoundAgain) {
  const TargetKind kind = GetParam().kind;
  constexpr std::array<double, 14> kX{0.10, 0.15, 0.18, 0.20, 0.22, 0.24, 0.30,
                                      0.40, 0.30, 0.24, 0.22, 0.19, 0.14, 0.08};
  TargetDetector detector(ByBrightness(kind));
  const bench::SceneClass scenes{.name = "way", .noise = 3.0};
  bench::PictureScene scene = MakeScene(scenes, kind, true, 7);
  int inside = 0;
  double worst_px = 0.0;
  for (std::size_t i = 0; i < kX.size(); ++i) {
    scene.seed = static_cast<unsigned>(i + 1);
    scene.bodies.front().p = Vector3d(kX[i], 0.02, 0.4);
    const bench::TrueOutline outline = OutlineOf(scene.camera, scene.bodies.front());
    const auto in_picture = std::count_if(outline.points.begin(), outline.points.end(),
                                          [](const Vector2d& p) { return p.x() < 630.0; });
    const Detection d = detector.Detect(Draw(scene));
    if (in_picture == 0) {
      EXPECT_FALSE(d.found) << "at " << kX[i];
    } else if (in_picture == static_cast<std::ptrdiff_t>(outline.points.size())) {
      EXPECT_TRUE(d.found) << "at " << kX[i];
      ++inside;
    }
    if (d.found) {
      worst_px = std::max(worst_px, OffOf(d, scene));
    }
  }
  std::cout << inside << " of " << kX.size() << " pictures show the whole target; worst " << worst_px
            << " px\n";
  EXPECT_GE(inside, 3);
  EXPECT_LT(worst_px, GetParam().way_px);
}

}  // namespace
}  // namespace fovea::vision
