// SPDX-License-Identifier: Apache-2.0
// The film of the bench of a short run, read back with OpenCV.
#include "sim/run/scene_film.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <iostream>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <set>

#include "firmware/host/film/overlay.hpp"
#include "sim/app/run.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::sim {
namespace {

class SceneFilmTest : public testing::Test {
 protected:
  // A run of 0.9 s with a target on a circle that the arm follows.
  Summary Run(bool scene_video) {
    RunOptions options;
    options.out = folder_.path();
    options.show_progress = false;
    return RunScenario(
        LoadScenario("ball-moving",
                     {"run.duration_s=0.9", scene_video ? "run.scene_video=true" : "run.scene_video=false"}),
        options);
  }
  std::filesystem::path Film() const { return folder_.path() / "scene.mp4"; }

  const test::TempFolder folder_;
};

// The number of pixels with a path's colour, within the tolerance of encoding.
int Count(const cv::Mat& bgr, const cv::Scalar& colour) {
  cv::Mat mask;
  const cv::Scalar around(50, 50, 50);
  cv::inRange(bgr, colour - around, colour + around, mask);
  return cv::countNonZero(mask);
}

TEST_F(SceneFilmTest, EveryExposureAppearsWithThePathsSoFar) {
  const Summary with = Run(true);
  cv::VideoCapture film(Film());
  ASSERT_TRUE(film.isOpened());
  EXPECT_EQ(film.get(cv::CAP_PROP_FRAME_WIDTH), 960);
  EXPECT_EQ(film.get(cv::CAP_PROP_FRAME_HEIGHT), 600);
  EXPECT_EQ(static_cast<int>(film.get(cv::CAP_PROP_CODEC_PIXEL_FORMAT)),
            cv::VideoWriter::fourcc('I', '4', '2', '0'));
  std::vector<cv::Mat> frames;
  for (cv::Mat frame; film.read(frame);) {
    frames.push_back(frame.clone());
    EXPECT_NEAR(film.get(cv::CAP_PROP_POS_MSEC), 1e3 / 30.0 * static_cast<double>(frames.size() - 1), 1.1);
  }
  ASSERT_EQ(frames.size(), with.frames);
  EXPECT_EQ(with.film_frames_dropped, 0U);

  const cv::Rect picture(0, 0, 960, 572);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(frames.back()(picture), mean, deviation);
  EXPECT_GT(deviation[1], 20.0) << "the film is blank";
  for (const auto& [name, colour] :
       {std::pair{"camera", film::kDetectionColour}, {"target", film::kGoalColour}}) {
    const int first = Count(frames.front()(picture), colour);
    const int middle = Count(frames[frames.size() / 2](picture), colour);
    const int last = Count(frames.back()(picture), colour);
    std::cout << name << "'s path: " << first << ", " << middle << ", " << last << " pixels\n";
    EXPECT_GT(middle, first + 20) << name;
    EXPECT_GT(last, middle + 20) << name;
  }
  // The legend shows the running time.
  const cv::Rect time(0, 572, 200, 28);
  EXPECT_GT(cv::norm(frames.front()(time), frames.back()(time), cv::NORM_INF), 50.0);

  // Filming does not change the run, and a later run without a film removes the old one.
  const Summary without = Run(false);
  EXPECT_EQ(with.log_hash, without.log_hash);
  EXPECT_FALSE(std::filesystem::exists(Film()));
}

// The bench is visible even if the camera's picture is dark.
TEST_F(SceneFilmTest, FilmIsBrightWhenTheSceneIsDark) {
  RunOptions options;
  options.out = folder_.path();
  options.show_progress = false;
  RunScenario(LoadScenario("ball-dark", {"run.duration_s=0.1", "run.scene_video=true"}), options);
  cv::VideoCapture film(Film());
  cv::Mat frame;
  ASSERT_TRUE(film.read(frame));
  EXPECT_GT(cv::mean(frame)[1], 60.0);
}

// All other files are kept, and the summary gives the reason for the missing films.
TEST_F(SceneFilmTest, FailedFilmsKeepTheOtherFiles) {
  RunOptions options;
  options.out = folder_.path();
  options.show_progress = false;
  options.observer.on_truth = [this](const Truth&) {  // their files vanish during the run
    std::filesystem::remove(folder_.path() / ".camera.mp4.partial");
    std::filesystem::remove(folder_.path() / ".scene.mp4.partial");
  };
  const Summary summary =
      RunScenario(LoadScenario("ball", {"run.duration_s=0.1", "run.scene_video=true"}), options);
  EXPECT_THAT(
      summary.film_errors,
      testing::ElementsAre("camera.mp4: the film cannot be written: the index: No such file or directory",
                           "scene.mp4: the film cannot be written: the index: No such file or directory"));
  std::set<std::string> files;
  for (const std::filesystem::directory_entry& file : std::filesystem::directory_iterator(folder_.path())) {
    files.insert(file.path().filename());
  }
  EXPECT_THAT(files, testing::ElementsAre("bench.png", "eye-first.png", "eye-last.png", "frame-last.png",
                                          "log.mcap", "report.html", "summary.json"));
}

}  // namespace
}  // namespace fovea::sim
