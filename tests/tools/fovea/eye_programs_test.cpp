// SPDX-License-Identifier: Apache-2.0
// fovea detect and fovea calibrate on the command line, with ray-cast pictures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "tests/support/program.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/bench/vision/picture.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;

class EyeProgramsTest : public testing::Test {
 protected:
  static test::ProgramResult Fovea(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), FOVEA_PROGRAM);
    return test::RunProgram(arguments);
  }
  static void ExpectRefused(const test::ProgramResult& result, const std::string& says) {
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << "one line: " << result.err;
  }
  // A picture of an 80 mm disc at distance `Z` [m].
  std::string Disc(const std::string& name, double Z) const {
    bench::PictureScene scene;
    scene.noise = 3.0;
    bench::Body disc;
    disc.shape = bench::Shape::kDisc;
    disc.p.z() = Z;
    disc.p.x() = 0.1 * Z;
    scene.bodies.push_back(disc);
    return Write(name, bench::Draw(scene));
  }
  std::string Write(const std::string& name, const cv::Mat& image) const {
    const std::string path = folder_.path() / name;
    cv::imwrite(path, image);
    return path;
  }
  test::TempFolder folder_;
};

TEST_F(EyeProgramsTest, DetectReportsEachImage) {
  const std::string disc = Disc("a.png", 0.4);
  Write("b.png", cv::Mat(480, 640, CV_8UC1, cv::Scalar(0)));
  Write("c.png", cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(255)));
  const test::ProgramResult result =
      Fovea({"detect", "--target", "circle", folder_.path().string(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json list = nlohmann::json::parse(result.out);
  ASSERT_EQ(list.size(), 3U);
  EXPECT_EQ(list[0]["file"], disc);
  ASSERT_TRUE(list[0]["found"]);
  const double u = list[0]["u_px"];
  const double radius = list[0]["radius_px"];
  const double sigma = std::sqrt(list[0]["cov"][0][0].get<double>());
  std::cout << "u off " << u - (319.5 + 55.4256) << " px, sigma " << sigma << ", radius " << radius << "\n";
  EXPECT_NEAR(u, 319.5 + 55.4256, 4.0 * sigma);
  EXPECT_LT(sigma, 0.05);
  EXPECT_NEAR(radius, 554.256 * 0.04 / 0.4, 0.05);
  EXPECT_FALSE(list[1]["found"]);
  EXPECT_EQ(list[1]["why"], "the image is black");
  EXPECT_EQ(list[2]["why"], "the image is saturated");
  for (const char* method : {"gray", "hough"}) {
    const auto same = Fovea({"detect", "--target", "circle", "--method", method, disc, "--json"});
    EXPECT_TRUE(nlohmann::json::parse(same.out)[0]["found"]) << method;
  }
}

TEST_F(EyeProgramsTest, DetectReportsWhyNoTargetIsFound) {
  const std::string disc = Disc("a.png", 0.4);
  const std::string empty = Write("empty.png", cv::Mat(480, 640, CV_8UC1, cv::Scalar(128)));
  const auto why = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"detect", "--json", "--target", "circle"});
    return nlohmann::json::parse(Fovea(arguments).out)[0]["why"].get<std::string>();
  };
  cv::Mat part = cv::imread(disc, cv::IMREAD_GRAYSCALE);
  part.colRange(385, 640) = part.at<std::uint8_t>(10, 10);  // the disc covers columns 320 to 430
  EXPECT_THAT(why({Write("part.png", part), "--confidence-min", "1"}),
              testing::AllOf(testing::HasSubstr("the best outline, at ("),
                             testing::HasSubstr("below --confidence-min 1.00")));
  EXPECT_EQ(why({disc, "--radius-max", "20"}), "no outline of a circle with a radius of 8 to 20 px");
  EXPECT_EQ(why({empty}), "the image has no contrast");
  cv::Mat red(480, 640, CV_8UC3, cv::Scalar(120, 120, 120));
  cv::circle(red, {320, 240}, 60, cv::Scalar(20, 20, 200), cv::FILLED, cv::LINE_AA);
  const std::string red_disc = Write("red.png", red);
  EXPECT_THAT(
      why({red_disc, "--hue", "120"}),
      testing::AllOf(testing::HasSubstr("the best outline of a circle, at (320"),
                     testing::HasSubstr("is not found by its colour (--hue 120, or too little saturation)")));
  EXPECT_THAT(why({red_disc, "--method", "hough", "--hough-votes", "1000"}),
              testing::HasSubstr("is not found by the Hough transform (--hough-votes 1000"));
}

TEST_F(EyeProgramsTest, DetectDrawsTheFoundOutline) {
  const std::string disc = Disc("a.png", 0.4);
  const std::string marked = folder_.path() / "new" / "marked";
  ASSERT_EQ(Fovea({"detect", "--target", "circle", "--marked", marked, disc}).exit_code, 0);
  const cv::Mat picture = cv::imread(marked + "/a-marked.png");
  ASSERT_EQ(picture.size(), cv::Size(640, 480));
  // The outline, 55 px right of the centre, is drawn in blue; beside it nothing is drawn.
  const cv::Vec3b on = picture.at<cv::Vec3b>(240, 375 + 55);
  EXPECT_GT(on[0], on[2] + 60) << on;
  const cv::Vec3b beside = picture.at<cv::Vec3b>(240, 375 + 70);
  EXPECT_EQ(beside[0], beside[2]) << beside;
}

TEST_F(EyeProgramsTest, HelpIsTextThatFitsIntoATerminal) {
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{}, {"atlas"}, {"detect"}, {"calibrate", "board"}}) {
    std::vector<std::string> arguments = command;
    arguments.emplace_back("--help");
    std::istringstream help(Fovea(arguments).out);
    for (std::string line; std::getline(help, line);) {
      EXPECT_LE(line.size(), 100U) << line;
      EXPECT_TRUE(std::all_of(line.begin(), line.end(), [](unsigned char c) { return c >= 0x20; })) << line;
    }
  }
}

TEST_F(EyeProgramsTest, DetectShowsAnyNameOfAFile) {
  const std::string disc = Disc("a.png", 0.4);
  const std::string odd = folder_.path() / "b\x1b[31m\xff.png";
  std::filesystem::copy_file(disc, odd);
  const test::ProgramResult text = Fovea({"detect", "--target", "circle", odd});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, testing::HasSubstr("b\\x1b[31m\\xff.png: at ("));
  const test::ProgramResult json = Fovea({"detect", "--target", "circle", "--json", odd});
  EXPECT_EQ(json.exit_code, 0) << json.err;
  EXPECT_THAT(nlohmann::json::parse(json.out)[0]["file"].get<std::string>(),
              testing::EndsWith("b\x1b[31m\ufffd.png"));
}

TEST_F(EyeProgramsTest, DetectRefusesWhatTheKeysRefuse) {
  const std::string disc = Disc("a.png", 0.4);
  for (const char* option : {"--hough-canny", "--hough-votes"}) {
    for (const char* value : {"0.5", "1001"}) {
      ExpectRefused(Fovea({"detect", "--target", "circle", "--method", "hough", option, value, disc}),
                    option);
    }
  }
}

TEST_F(EyeProgramsTest, MistypedCommandGetsTheNearestOne) {
  const test::ProgramResult result = Fovea({"atlus"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, testing::HasSubstr("did you mean atlas?; allowed: report, replay"));
}

TEST_F(EyeProgramsTest, DetectRefusesTwoImagesOfOneMarkedName) {
  const std::string disc = Disc("a.png", 0.4);
  std::filesystem::copy_file(disc, folder_.path() / "a.jpg");
  const std::filesystem::path marked = folder_.path() / "marked";
  ExpectRefused(Fovea({"detect", "--target", "circle", "--marked", marked, disc, folder_.path() / "a.jpg"}),
                "a-marked.png; images need different names");
  EXPECT_FALSE(std::filesystem::exists(marked)) << "no files are written";
}

TEST_F(EyeProgramsTest, DetectRefusesAnUnreadableImage) {
  ExpectRefused(Fovea({"detect", "--target", "circle", "nowhere.png"}), "nowhere.png: no such file");
  ExpectRefused(Fovea({"detect", "--target", "circle", folder_.path().string()}), "no images");
  const std::string text = folder_.path() / "text.png";
  std::ofstream(text) << "no image";
  ExpectRefused(Fovea({"detect", "--target", "circle", text}), "not an image");
  ExpectRefused(Fovea({"detect", "--target", "circle", Write("small.png", cv::Mat(16, 16, CV_8UC1))}),
                "16 x 16 px");
  ExpectRefused(Fovea({"detect", "--target", "square", "--method", "hough", Disc("a.png", 0.4)}), "hough");
  const std::string camera = folder_.path() / "camera.toml";
  std::ofstream(camera) << "[camera]\nwidth_px = 320\nheight_px = 240\nf_u_px = 300.0\nf_v_px = 300.0\n"
                           "c_u_px = 159.5\nc_v_px = 119.5\n";
  ExpectRefused(Fovea({"detect", "--target", "circle", "--camera", camera, Disc("a.png", 0.4)}),
                "320 x 240 px");
}

TEST_F(EyeProgramsTest, CalibrateFindsTheFocalLength) {
  const test::ProgramResult result = Fovea({"calibrate", "focal", "--diameter", "0.08", "--delta-z", "0.15",
                                            Disc("a.png", 0.3), Disc("b.png", 0.45), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json found = nlohmann::json::parse(result.out);
  std::cout << "f " << found["f_px"] << " +- " << found["sigma_px"] << " px\n";
  EXPECT_NEAR(found["f_px"].get<double>(), 554.256, 4.0 * found["sigma_px"].get<double>());
  EXPECT_LT(found["sigma_px"].get<double>(), 1.0);
  const std::string cell = folder_.path() / "cell.toml";
  std::ofstream(cell) << "[camera]\nrate_hz = 30\nlens = [-0.2, 0, 0, 0, 0]\n";
  const test::ProgramResult written = Fovea({"calibrate", "focal", "--diameter", "0.08", "--delta-z", "0.15",
                                             "--write", cell, Disc("a.png", 0.3), Disc("b.png", 0.45)});
  EXPECT_THAT(written.out, testing::HasSubstr("[camera]\nwidth_px = 640\nheight_px = 480\nf_u_px = 55"));
  std::stringstream lines;
  lines << std::ifstream(cell).rdbuf();
  EXPECT_THAT(lines.str(),
              testing::AllOf(testing::HasSubstr("rate_hz = 30"), testing::HasSubstr("lens = [0, 0, 0, 0, 0]"),
                             testing::HasSubstr("c_u_px = 319.5\nc_v_px = 239.5")));
  ExpectRefused(Fovea({"calibrate", "focal", "--diameter", "0.08", "--delta-z", "0.15", Disc("b.png", 0.45),
                       Disc("a.png", 0.3)}),
                "smaller in the farthest view");
  ExpectRefused(Fovea({"calibrate", "intrinsics", folder_.path().string()}), "at least 4");
  ExpectRefused(Fovea({"calibrate", "intrinsics", folder_.path().string(), "--board", "9by6"}), "9by6");
}

}  // namespace
}  // namespace fovea
