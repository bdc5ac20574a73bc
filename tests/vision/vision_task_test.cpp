// What the detector must refuse, and how the vision task passes its verdicts on.
#include "fovea/vision/vision_task.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "support/fake_drivers.hpp"
#include "support/ray_cast_ball.hpp"

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

TEST(TargetDetectorTest, FindsNothingWhereNothingIs) {
  EXPECT_FALSE(Finds(Ground()));
  EXPECT_FALSE(Finds(cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(0)))) << "black";
  EXPECT_FALSE(Finds(cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(255)))) << "saturated";
  EXPECT_FALSE(Finds(cv::Mat(480, 640, CV_8UC3, kRed))) << "all red: larger than the picture";
  cv::Mat noise(480, 640, CV_8UC3);
  cv::RNG rng(3);
  rng.fill(noise, cv::RNG::NORMAL, 128, 60);
  EXPECT_FALSE(Finds(noise));
}

TEST(TargetDetectorTest, RefusesOtherShapesOtherColoursOtherSizes) {
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
  cv::Mat small = Ground();  // as an 80 mm ball it would be 2.2 m away
  cv::circle(small, {320, 240}, 10, kRed, cv::FILLED, cv::LINE_AA);
  EXPECT_FALSE(Finds(small));
  cv::Mat half = Ground();
  cv::ellipse(half, {320, 240}, {50, 50}, 0, 0, 180, kRed, cv::FILLED, cv::LINE_AA);
  EXPECT_FALSE(Finds(half));
}

TEST(TargetDetectorTest, FindsThePartlyHiddenAndThePartlyOutOfView) {
  test::BallPicture picture;
  picture.noise = 3.0;
  cv::Mat image = test::RayCast(picture);
  cv::rectangle(image, {330, 100}, {420, 230}, {90, 140, 150}, cv::FILLED);  // over the upper right quarter
  TargetDetector detector(Config());
  const Detection d = detector.Detect(image);
  ASSERT_TRUE(d.found);
  EXPECT_LT(d.confidence, 0.9) << "and says that it saw less";
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

TEST_F(VisionTaskTest, PassesOnWhatWasSeenWithItsStamp) {
  const cv::Mat image = test::RayCast({});
  hal::FeatureMeasurement m;
  ASSERT_TRUE(task_.Process(FrameOf(image), m).ok());
  EXPECT_TRUE(m.found);
  EXPECT_EQ(m.stamp_ns, 123);
  EXPECT_EQ(m.sequence, 45U);
  EXPECT_EQ(m.dim, 3);
  EXPECT_NEAR(m.s[2], 10.0, 0.02);
  EXPECT_GT(m.cov_s[0], 0.0);
  EXPECT_GT(m.cov_s[2 * hal::kMaxFeatureDim + 2], m.cov_s[0]) << "depth is known worst";

  const cv::Mat empty = Ground();
  ASSERT_TRUE(task_.Process(FrameOf(empty), m).ok());
  EXPECT_FALSE(m.found);
  EXPECT_EQ(m.dim, 0);
  EXPECT_EQ(m.stamp_ns, 123) << "the frame was looked at";
}

TEST_F(VisionTaskTest, TakesRowsWithGapsAndGrayFrames) {
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

}  // namespace
}  // namespace fovea::vision
