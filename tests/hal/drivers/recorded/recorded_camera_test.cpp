// SPDX-License-Identifier: Apache-2.0
#include "fovea/recorded/recorded_camera.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <ctime>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "fovea/camera/camera_error.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::recorded {
namespace {

namespace fs = std::filesystem;

class RecordedCameraTest : public testing::Test {
 protected:
  RecordedCameraTest()
      : folder_(fs::temp_directory_path() / ("recorded_camera." + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~RecordedCameraTest() override { fs::remove_all(folder_); }

  void Write(const std::string& name, int gray, cv::Size size = {32, 24}) const {
    cv::imwrite((folder_ / name).string(), cv::Mat(size, CV_8UC3, cv::Scalar::all(gray)));
  }
  [[nodiscard]] std::string ErrorOf(const fs::path& path) const {
    try {
      RecordedCamera camera({.path = path});
      return "";
    } catch (const camera::CameraError& error) {
      return error.what();
    }
  }
  const fs::path folder_;
};

TEST_F(RecordedCameraTest, PlaysAFolderInTheOrderOfItsNames) {
  Write("b.png", 20);
  Write("a.png", 10);
  Write("c.bmp", 30);
  std::ofstream(folder_ / "notes.txt") << "no picture";
  RecordedCamera camera({.path = folder_, .rate_hz = 50.0, .start_ns = 1000, .wait = false});
  EXPECT_EQ(camera.width_px(), 32);
  hal::Frame frame;
  for (int k = 0; k < 3; ++k) {
    ASSERT_TRUE(camera.Acquire(frame, 0).ok());
    EXPECT_EQ(frame.sequence, static_cast<std::uint64_t>(k));
    EXPECT_EQ(frame.stamp_ns, 1000 + k * 20 * hal::kNsPerMs);
    EXPECT_EQ(frame.pixels[0], 10 * (k + 1));
  }
  EXPECT_EQ(camera.Acquire(frame, 0).code(), hal::StatusCode::kClosed);
  EXPECT_EQ(camera.Acquire(frame, 0).code(), hal::StatusCode::kClosed);
}

TEST_F(RecordedCameraTest, PlaysAVideoAtItsOwnRate) {
  const fs::path path = folder_ / "film.avi";
  cv::VideoWriter writer(path.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25.0, {64, 48});
  ASSERT_TRUE(writer.isOpened());
  for (int k = 0; k < 5; ++k) {
    writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(40 * k)));
  }
  writer.release();
  RecordedCamera camera({.path = path, .wait = false});
  hal::Frame frame;
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(camera.Acquire(frame, 0).ok());
    EXPECT_NEAR(frame.pixels[0], 40 * k, 2);
    EXPECT_EQ(frame.stamp_ns, k * 40 * hal::kNsPerMs) << "stamps at the video's own rate";
  }
  EXPECT_EQ(camera.Acquire(frame, 0).code(), hal::StatusCode::kClosed);
}

TEST_F(RecordedCameraTest, FrameNotYetDueTimesOut) {
  Write("a.png", 10);
  Write("b.png", 20);
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const std::int64_t start_ns = now.tv_sec * hal::kNsPerSecond + now.tv_nsec + 3600 * hal::kNsPerSecond;
  RecordedCamera camera({.path = folder_, .start_ns = start_ns});
  hal::Frame frame;
  EXPECT_EQ(camera.Acquire(frame, hal::kNsPerMs).code(), hal::StatusCode::kTimeout)
      << "the frame is due in an hour";
}

TEST_F(RecordedCameraTest, BrokenOrDifferentlySizedPictureIsADeviceFault) {
  Write("a.png", 10);
  Write("b.png", 20, {16, 16});
  RecordedCamera other({.path = folder_, .wait = false});
  hal::Frame frame;
  ASSERT_TRUE(other.Acquire(frame, 0).ok());
  EXPECT_EQ(other.Acquire(frame, 0).code(), hal::StatusCode::kDeviceFault);
  std::ofstream(folder_ / "b.png") << "half a picture";
  RecordedCamera broken({.path = folder_, .wait = false});
  ASSERT_TRUE(broken.Acquire(frame, 0).ok());
  EXPECT_EQ(broken.Acquire(frame, 0).code(), hal::StatusCode::kDeviceFault);
}

TEST_F(RecordedCameraTest, UnplayableSourceIsRefusedWithAReason) {
  EXPECT_NE(ErrorOf(folder_).find("there is no .png"), std::string::npos);
  EXPECT_NE(ErrorOf(folder_ / "none").find("no such folder or file"), std::string::npos);
  std::ofstream(folder_ / "film.mp4") << "no video";
  EXPECT_NE(ErrorOf(folder_ / "film.mp4").find("not a video"), std::string::npos);
  std::ofstream(folder_ / "a.png") << "no picture";
  EXPECT_NE(ErrorOf(folder_).find("the first picture cannot be read"), std::string::npos);
}

}  // namespace
}  // namespace fovea::recorded
