// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/calibrate/calibrate.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <sstream>

#include "firmware/host/beliefs/findings_json.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/config/roll_pitch_yaw.hpp"
#include "firmware/host/config/toml_edit.hpp"
#include "firmware/vision/detect/target_detector.hpp"
#include "tools/fovea/calibrate/camera_file.hpp"
#include "tools/fovea/calibrate/from_log.hpp"
#include "tools/fovea/calibrate/hand_poses.hpp"
#include "tools/fovea/detect/image_files.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSection = "camera";       // of a configuration
constexpr std::string_view kCommentSign = "# ";  // the output can be pasted into a configuration

// Writes the result into the configuration of --write.
void Write(const CalibrateArguments& a, const std::vector<config::NewValue>& values) {
  if (!a.write.empty()) {
    config::WriteValues(a.write, kSection, values);
  }
}

// Prints the section for a configuration.
void PrintSection(const CalibrateArguments& a, const std::vector<config::NewValue>& values) {
  fmt::print("{}", config::SectionText(kSection, values));
  if (!a.write.empty()) {
    fmt::print("# written into [{}] of {}\n", kSection, config::Printable(a.write));
  }
}

int Focal(const CalibrateArguments& a) {
  const std::vector<fs::path> files = ImageFiles(a.images);
  std::vector<calibration::RadiusView> views;
  std::vector<cv::Size> sizes;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const cv::Mat image = ReadImage(files[i]);
    if (!sizes.empty() && image.size() != sizes.front()) {
      throw config::InputError(fmt::format("{}: {} x {} px, but {} has {} x {} px", files[i].string(),
                                           image.cols, image.rows, files[0].string(), sizes[0].width,
                                           sizes[0].height));
    }
    sizes.push_back(image.size());
    vision::DetectorConfig config;
    config.kind = a.target == "sphere" ? hal::FeatureKind::kSphere : hal::FeatureKind::kCircle;
    config.by = vision::FindBy::kGray;
    // Only the radius is used. It hardly depends on this assumed camera.
    config.intrinsics = AssumedCamera(image.cols, image.rows);
    config.size = a.diameter;
    config.radius_max_px = 0.75 * image.cols;
    config.distance_min = 0.51 * a.diameter;
    config.distance_max = 4.0 * config.intrinsics.f_u_px * a.diameter / config.radius_min_px;
    const vision::Detection d = vision::TargetDetector(config).Detect(image);
    if (!d.found) {
      throw config::InputError(
          fmt::format("{}: {}", files[i].string(),
                      WhyNothing(image).value_or(fmt::format("no {} found in this image", a.target))));
    }
    views.push_back({d.radius_px, std::sqrt(d.cov_uvr_px2(2, 2)), static_cast<double>(i) * a.delta_z});
  }
  const calibration::FocalLength r = calibration::SolveFocalLength(views, a.diameter, a.target == "sphere");
  // Radii tell neither the lens nor how well points fit, so both are reset.
  const vision::Intrinsics in = AssumedCamera(sizes[0].width, sizes[0].height, r.f_px);
  const std::vector<config::NewValue> values = CameraValues(in, 0.0);
  Write(a, values);
  if (a.json) {
    nlohmann::json radii = nlohmann::json::array();
    for (const calibration::RadiusView& view : views) {
      radii.push_back(view.radius_px);
    }
    fmt::print(
        "{}\n",
        nlohmann::json{
            {"f_px", r.f_px}, {"sigma_px", r.sigma_px}, {"Z", r.Z}, {"rms_px", r.rms_px}, {"radii_px", radii}}
            .dump(2));
  } else {
    fmt::print("# focal length {:.3f} px +- {:.3f}; first view at {:.4f} m; radii fit to {:.4f} px rms\n",
               r.f_px, r.sigma_px, r.Z, r.rms_px);
    fmt::print("# assumed: square pixels, no distortion, principal point in the middle of the image\n");
    PrintSection(a, values);
  }
  return config::kDone;
}

// The board in the images of a folder.
struct BoardFolder {
  std::vector<calibration::BoardView> views;
  cv::Size size;
  std::string without;  // images without the board, and why; "": none
};

// All images must have the same size.
BoardFolder ReadBoards(const std::string& folder, const calibration::Board& board) {
  BoardFolder found;
  for (const fs::path& file : ImageFiles({folder})) {
    const cv::Mat image = ReadImage(file);
    if (found.size.area() > 0 && image.size() != found.size) {
      throw config::InputError(fmt::format("{}: {} x {} px, but the others have {} x {} px", file.string(),
                                           image.cols, image.rows, found.size.width, found.size.height));
    }
    found.size = image.size();
    calibration::BoardView view;
    view.name = file.filename().string();
    const std::optional<std::string> nothing = WhyNothing(image);
    if (!nothing && calibration::FindBoard(image, board, view)) {
      found.views.push_back(view);
      continue;
    }
    found.without += fmt::format("{}{}: {}", found.without.empty() ? "" : ", ", config::Printable(view.name),
                                 nothing.value_or("board not found"));
  }
  return found;
}

// The result of `solve`. When it refuses the views, the error also lists the images without the board.
template <typename Solve>
auto SolveBoards(const BoardFolder& found, const Solve& solve) {
  try {
    return solve();
  } catch (const calibration::CalibrationError& error) {
    if (found.without.empty()) {
      throw;
    }
    throw calibration::CalibrationError(fmt::format("{} ({})", error.what(), found.without));
  }
}

void SayWithout(const BoardFolder& found) {
  if (!found.without.empty()) {
    std::istringstream lines(config::Fitted("without the board: " + found.without, 2,
                                            config::TerminalWidth(STDOUT_FILENO) - kCommentSign.size()));
    for (std::string line; std::getline(lines, line);) {
      fmt::print("{}{}\n", kCommentSign, line);
    }
  }
}

int FindIntrinsics(const CalibrateArguments& a) {
  const BoardFolder found = ReadBoards(a.folder, a.board);
  const calibration::IntrinsicsResult r =
      SolveBoards(found, [&] { return calibration::SolveIntrinsics(found.views, a.board, found.size); });
  const vision::Intrinsics& in = r.intrinsics;
  const std::vector<config::NewValue> values = CameraValues(in, r.rms_px);
  if (!a.out.empty()) {
    std::ofstream stream(a.out, std::ios::trunc);
    stream << config::SectionText(kSection, values);
    stream.close();
    if (!stream) {
      throw config::InputError(a.out + ": cannot be written");
    }
  }
  Write(a, values);
  if (a.json) {
    fmt::print("{}\n", nlohmann::json{{"width_px", in.width_px},
                                      {"height_px", in.height_px},
                                      {"f_u_px", in.f_u_px},
                                      {"f_v_px", in.f_v_px},
                                      {"c_u_px", in.c_u_px},
                                      {"c_v_px", in.c_v_px},
                                      {"lens", {in.lens.k1, in.lens.k2, in.lens.p1, in.lens.p2, in.lens.k3}},
                                      {"sigma_f_px", r.sigma_f_px},
                                      {"sigma_c_px", r.sigma_c_px},
                                      {"rms_px", r.rms_px},
                                      {"views", r.views},
                                      {"without_board", found.without}}
                           .dump(2));
  } else {
    SayWithout(found);
    fmt::print("# f +- {:.3f} px, c +- {:.3f} px, {} views fit to {:.4f} px rms\n", r.sigma_f_px,
               r.sigma_c_px, r.views, r.rms_px);
    PrintSection(a, values);
  }
  return config::kDone;
}

// The views whose pictures poses.csv names, with the hand's poses.
std::vector<calibration::HandView> HandViews(const std::string& folder,
                                             const std::vector<calibration::BoardView>& boards) {
  std::vector<calibration::HandView> views;
  for (const HandPose& pose : ReadHandPoses(fs::path(folder) / "poses.csv")) {
    for (const calibration::BoardView& board : boards) {
      if (board.name == pose.file) {
        views.push_back({pose.X_BE, board});
      }
    }
  }
  return views;
}

int HandEye(const CalibrateArguments& a) {
  const vision::Intrinsics in = ReadCameraFile(a.camera_file);
  const BoardFolder found = ReadBoards(a.folder, a.board);
  if (found.size != cv::Size(in.width_px, in.height_px)) {
    throw config::InputError(fmt::format("{}: images have {} x {} px, but --camera {} has {} x {} px",
                                         a.folder, found.size.width, found.size.height, a.camera_file,
                                         in.width_px, in.height_px));
  }
  const std::vector<calibration::HandView> views = HandViews(a.folder, found.views);
  const calibration::HandEyeResult r =
      SolveBoards(found, [&] { return calibration::SolveHandEye(views, a.board, in); });
  const Eigen::Quaterniond q(r.X_EC.R);
  const std::array<double, 3> rpy_deg = config::RollPitchYawOf(r.X_EC.R);
  const std::vector<config::NewValue> mount{
      {"mount_xyz", fmt::format("[{:.6f}, {:.6f}, {:.6f}]", r.X_EC.p.x(), r.X_EC.p.y(), r.X_EC.p.z())},
      {"mount_rpy_deg", fmt::format("[{:.5f}, {:.5f}, {:.5f}]", rpy_deg[0], rpy_deg[1], rpy_deg[2])},
      {"mount_rms_mm", fmt::format("{:.4g}", r.rms_mm)}};
  Write(a, mount);
  if (a.json) {
    fmt::print(
        "{}\n",
        nlohmann::json{{"X_EC", {r.X_EC.p.x(), r.X_EC.p.y(), r.X_EC.p.z(), q.w(), q.x(), q.y(), q.z()}},
                       {"rms_mm", r.rms_mm},
                       {"rms_deg", r.rms_deg},
                       {"rms_px", r.rms_px},
                       {"views", r.views},
                       {"without_board", found.without}}
            .dump(2));
  } else {
    SayWithout(found);
    fmt::print(
        "# {} views agree on the board's pose to {:.3f} mm and {:.4f} deg rms, its corners fit to {:.4f} "
        "px\n",
        r.views, r.rms_mm, r.rms_deg, r.rms_px);
    PrintSection(a, mount);
  }
  return config::kDone;
}

int FromLog(const CalibrateArguments& a) {
  const LogCalibration r = CalibrateFromLog(a.log);
  if (!r.why_incomplete.empty()) {
    fmt::print(stderr, "fovea: {}; the calibration is from the readable part\n", r.why_incomplete);
  }
  if (!r.values.empty()) {
    Write(a, r.values);
  } else if (!a.write.empty()) {
    fmt::print(stderr, "{}: nothing is known from this log; {} stays as it is\n", a.log, a.write);
  }
  if (a.json) {
    nlohmann::ordered_json json = beliefs::ToJson(r.findings);
    for (const config::NewValue& value : r.values) {
      json["camera"][value.key] = value.value;
    }
    fmt::print("{}\n", json.dump(2));
    return config::kDone;
  }
  fmt::print("# {} views of the target fit to {:.2f} of their stated errors\n", r.findings.views,
             r.findings.misfit);
  for (const std::string& sigma : r.sigmas) {
    fmt::print("# {}\n", sigma);
  }
  for (const std::string& unknown : r.unknown) {
    fmt::print("# unknown: {}; {}\n", unknown,
               r.findings.DoViewsFit() ? "this motion cannot tell"
                                       : "the views do not fit a still target and this model of the camera");
  }
  if (!r.values.empty()) {
    PrintSection(a, r.values);
  }
  return config::kDone;
}

int WriteBoard(const CalibrateArguments& a) {
  constexpr int kSquarePx = 120;
  constexpr int kMarginPx = 60;
  cv::Mat page;
  cv::copyMakeBorder(calibration::DrawBoard(a.board, kSquarePx), page, kMarginPx, kMarginPx, kMarginPx,
                     kMarginPx, cv::BORDER_CONSTANT, cv::Scalar(255));
  bool written = false;
  try {
    written = cv::imwrite(a.out, page);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) {
    throw config::InputError(a.out + ": cannot be written; the name must end in .png");
  }
  fmt::print("{}: {} x {} px; a square has {} px and {} m\n", a.out, page.cols, page.rows, kSquarePx,
             a.board.square);
  return config::kDone;
}

}  // namespace

CLI::App* AddCalibrate(CLI::App& app, CalibrateArguments& a) {
  CLI::App* calibrate =
      app.add_subcommand("calibrate", "calibrate a camera: focal length, intrinsics, hand-eye pose");
  calibrate->require_subcommand(1);
  calibrate->footer(
      "Examples:\n"
      "  fovea calibrate focal --diameter 0.08 --delta-z 0.10 near.png far.png\n"
      "  fovea calibrate board --board 8x5 --square 0.03 --marker 0.022 --out board.png\n"
      "  fovea calibrate intrinsics boards/ --board 9x6 --square 0.025 --out camera.toml\n"
      "  fovea calibrate intrinsics boards/ --board 8x5 --square 0.03 --marker 0.022 --out camera.toml\n"
      "  fovea calibrate hand-eye boards/ --board 9x6 --square 0.025 --camera camera.toml\n"
      "  fovea calibrate hand-eye boards/ --board 9x6 --square 0.025 --camera camera.toml --write cell.toml\n"
      "  fovea calibrate from-log out/ball-exciting\n"
      "Exit: 0 done, 2 wrong usage or input.");
  CLI::App* focal = calibrate->add_subcommand(
      "focal", "calibrate the focal length from views of one disc or ball, each --delta-z further away");
  focal->add_option("image", a.images, "two or more images, the nearest first")->required();
  focal->add_option("--diameter", a.diameter, "diameter of the target [m]")
      ->required()
      ->check(CLI::PositiveNumber);
  focal->add_option("--delta-z", a.delta_z, "distance from one view to the next [m]")
      ->required()
      ->check(CLI::PositiveNumber);
  focal->add_option("--target", a.target, "circle or sphere")
      ->check(CLI::IsMember({"circle", "sphere"}))
      ->capture_default_str();
  CLI::App* board = calibrate->add_subcommand("board", "write the board as an image to print");
  CLI::App* intrinsics = calibrate->add_subcommand(
      "intrinsics", "calibrate intrinsics and lens from views of a chessboard or ChArUco board");
  CLI::App* hand_eye =
      calibrate->add_subcommand("hand-eye", "calibrate X_EC from views of a board and their poses.csv");
  for (CLI::App* command : {intrinsics, hand_eye}) {
    command->add_option("folder", a.folder, "folder with the images")->required();
  }
  for (CLI::App* command : {board, intrinsics, hand_eye}) {
    config::AddBoardFlags(*command, a.board_flags);
  }
  board->add_option("--out", a.out, "the picture to write: .png")->required();
  intrinsics->add_option("--out", a.out, "the camera file to write");
  CLI::App* from_log = calibrate->add_subcommand(
      "from-log", "refine mount, focal length and latency from the log of a run with a still target");
  from_log->add_option("log", a.log, "a log.mcap, or the folder of a run")->required();
  for (CLI::App* command : {focal, intrinsics, hand_eye, from_log}) {
    command->add_option(
        "--write", a.write,
        "write the result into [camera] of this configuration (.toml); the rest is unchanged");
  }
  hand_eye->add_option("--camera", a.camera_file, "camera file from `calibrate intrinsics --out`")
      ->required();
  for (CLI::App* command : {focal, intrinsics, hand_eye, from_log}) {
    command->add_flag("--json", a.json, "print JSON");
  }
  return calibrate;
}

int Calibrate(const CLI::App& calibrate, CalibrateArguments& a) {
  cv::setNumThreads(1);
  a.board = config::MakeBoard(a.board_flags);
  try {
    const std::string name = calibrate.get_subcommands().front()->get_name();
    if (name == "focal") {
      return Focal(a);
    }
    if (name == "from-log") {
      return FromLog(a);
    }
    return name == "board" ? WriteBoard(a) : name == "intrinsics" ? FindIntrinsics(a) : HandEye(a);
  } catch (const calibration::CalibrationError& error) {
    throw config::InputError(fmt::format("{}: {}", a.folder.empty() ? "focal" : a.folder, error.what()));
  }
}

}  // namespace fovea
