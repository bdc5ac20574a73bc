// SPDX-License-Identifier: Apache-2.0
// Calibrates the simulator's camera from its pictures with the
// shipped programs and compares the result with the scenario.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "firmware/host/config/camera_keys.hpp"
#include "firmware/host/config/settings.hpp"
#include "firmware/vision/intrinsics.hpp"
#include "tests/support/places.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

struct BoardCase {
  const char* name;
  std::vector<std::string> flags;
  std::vector<std::string> lens;  // --set options of the lens and the camera's other parameters
  // Bounds on the errors of the result.
  double f_px, c_px, picture_px, rms_px, X_mm, X_deg;
};

void PrintTo(const BoardCase& board, std::ostream* out) { *out << board.name; }

class CalibrationLoopTest : public testing::TestWithParam<BoardCase> {
 protected:
  static constexpr std::chrono::seconds kLimit{240};  // with sanitizers each takes two minutes

  static ProgramResult Fovea(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), FOVEA_PROGRAM);
    return RunProgram(arguments, {}, kLimit);
  }
  static ProgramResult Pictures(const fs::path& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{FOVEA_SIM_PROGRAM, "pictures", "--out", out.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(arguments, {}, kLimit);
  }
  static std::vector<std::string> Joined(std::vector<std::string> a, const std::vector<std::string>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }
  static json Read(const fs::path& path) { return json::parse(std::ifstream(path)); }
  static vision::Intrinsics ToIntrinsics(const json& from) {
    vision::Intrinsics in;
    in.f_u_px = from["f_u_px"];
    in.f_v_px = from["f_v_px"];
    in.c_u_px = from["c_u_px"];
    in.c_v_px = from["c_v_px"];
    const json& lens = from["lens"];
    in.lens = {lens[0], lens[1], lens[2], lens[3], lens[4]};
    return in;
  }
  static Eigen::Isometry3d ToPose(const json& from) {
    return Eigen::Translation3d(from[0], from[1], from[2]) *
           Eigen::Quaterniond(from[3], from[4], from[5], from[6]);
  }
  static void ExpectRefused(const ProgramResult& result, const std::string& says) {
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr(says));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << "one line: " << result.err;
  }
  fs::path Out() const { return folder_.path() / "boards"; }

  TempFolder folder_;
};

TEST_P(CalibrationLoopTest, RecoversTheScenariosCalibration) {
  const BoardCase& board = GetParam();
  const ProgramResult taken = Pictures(Out(), Joined(board.flags, board.lens));
  ASSERT_EQ(taken.exit_code, 0) << taken.err;
  const json truth = Read(Out() / "truth.json");

  const std::string camera = Out() / "camera.toml";
  const ProgramResult intrinsics =
      Fovea(Joined({"calibrate", "intrinsics", Out().string(), "--out", camera, "--json"}, board.flags));
  ASSERT_EQ(intrinsics.exit_code, 0) << intrinsics.err;
  const json found = json::parse(intrinsics.out);
  const vision::Intrinsics in = ToIntrinsics(found);
  const vision::Intrinsics in_truth = ToIntrinsics(truth);
  // The image error of a ray: lens, focal length and principal point together, within the boards' reach.
  double picture_px = 0.0;
  for (int column = -5; column <= 5; ++column) {
    for (int row = -3; row <= 3; ++row) {
      const model::Vec3 p(0.1 * column, 0.125 * row, 1.0);
      double u = in.U(p), v = in.V(p), u_true = in_truth.U(p), v_true = in_truth.V(p);
      in.Distort(u, v);
      in_truth.Distort(u_true, v_true);
      picture_px = std::max(picture_px, std::hypot(u - u_true, v - v_true));
    }
  }
  const double f_px =
      std::max(std::fabs(in.f_u_px - in_truth.f_u_px), std::fabs(in.f_v_px - in_truth.f_v_px));
  const double c_px = std::hypot(in.c_u_px - in_truth.c_u_px, in.c_v_px - in_truth.c_v_px);

  const ProgramResult hand_eye =
      Fovea(Joined({"calibrate", "hand-eye", Out().string(), "--camera", camera, "--json"}, board.flags));
  ASSERT_EQ(hand_eye.exit_code, 0) << hand_eye.err;
  const json hand = json::parse(hand_eye.out);
  const Eigen::Isometry3d off = ToPose(truth["X_EC"]).inverse() * ToPose(hand["X_EC"]);
  const double off_mm = 1e3 * off.translation().norm();
  const double off_deg = 57.29578 * Eigen::AngleAxisd(off.linear()).angle();
  std::cout << board.name << ", " << found["views"] << " views: f off " << f_px << " px (sigma "
            << found["sigma_f_px"] << "), c " << c_px << " px, image points at most " << picture_px
            << " px, rms " << found["rms_px"] << " px; X_EC off " << off_mm << " mm, " << off_deg
            << " deg, the views agree to " << hand["rms_mm"] << " mm, " << hand["rms_deg"] << " deg\n";
  // Written into a scenario: the run simulates that camera, and the servo uses it.
  const std::string scenario = folder_.path() / "mine.toml";
  fs::copy_file(SourceRoot() / "sim/scenarios/ball.toml", scenario);
  for (const std::vector<std::string>& what :
       {std::vector<std::string>{"intrinsics", Out().string()},
        std::vector<std::string>{"hand-eye", Out().string(), "--camera", camera}}) {
    const ProgramResult put =
        Fovea(Joined(Joined({"calibrate"}, what), Joined({"--write", scenario}, board.flags)));
    ASSERT_EQ(put.exit_code, 0) << put.err;
  }
  const ProgramResult run = RunProgram(
      {FOVEA_SIM_PROGRAM, "run", scenario, "--no-report", "--out", (folder_.path() / "run").string()}, {},
      kLimit);
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  const json summary = Read(folder_.path() / "run" / "summary.json");
  std::cout << "a run with that camera ends " << summary["final_error_px_rms"] << " px off\n";
  EXPECT_LT(summary["final_error_px_rms"].get<double>(), 0.1);
  // Written into a hardware configuration and read back.
  const std::string cell = folder_.path() / "cell.toml";
  std::ofstream(cell)
      << "[robot]\nhost = \"192.168.1.2\"\n\n[camera]  # on the flange\nmount_xyz = [0, 0, 0]\n";
  ASSERT_EQ(
      Fovea(Joined({"calibrate", "intrinsics", Out().string(), "--write", cell}, board.flags)).exit_code, 0);
  const ProgramResult written = Fovea(
      Joined({"calibrate", "hand-eye", Out().string(), "--camera", camera, "--write", cell}, board.flags));
  ASSERT_EQ(written.exit_code, 0) << written.err;
  EXPECT_THAT(written.out, HasSubstr("[camera]\nmount_xyz = ["));
  config::CalibrationSettings settings;
  config::KeyTable keys;
  config::AddCalibrationKeys(settings, keys);
  for (const config::Setting& setting : config::ReadTomlFile(cell)) {
    if (setting.key.starts_with("camera.")) {
      keys.Apply(setting);
    }
  }
  const model::Pose mount = config::MakeMount(settings);
  const Eigen::Isometry3d found_mount = ToPose(hand["X_EC"]);
  EXPECT_LT((mount.p - found_mount.translation()).norm(), 2e-6);
  EXPECT_LT((mount.R - found_mount.linear()).norm(), 1e-6);
  EXPECT_NEAR(settings.intrinsics.f_u_px, in.f_u_px, 1e-6);
  EXPECT_NEAR(settings.lens[1], in.lens.k2, 1e-6);

  EXPECT_LT(f_px, board.f_px);
  EXPECT_LT(c_px, board.c_px);
  EXPECT_LT(picture_px, board.picture_px);
  EXPECT_LT(found["rms_px"].get<double>(), board.rms_px);
  EXPECT_LT(off_mm, board.X_mm);
  EXPECT_LT(off_deg, board.X_deg);
}

const std::vector<std::string> kLens{"--set", "camera.lens=[-0.18, 0.06, 0.001, -0.0015, 0]"};
INSTANTIATE_TEST_SUITE_P(
    Boards, CalibrationLoopTest,
    testing::Values(
        BoardCase{
            "chessboard", {"--board", "9x6", "--square", "0.025"}, kLens, 0.5, 0.6, 0.9, 0.085, 0.5, 0.04},
        BoardCase{"charuco",
                  {"--board", "8x5", "--square", "0.03", "--marker", "0.022"},
                  kLens,
                  0.3,
                  0.4,
                  0.5,
                  0.075,
                  0.3,
                  0.035},
        // Like a real sensor: pixels that are not quite square, a principal point off the centre.
        BoardCase{
            "own_sensor",
            {"--board", "8x5", "--square", "0.03", "--marker", "0.022"},
            {"--set", "camera.f_u_px=571.3", "--set", "camera.f_v_px=566.9", "--set", "camera.c_u_px=301.7",
             "--set", "camera.c_v_px=252.2", "--set", "camera.lens=[-0.1, 0.03, 0.0005, 0.001, 0]"},
            0.1,
            0.35,
            1.2,  // the corner furthest from the axis is out of the boards' reach
            0.075,
            0.4,
            0.025}),
    [](const auto& board) { return std::string(board.param.name); });

// Without lens distortion; and refused inputs.
TEST_F(CalibrationLoopTest, FindsTheFocalLengthAndRefusesBadInput) {
  const std::vector<std::string> board{"--board", "9x6", "--square", "0.025"};
  const ProgramResult taken = Pictures(Out(), Joined(board, {"--views", "5"}));
  ASSERT_EQ(taken.exit_code, 0) << taken.err;
  EXPECT_THAT(taken.out, HasSubstr("fovea calibrate focal --diameter 0.08 --delta-z 0.15"));
  const fs::path near = Out() / "focal" / "near.png";
  const fs::path far = Out() / "focal" / "far.png";
  const ProgramResult focal = Fovea({"calibrate", "focal", "--diameter", "0.08", "--delta-z", "0.15",
                                     near.string(), far.string(), "--json"});
  ASSERT_EQ(focal.exit_code, 0) << focal.err;
  const json found = json::parse(focal.out);
  const double f_px = Read(Out() / "truth.json")["f_u_px"];
  const double off_px = found["f_px"].get<double>() - f_px;
  std::cout << "f off " << off_px << " px (sigma " << found["sigma_px"] << ") of " << f_px << "\n";
  EXPECT_LT(std::fabs(off_px), 3.0 * found["sigma_px"].get<double>());
  EXPECT_LT(found["sigma_px"].get<double>(), 0.5);

  // Two of five views are spoilt: three are too few, and the error names the two.
  cv::imwrite((Out() / "view-02.png").string(), cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(0)));
  cv::imwrite((Out() / "view-04.png").string(), cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(255)));
  const auto intrinsics = [&](const fs::path& folder, const std::vector<std::string>& flags) {
    return Fovea(Joined({"calibrate", "intrinsics", folder.string()}, flags));
  };
  ExpectRefused(
      intrinsics(Out(), board),
      "the board is in 3 views; at least 4 are needed (view-02.png: the image is black, view-04.png: the "
      "image is saturated)");
  // The same view four times does not determine a camera.
  const fs::path alike = folder_.path() / "alike";
  fs::create_directories(alike);
  for (const char* name : {"a.png", "b.png", "c.png", "d.png"}) {
    fs::copy_file(Out() / "view-03.png", alike / name);
  }
  ExpectRefused(intrinsics(alike, board), "nearly the same side");
  // One picture of another size, and intrinsics of another camera.
  const std::string camera = folder_.path() / "camera.toml";
  const auto hand_eye = [&](double f_u_px, int width_px) {
    std::ofstream(camera) << "[camera]\nwidth_px = " << width_px << "\nheight_px = 480\nf_u_px = " << f_u_px
                          << "\nf_v_px = 554.0\nc_u_px = 319.5\nc_v_px = 239.5\n";
    return Fovea(Joined({"calibrate", "hand-eye", folder_.path() / "more", "--camera", camera}, board));
  };
  ASSERT_EQ(Pictures(folder_.path() / "more", Joined(board, {"--views", "6"})).exit_code, 0);
  ExpectRefused(hand_eye(554.0, 320), "has 320 x 480 px");
  ExpectRefused(hand_eye(760.0, 640), "these intrinsics do not fit the images");
  cv::imwrite((alike / "e.png").string(), cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(90)));
  ExpectRefused(intrinsics(alike, board), "320 x 240 px, but the others have 640 x 480 px");
  // Impossible boards.
  ExpectRefused(intrinsics(Out(), {"--board", "8x5", "--square", "0.03", "--marker", "0.03"}),
                "--marker, --dictionary: a marker's side");
  ExpectRefused(intrinsics(Out(), {"--board", "20x20", "--marker", "0.015", "--dictionary", "4x4_50"}),
                "the board has 220 markers");
  ExpectRefused(Pictures(folder_.path() / "wide", {"--board", "40x6", "--square", "0.025"}), "--board 40x6");
  ExpectRefused(Pictures(folder_.path() / "folded", {"--set", "camera.lens=[-2, 0, 0, 0, 0]"}),
                "the lens folds the picture");
}

}  // namespace
}  // namespace fovea::test
