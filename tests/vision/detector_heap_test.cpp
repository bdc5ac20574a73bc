// SPDX-License-Identifier: Apache-2.0
// After the first images a detector makes no heap call. Every
// malloc of the process is counted, also inside OpenCV.
#include <gtest/gtest.h>

#include <iostream>
#include <vector>

#include "firmware/vision/detect/target_detector.hpp"
#include "fovea/linux_rt/heap_counter.hpp"
#include "tools/bench/vision/picture_target.hpp"
#include "tools/bench/vision/scenes.hpp"

namespace fovea::vision {
namespace {

using bench::TargetKind;

template <class Function>
std::uint64_t HeapCallsOf(Function function) {
  const std::uint64_t before = linux_rt::CountedHeapCalls();
  linux_rt::EnterCountedRegion();
  function();
  linux_rt::LeaveCountedRegion();
  return linux_rt::CountedHeapCalls() - before;
}

cv::Mat PictureOf(const char* name, TargetKind kind, bool with_target) {
  for (const bench::SceneClass& scene_class : bench::SceneClasses()) {
    if (scene_class.name == name) {
      return Draw(MakeScene(scene_class, kind, with_target, 4));
    }
  }
  ADD_FAILURE() << "no class " << name;
  return {};
}

class DetectorHeapTest : public testing::Test {
 protected:
  void SetUp() override {
#ifdef FOVEA_SANITIZED
    GTEST_SKIP() << "a sanitizer replaces malloc";
#endif
    ASSERT_TRUE(linux_rt::HeapCounterActive())
        << "the interposer is not linked: a count of 0 would mean nothing";
    cv::setNumThreads(1);
  }

  // Heap calls of four images: found by a search, tracked, lost, found again. Counted in the second round.
  static std::uint64_t CallsOf(TargetKind kind, FindBy by) {
    const char* scene = by == FindBy::kColour ? "clutter" : "noise-15";
    const cv::Mat with = PictureOf(scene, kind, true);
    const cv::Mat without = PictureOf(scene, kind, false);
    TargetDetector detector(bench::ConfigOf(kind, {}, by));
    std::uint64_t calls = 0;
    for (int round = 0; round < 2; ++round) {
      calls = HeapCallsOf([&] {
        EXPECT_TRUE(detector.Detect(with).found);
        EXPECT_TRUE(detector.Detect(with).tracked);
        EXPECT_FALSE(detector.Detect(without).found);
        EXPECT_TRUE(detector.Detect(with).found);
      });
      detector.Forget();
    }
    std::cout << calls << " heap calls in 4 images\n";
    return calls;
  }
};

TEST_F(DetectorHeapTest, SphereByBrightnessMakesNoHeapCall) {
  EXPECT_EQ(CallsOf(TargetKind::kSphere, FindBy::kGray), 0U);
}
TEST_F(DetectorHeapTest, SphereByColourMakesNoHeapCall) {
  EXPECT_EQ(CallsOf(TargetKind::kSphere, FindBy::kColour), 0U);
}
TEST_F(DetectorHeapTest, DiscByBrightnessMakesNoHeapCall) {
  EXPECT_EQ(CallsOf(TargetKind::kCircle, FindBy::kGray), 0U);
}
TEST_F(DetectorHeapTest, DiscByColourMakesNoHeapCall) {
  EXPECT_EQ(CallsOf(TargetKind::kCircle, FindBy::kColour), 0U);
}
TEST_F(DetectorHeapTest, SquareByBrightnessMakesNoHeapCall) {
  EXPECT_EQ(CallsOf(TargetKind::kSquare, FindBy::kGray), 0U);
}
TEST_F(DetectorHeapTest, SquareByColourMakesNoHeapCall) {
  EXPECT_EQ(CallsOf(TargetKind::kSquare, FindBy::kColour), 0U);
}
TEST_F(DetectorHeapTest, TriangleByBrightnessMakesNoHeapCall) {
  EXPECT_EQ(CallsOf(TargetKind::kTriangle, FindBy::kGray), 0U);
}
TEST_F(DetectorHeapTest, TriangleByColourMakesNoHeapCall) {
  EXPECT_EQ(CallsOf(TargetKind::kTriangle, FindBy::kColour), 0U);
}

// Checks the check: a heap call is counted.
TEST_F(DetectorHeapTest, HeapCallOfAVectorIsCounted) {
  EXPECT_EQ(HeapCallsOf([] {
              std::vector<EdgePoint> points(7);
              volatile const float* kept = &points[3].gu;
              static_cast<void>(*kept);
            }),
            2U);
}

}  // namespace
}  // namespace fovea::vision
