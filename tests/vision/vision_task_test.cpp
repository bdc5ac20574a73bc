// SPDX-License-Identifier: Apache-2.0
// Pictures that the detector must refuse, and how the vision task passes results on.
#include "firmware/vision/detect/vision_task.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <iostream>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "tests/support/fake_drivers.hpp"
#include "tests/support/ray_cast_ball.hpp"

namespace fovea::vision {
namespace {

DetectorConfig Config() {
  const test::BallPicture p;
  DetectorConfig config;
  config.intrinsics = {p.width_px, p.height_px, p.f_px, p.f_px, p.c_u_px, p.c_v_px};
  config.size = 2.0 * p.radius;
  return config;
}

cv::Mat Ground() { return cv::Mat(480, 640, CV_8UC3, cv::Scalar(60, 52, 30)); }
const cv::Scalar kRed(15, 18, 190);

bool Finds(const cv::Mat& image) {
  TargetDetector detector(Config());
  return detector.Detect(image).found;
}

TEST(TargetDetectorTest, FindsNothingInEmptyPictures) {
  EXPECT_FALSE(Finds(Ground()));
  EXPECT_FALSE(Finds(cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(0)))) << "black";
  EXPECT_FALSE(Finds(cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(255)))) << "saturated";
  EXPECT_FALSE(Finds(cv::Mat(480, 640, CV_8UC3, kRed))) << "all red: a target larger than the picture";
  cv::Mat noise(480, 640, CV_8UC3);
  cv::RNG rng(3);
  rng.fill(noise, cv::RNG::NORMAL, 128, 60);
  EXPECT_FALSE(Finds(noise));
}

TEST(TargetDetectorTest, RefusesOtherShapesColoursAndSizes) {
  cv::Mat square = Ground();
  cv::rectangle(square, {250, 180}, {350, 280}, kRed, cv::FILLED, cv::LINE_AA);
  EXPECT_FALSE(Finds(square));
  cv::Mat bar = Ground();
  cv::rectangle(bar, {150, 220}, {450, 260}, kRed, cv::FILLED, cv::LINE_AA);
  EXPECT_FALSE(Finds(bar));
  cv::Mat triangle = Ground();
  cv::fillConvexPoly(triangle, std::vector<cv::Point>{{320, 150}, {400, 300}, {240, 300}}, kRed, cv::LINE_AA);
  EXPECT_FALSE(Finds(triangle));
  cv::Mat blue = Ground();
  cv::circle(blue, {320, 240}, 50, {190, 40, 15}, cv::FILLED, cv::LINE_AA);
  EXPECT_FALSE(Finds(blue));
  cv::Mat gray = Ground();
  cv::circle(gray, {320, 240}, 50, {160, 160, 160}, cv::FILLED, cv::LINE_AA);
  EXPECT_FALSE(Finds(gray));
  cv::Mat small = Ground();  // an 80 mm ball of this size would be 2.2 m away
  cv::circle(small, {320, 240}, 10, kRed, cv::FILLED, cv::LINE_AA);
  EXPECT_FALSE(Finds(small));
  cv::Mat half = Ground();
  cv::ellipse(half, {320, 240}, {50, 50}, 0, 0, 180, kRed, cv::FILLED, cv::LINE_AA);
  EXPECT_FALSE(Finds(half));
}

TEST(TargetDetectorTest, FindsPartlyHiddenAndPartlyOutOfViewTargets) {
  test::BallPicture picture;
  picture.noise = 3.0;
  cv::Mat image = test::RayCast(picture);
  cv::rectangle(image, {330, 100}, {420, 230}, {90, 140, 150}, cv::FILLED);  // over the upper right quarter
  TargetDetector detector(Config());
  const Detection d = detector.Detect(image);
  ASSERT_TRUE(d.found);
  EXPECT_LT(d.confidence, 0.9) << "the confidence is lower";
  EXPECT_NEAR(d.s.x(), 0.0, 0.02);
  EXPECT_NEAR(d.s.z(), 10.0, 0.05);

  picture.x = -0.215;  // a third of it is outside the left border
  TargetDetector other(Config());
  const Detection edge = other.Detect(test::RayCast(picture));
  ASSERT_TRUE(edge.found);
  EXPECT_NEAR(edge.s.x(), picture.x / picture.radius, 0.02);
}

TEST(TargetDetectorTest, TracksWithoutSearchingAndFindsAgainAfterAJump) {
  TargetDetector detector(Config());
  test::BallPicture picture;
  picture.grid = 4;
  picture.noise = 3.0;
  for (int i = 0; i < 6; ++i) {
    picture.x = -0.05 + 0.008 * i;
    picture.seed = static_cast<unsigned>(i + 1);
    const Detection d = detector.Detect(test::RayCast(picture));
    ASSERT_TRUE(d.found);
    EXPECT_EQ(d.tracked, i > 0);
    EXPECT_NEAR(d.s.x(), picture.x / picture.radius, 0.01);
  }
  picture.x = 0.12;
  const Detection jumped = detector.Detect(test::RayCast(picture));
  ASSERT_TRUE(jumped.found);
  EXPECT_FALSE(jumped.tracked);
  EXPECT_FALSE(detector.Detect(Ground()).found);
}

class VisionTaskTest : public testing::Test {
 protected:
  hal::Frame FrameOf(const cv::Mat& image) {
    hal::Frame frame;
    frame.stamp_ns = 123;
    frame.sequence = 45;
    frame.width_px = image.cols;
    frame.height_px = image.rows;
    frame.stride_bytes = static_cast<std::int32_t>(image.step);
    frame.format = image.channels() == 1 ? hal::PixelFormat::kMono8 : hal::PixelFormat::kBgr8;
    frame.pixels = {image.data, image.step * static_cast<std::size_t>(image.rows)};
    return frame;
  }
  VisionTask task_{Config()};
};

TEST_F(VisionTaskTest, PassesTheFeatureOnWithItsStamp) {
  const cv::Mat image = test::RayCast({});
  hal::FeatureMeasurement m;
  ASSERT_TRUE(task_.Process(FrameOf(image), m).ok());
  EXPECT_TRUE(m.found);
  EXPECT_EQ(m.stamp_ns, 123);
  EXPECT_EQ(m.sequence, 45U);
  EXPECT_EQ(m.dim, 3);
  EXPECT_NEAR(m.s[2], 10.0, 0.02);
  EXPECT_GT(m.cov_s[0], 0.0);
  EXPECT_GT(m.cov_s[2 * hal::kMaxFeatureDim + 2], m.cov_s[0]) << "depth is the least certain";

  const cv::Mat empty = Ground();
  ASSERT_TRUE(task_.Process(FrameOf(empty), m).ok());
  EXPECT_FALSE(m.found);
  EXPECT_EQ(m.dim, 0);
  EXPECT_EQ(m.stamp_ns, 123) << "the frame was processed";
}

TEST_F(VisionTaskTest, AcceptsPaddedRowsAndGrayFrames) {
  const cv::Mat image = test::RayCast({});
  cv::Mat wide(image.rows, image.cols + 37, CV_8UC3, cv::Scalar::all(255));
  image.copyTo(wide.colRange(0, image.cols));
  hal::Frame frame = FrameOf(wide);
  frame.width_px = image.cols;
  hal::FeatureMeasurement m;
  ASSERT_TRUE(task_.Process(frame, m).ok());
  EXPECT_TRUE(m.found);
  EXPECT_NEAR(m.s[2], 10.0, 0.02);

  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  DetectorConfig config = Config();
  config.by = FindBy::kGray;
  VisionTask gray_task(config);
  ASSERT_TRUE(gray_task.Process(FrameOf(gray), m).ok());
  EXPECT_TRUE(m.found);
  EXPECT_NEAR(m.s[2], 10.0, 0.05);
}

TEST_F(VisionTaskTest, RefusesFramesThatDoNotFitTheCalibration) {
  hal::FeatureMeasurement m;
  m.sequence = 7;
  const cv::Mat small(240, 320, CV_8UC3);
  EXPECT_EQ(task_.Process(FrameOf(small), m).code(), hal::StatusCode::kInvalidArgument);
  EXPECT_EQ(m.sequence, 7U);
}

class ListSink final : public hal::FeatureSink {
 public:
  std::vector<hal::FeatureMeasurement> list;
  void Put(const hal::FeatureMeasurement& m) noexcept override { list.push_back(m); }
};

TEST_F(VisionTaskTest, RunsUntilTheCameraEnds) {
  const cv::Mat image = test::RayCast({});
  test::FakeCamera camera;
  for (std::uint64_t i = 0; i < 3; ++i) {
    camera.frames.push_back(FrameOf(image));
    camera.frames.back().sequence = i;
  }
  ListSink sink;
  int observed = 0;
  const std::atomic<bool> stop{false};
  EXPECT_EQ(RunVision(camera, task_, sink, stop,
                      [&](const hal::Frame&, const Detection& d) {
                        EXPECT_TRUE(d.found);
                        ++observed;
                      })
                .code(),
            hal::StatusCode::kClosed);
  EXPECT_EQ(sink.list.size(), 3U);
  EXPECT_EQ(observed, 3);
  camera.after = hal::Status(hal::StatusCode::kDisconnected);
  EXPECT_EQ(RunVision(camera, task_, sink, stop, {}).code(), hal::StatusCode::kDisconnected);
  const std::atomic<bool> stopped{true};
  EXPECT_EQ(RunVision(camera, task_, sink, stopped, {}).code(), hal::StatusCode::kClosed);
}

// A bad picture counts as one frame without the target. Vision goes on and
// reports the number of such frames and the first reason.
TEST_F(VisionTaskTest, GoesOnAfterABadPicture) {
  const cv::Mat image = test::RayCast({});
  const cv::Mat small(240, 320, CV_8UC3, cv::Scalar::all(0));
  test::FakeCamera camera;
  for (std::uint64_t i = 0; i < 6; ++i) {
    camera.frames.push_back(FrameOf(i == 3 ? small : image));
    camera.frames.back().sequence = i;
    camera.frames.back().stamp_ns = 1000 + static_cast<std::int64_t>(i);
  }
  // Invalid frames that no driver may return: the seam turns each into a fault.
  camera.frames[1].pixels = camera.frames[1].pixels.first(5000);
  camera.frames[2].stride_bytes = 7;
  camera.frames[4].height_px = -480;
  ListSink sink;
  std::vector<bool> found;
  const std::atomic<bool> stop{false};
  const hal::Status end =
      RunVision(camera, task_, sink, stop, [&](const hal::Frame& frame, const Detection& d) {
        found.push_back(d.found);
        EXPECT_EQ(frame.width_px, image.cols);
        EXPECT_EQ(frame.height_px, image.rows);
        EXPECT_GE(frame.pixels.size(), image.total() * image.elemSize());
      });
  EXPECT_EQ(end.code(), hal::StatusCode::kClosed);
  EXPECT_EQ(found, (std::vector<bool>{true, false, true}));
  const std::array<std::uint64_t, 3> sequences{0, 3, 5};
  ASSERT_EQ(sink.list.size(), sequences.size()) << "the servo gets a measurement for each valid frame";
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    EXPECT_EQ(sink.list[i].found, found[i]) << i;
    EXPECT_EQ(sink.list[i].sequence, sequences[i]);
    EXPECT_EQ(sink.list[i].stamp_ns, 1000 + static_cast<std::int64_t>(sequences[i]));
  }
  EXPECT_EQ(task_.failures().frames, 4U);
  EXPECT_NE(task_.failures().first.find("(Frame geometry)"), std::string::npos) << task_.failures().first;
}

// A hundred faults in a row, or a camera that stops by itself, end vision and are reported.
TEST_F(VisionTaskTest, CameraThatOnlyFailsIsReported) {
  test::FakeCamera camera;
  camera.after = hal::Status(hal::StatusCode::kDeviceFault, "camera picture");
  ListSink sink;
  const std::atomic<bool> stop{false};
  EXPECT_EQ(RunVision(camera, task_, sink, stop, {}).code(), hal::StatusCode::kDeviceFault);
  EXPECT_EQ(task_.failures().frames, 99U);
  EXPECT_EQ(sink.list.size(), 0U);
}

// OpenCV runs out of memory at the first picture; the second is processed.
class NoMemory final : public cv::MatAllocator {
 public:
  cv::UMatData* allocate(int, const int*, int, void*, std::size_t*, cv::AccessFlag,
                         cv::UMatUsageFlags) const override {
    CV_Error(cv::Error::StsNoMem, "no memory\nfor this picture");
  }
  bool allocate(cv::UMatData*, cv::AccessFlag, cv::UMatUsageFlags) const override { return false; }
  void deallocate(cv::UMatData*) const override {}
};

class CameraWithoutMemory final : public hal::Camera {
 public:
  explicit CameraWithoutMemory(hal::Frame frame) : frame_(frame) {}
  ~CameraWithoutMemory() { cv::Mat::setDefaultAllocator(cv::Mat::getStdAllocator()); }

 private:
  hal::Status DoAcquire(hal::Frame& frame, std::int64_t) noexcept override {
    cv::Mat::setDefaultAllocator(acquired_ == 0 ? &none_ : cv::Mat::getStdAllocator());
    frame = frame_;
    return ++acquired_ > 2 ? hal::Status(hal::StatusCode::kClosed) : hal::Status::Ok();
  }
  const hal::Frame frame_;
  NoMemory none_;
  int acquired_ = 0;
};

TEST_F(VisionTaskTest, GoesOnAfterAnOpenCvException) {
  const cv::Mat image = test::RayCast({});
  CameraWithoutMemory camera(FrameOf(image));
  DetectorConfig config = Config();
  config.by = FindBy::kHough;
  VisionTask task(config);
  ListSink sink;
  const std::atomic<bool> stop{false};
  EXPECT_EQ(RunVision(camera, task, sink, stop, {}).code(), hal::StatusCode::kClosed);
  ASSERT_EQ(sink.list.size(), 2U);
  EXPECT_FALSE(sink.list[0].found);
  EXPECT_EQ(sink.list[0].sequence, 45U);
  EXPECT_EQ(task.failures().frames, 1U) << "the second picture was processed";
  std::cout << "first failure: " << task.failures().first << '\n';
  EXPECT_NE(task.failures().first.find("no memory"), std::string::npos);
  EXPECT_EQ(task.failures().first.find('\n'), std::string::npos) << "one line";
}

}  // namespace
}  // namespace fovea::vision
