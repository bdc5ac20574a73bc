// SPDX-License-Identifier: Apache-2.0
// The film, read back frame by frame with OpenCV.
#include "firmware/host/film/eye_film.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <sstream>

#include "firmware/core/features/sphere.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::film {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr int kFrames = 45;

class EyeFilmTest : public testing::Test {
 protected:
  // A film of plain frames of increasing brightness, 30 per second, with a gap after the 20th.
  void Film(const std::string& name) {
    EyeFilmConfig config;
    config.path = Path(name);
    config.intrinsics = {kWidth, kHeight, 60.0, 60.0, 31.5, 23.5};
    config.p_CO_C_star = {0.0, 0.0, 0.4};
    config.goal = Overlay::CurveOf(config.intrinsics, features::ConeFromSphere({0.0, 0.0, 10.0}));
    EyeFilm film(config);
    for (int i = 0; i < kFrames; ++i) {
      const std::vector<std::uint8_t> pixels(std::size_t{3} * kWidth * kHeight, Level(i));
      hal::Frame frame;
      frame.stamp_ns = StampNs(i);
      frame.width_px = kWidth;
      frame.height_px = kHeight;
      frame.stride_bytes = 3 * kWidth;
      frame.pixels = pixels;
      film.Add(frame, {});
    }
    film.Finish();
    EXPECT_EQ(film.dropped(), 0U);
  }
  static std::uint8_t Level(int i) { return static_cast<std::uint8_t>(20 + 4 * i); }
  static std::int64_t StampNs(int i) {
    const std::int64_t step_ms =
        (std::int64_t{i} * 100 + 1) / 3;  // the simulated world exposes on whole milliseconds
    return 1'000'000 * (20 + step_ms + (i >= 20 ? 500 : 0));
  }
  std::string Path(const std::string& name) { return folder_.path() / name; }
  std::string Bytes(const std::string& name) {
    std::ostringstream bytes;
    bytes << std::ifstream(Path(name), std::ios::binary).rdbuf();
    return bytes.str();
  }
  test::TempFolder folder_;
};

TEST_F(EyeFilmTest, GrayFramesAreShownAndFramesOfAnotherSizeLeftOut) {
  EyeFilmConfig config;
  config.path = Path("gray.mp4");
  config.intrinsics = {kWidth, kHeight, 60.0, 60.0, 31.5, 23.5};
  config.p_CO_C_star = {0.0, 0.0, 0.4};
  EyeFilm film(config);
  const std::int64_t begin_ns = 123'000'000'000;
  for (int i = 0; i < 10; ++i) {
    hal::Frame frame;
    frame.stamp_ns = begin_ns + StampNs(i);
    frame.width_px = i == 5 ? kWidth / 2 : kWidth;
    frame.height_px = kHeight;
    frame.stride_bytes = frame.width_px;
    frame.format = hal::PixelFormat::kMono8;
    const std::vector<std::uint8_t> pixels(std::size_t{1} * kWidth * kHeight, Level(i));
    frame.pixels = pixels;
    film.Add(frame, {}, begin_ns);
  }
  EXPECT_EQ(film.frames(), 9U);
  film.Finish();
  cv::VideoCapture shown(Path("gray.mp4"));
  cv::Mat picture;
  int count = 0;
  for (; shown.read(picture); ++count) {
    const int i = count < 5 ? count : count + 1;
    EXPECT_NEAR(cv::mean(picture(cv::Rect(2, 2, 8, 8)))[1], Level(i), 6.0) << "frame " << i;
  }
  EXPECT_EQ(count, 9);
}

TEST_F(EyeFilmTest, EveryFrameAppearsAtItsTimeWithALegend) {
  Film("film.mp4");
  cv::VideoCapture film(Path("film.mp4"));
  ASSERT_TRUE(film.isOpened());
  EXPECT_EQ(film.get(cv::CAP_PROP_FRAME_WIDTH), kWidth);
  EXPECT_EQ(film.get(cv::CAP_PROP_FRAME_HEIGHT), kHeight + 28);
  const int fourcc = static_cast<int>(film.get(cv::CAP_PROP_FOURCC));
  EXPECT_EQ(fourcc, cv::VideoWriter::fourcc('a', 'v', 'c', '1')) << "not H.264, which browsers play";
  EXPECT_EQ(static_cast<int>(film.get(cv::CAP_PROP_CODEC_PIXEL_FORMAT)),
            cv::VideoWriter::fourcc('I', '4', '2', '0'));
  cv::Mat frame;
  int count = 0;
  double brightest = 0.0;
  while (film.read(frame)) {
    ASSERT_LT(count, kFrames);
    const double shown_ms = film.get(cv::CAP_PROP_POS_MSEC);
    EXPECT_NEAR(shown_ms, 1e-6 * static_cast<double>(StampNs(count) - StampNs(0)), 0.02) << "frame " << count;
    // A corner without drawings.
    EXPECT_NEAR(cv::mean(frame(cv::Rect(2, 2, 8, 8)))[1], Level(count), 6.0) << "frame " << count;
    double bright = 0.0;
    cv::Mat gray;
    cv::cvtColor(frame.rowRange(kHeight, kHeight + 28), gray, cv::COLOR_BGR2GRAY);
    cv::minMaxLoc(gray, nullptr, &bright);
    brightest = std::max(brightest, bright);
    ++count;
  }
  EXPECT_EQ(count, kFrames);
  EXPECT_GT(brightest, 150.0) << "the legend is missing";
}

TEST_F(EyeFilmTest, SameFramesGiveTheSameBytes) {
  Film("a.mp4");
  Film("b.mp4");
  EXPECT_GT(Bytes("a.mp4").size(), 1000U);
  EXPECT_EQ(Bytes("a.mp4"), Bytes("b.mp4"));
}

// The stamps of a jumping camera clock do not change the order of the frames.
TEST_F(EyeFilmTest, EqualOrBackwardStampsKeepTheFrameOrder) {
  constexpr std::int64_t kMs = 1'000'000;
  const std::vector<std::int64_t> stamps_ns{-5 * kMs, 0, 1, 2, 40 * kMs, 30 * kMs, 30 * kMs, 80 * kMs};
  VideoFile film(Path("film.mp4"), kWidth, kHeight);
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    film.Add(cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar::all(Level(static_cast<int>(i)))), stamps_ns[i]);
  }
  film.Finish();
  const std::vector<double> shown_ms{0.0, 5.0, 5.0111, 5.0222, 45.0, 45.0111, 45.0222, 85.0};
  cv::VideoCapture reader(Path("film.mp4"));
  cv::Mat frame;
  std::size_t count = 0;
  for (; reader.read(frame); ++count) {
    ASSERT_LT(count, shown_ms.size());
    EXPECT_NEAR(reader.get(cv::CAP_PROP_POS_MSEC), shown_ms[count], 0.006) << "frame " << count;
    EXPECT_NEAR(cv::mean(frame)[1], Level(static_cast<int>(count)), 6.0) << "frame " << count;
  }
  EXPECT_EQ(count, shown_ms.size());
}

// At real pace the producer does not wait: frames without room are counted, and the film holds the rest.
TEST_F(EyeFilmTest, FramesWithoutRoomAreCounted) {
  constexpr std::uint64_t kMany = 300;
  EyeFilmConfig config;
  config.path = Path("film.mp4");
  config.intrinsics = {kWidth, kHeight, 60.0, 60.0, 31.5, 23.5};
  config.p_CO_C_star = {0.0, 0.0, 0.4};
  config.goal = Overlay::CurveOf(config.intrinsics, features::ConeFromSphere({0.0, 0.0, 10.0}));
  config.may_drop = true;
  EyeFilm film(config);
  const std::vector<std::uint8_t> pixels(std::size_t{3} * kWidth * kHeight, 90);
  for (std::uint64_t i = 0; i < kMany; ++i) {
    hal::Frame frame;
    frame.stamp_ns = StampNs(static_cast<int>(i));
    frame.width_px = kWidth;
    frame.height_px = kHeight;
    frame.stride_bytes = 3 * kWidth;
    frame.pixels = pixels;
    film.Add(frame, {});
  }
  film.Finish();
  cv::VideoCapture reader(Path("film.mp4"));
  cv::Mat frame;
  std::uint64_t count = 0;
  while (reader.read(frame)) {
    ++count;
  }
  std::cout << film.dropped() << " of " << kMany << " dropped\n";
  EXPECT_EQ(count + film.dropped(), kMany);
  EXPECT_EQ(film.frames(), count);
}

TEST_F(EyeFilmTest, UncreatableFileIsReportedAtOnce) {
  try {
    VideoFile film(Path("nowhere/film.mp4"), kWidth, kHeight);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("No such file or directory"));
  }
}

}  // namespace
}  // namespace fovea::film
