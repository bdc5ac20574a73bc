// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/detect/detect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/config/target_keys.hpp"
#include "firmware/vision/detect/target_detector.hpp"
#include "tools/fovea/calibrate/camera_file.hpp"
#include "tools/fovea/detect/image_files.hpp"

namespace fovea {
namespace {

constexpr double kDefaultSize = 0.08;  // [m]; an arbitrary size when none is given

vision::DetectorConfig ConfigFor(const DetectArguments& a, const cv::Mat& image,
                                 const std::optional<vision::Intrinsics>& camera, const std::string& file) {
  vision::DetectorConfig config;
  config::TargetSettings target;
  target.kind = a.target;
  target.diameter = target.side = a.size > 0.0 ? a.size : kDefaultSize;
  config.LookFor(config::MakeTarget(target));
  if (camera) {
    if (camera->width_px != image.cols || camera->height_px != image.rows) {
      throw config::InputError(fmt::format("{}: {} x {} px, but --camera {} has {} x {} px", file, image.cols,
                                           image.rows, a.camera_file, camera->width_px, camera->height_px));
    }
    config.intrinsics = *camera;
  } else {
    config.intrinsics = AssumedCamera(image.cols, image.rows, a.focal_px);
  }
  const std::string method = !a.method.empty() ? a.method : a.hue_deg >= 0.0 ? "colour" : "gray";
  config.by = method == "colour"  ? vision::FindBy::kColour
              : method == "hough" ? vision::FindBy::kHough
                                  : vision::FindBy::kGray;
  config.colour.hue_deg = std::max(a.hue_deg, 0.0);
  config.hough = a.hough;
  config.radius_min_px = a.radius_min_px;
  config.radius_max_px = a.radius_max_px > 0.0 ? a.radius_max_px : 0.75 * std::max(image.cols, image.rows);
  if (config.radius_min_px >= config.radius_max_px) {
    throw config::InputError("--radius-min must be below --radius-max");
  }
  config.confidence_min = a.confidence_min;
  // Only the radii bound the outline's size. The distance is free.
  config.distance_min = 0.51 * config.size;
  config.distance_max = 4.0 * config.intrinsics.f_u_px * config.size / config.radius_min_px;
  return config;
}

nlohmann::json ToJson(const std::string& file, const vision::Detection& d, double ms,
                      const std::string& why) {
  nlohmann::json entry{{"file", file},
                       {"found", d.found},
                       {"u_px", nullptr},
                       {"v_px", nullptr},
                       {"radius_px", nullptr},
                       {"corners_px", nlohmann::json::array()},
                       {"cov", nullptr},
                       {"ms", ms},
                       {"confidence", d.confidence},
                       {"why", d.found ? nlohmann::json(nullptr) : nlohmann::json(why)}};
  if (!d.found) {
    return entry;
  }
  entry["u_px"] = d.u_px;
  entry["v_px"] = d.v_px;
  entry["radius_px"] = d.radius_px;
  for (const vision::ImagePoint& corner : d.Corners()) {
    entry["corners_px"].push_back({corner.u_px, corner.v_px});
  }
  entry["cov"] = nlohmann::json::array();
  for (int row = 0; row < 3; ++row) {
    entry["cov"].push_back({d.cov_uvr_px2(row, 0), d.cov_uvr_px2(row, 1), d.cov_uvr_px2(row, 2)});
  }
  return entry;
}

// Why the detector found no target in `image`.
std::string WhyNotFound(const DetectArguments& a, const cv::Mat& image, vision::DetectorConfig config) {
  if (const std::optional<std::string> nothing = WhyNothing(image)) {
    return *nothing;
  }
  config.confidence_min = 0.0;
  const vision::Detection best = vision::TargetDetector(config).Detect(image);
  if (best.found) {
    return fmt::format(
        "the best outline, at ({:.1f}, {:.1f}) px with a radius of {:.1f} px, has a confidence of {:.2f}, "
        "below --confidence-min {:.2f}",
        best.u_px, best.v_px, best.radius_px, best.confidence, a.confidence_min);
  }
  if (config.by != vision::FindBy::kGray) {
    const std::string missed =
        config.by == vision::FindBy::kColour
            ? fmt::format("is not found by its colour (--hue {:g}, or too little saturation)", a.hue_deg)
            : fmt::format(
                  "is not found by the Hough transform (--hough-votes {:g}, --hough-canny, --hough-blur)",
                  a.hough.votes);
    config.by = vision::FindBy::kGray;
    if (const vision::Detection gray = vision::TargetDetector(config).Detect(image); gray.found) {
      return fmt::format("the best outline of a {}, at ({:.1f}, {:.1f}) px with a radius of {:.1f} px, {}",
                         a.target, gray.u_px, gray.v_px, gray.radius_px, missed);
    }
  }
  return fmt::format("no outline of a {} with a radius of {:.0f} to {:.0f} px", a.target,
                     config.radius_min_px, config.radius_max_px);
}

std::filesystem::path MarkedFile(const std::filesystem::path& folder,
                                 const std::filesystem::path& image_file) {
  return folder / (image_file.stem().string() + "-marked.png");
}

// config::InputError when the marked copies of two images would have the same name.
void CheckMarkedFiles(const std::filesystem::path& folder,
                      const std::vector<std::filesystem::path>& image_files) {
  std::map<std::filesystem::path, std::filesystem::path> written;
  for (const std::filesystem::path& image_file : image_files) {
    const auto [other, is_new] = written.emplace(MarkedFile(folder, image_file), image_file);
    if (!is_new) {
      throw config::InputError(
          fmt::format("--marked: {} and {} would both be written to {}; images need different names",
                      other->second.string(), image_file.string(), other->first.string()));
    }
  }
}

// Writes the image in colour, with the detection drawn in.
void WriteMarked(const std::filesystem::path& file, const cv::Mat& image,
                 const vision::Detection& detection) {
  constexpr int kShift = 4;  // OpenCV draws with a resolution of 1/16 pixel
  const cv::Scalar kBlue(255, 128, 0);
  const auto point = [](const vision::ImagePoint& p) {
    return cv::Point(static_cast<int>(std::lround(p.u_px * (1 << kShift))),
                     static_cast<int>(std::lround(p.v_px * (1 << kShift))));
  };
  cv::Mat marked;
  if (image.channels() == 1) {
    cv::cvtColor(image, marked, cv::COLOR_GRAY2BGR);
  } else {
    marked = image.clone();
  }
  if (detection.found) {
    std::vector<cv::Point> outline;
    for (const vision::ImagePoint& p : detection.Outline()) {
      outline.push_back(point(p));
    }
    cv::polylines(marked, outline, true, kBlue, 2, cv::LINE_AA, kShift);
    for (const vision::ImagePoint& p : detection.Corners()) {
      cv::circle(marked, point(p), 4 << kShift, kBlue, 2, cv::LINE_AA, kShift);
    }
    cv::drawMarker(marked, cv::Point(cvRound(detection.u_px), cvRound(detection.v_px)), kBlue,
                   cv::MARKER_CROSS, 12, 2, cv::LINE_AA);
  }
  if (!cv::imwrite(file.string(), marked)) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

}  // namespace

CLI::App* AddDetect(CLI::App& app, DetectArguments& a) {
  CLI::App* detect = app.add_subcommand("detect", "detect a target in images: position, size, confidence");
  detect->add_option("image", a.images, "images, or folders of them")->required();
  detect->add_option("--target", a.target, "target to detect")
      ->required()
      ->check(CLI::IsMember(
          std::vector<std::string>(features::kTargetNames.begin(), features::kTargetNames.end())));
  detect
      ->add_option(
          "--method", a.method,
          "edges in colour, edges in brightness, or OpenCV's Hough transform; default: gray without --hue")
      ->check(CLI::IsMember({"colour", "gray", "hough"}));
  detect->add_option("--hue", a.hue_deg, "hue of the target [deg]: 0 red, 120 green, 240 blue")
      ->check(CLI::Range(0.0, 360.0));
  detect->add_option("--camera", a.camera_file,
                     "intrinsics, as `fovea calibrate intrinsics --out` writes them");
  detect
      ->add_option("--focal-px", a.focal_px,
                   "focal length [px] without --camera; default: a field of view of 60 degrees")
      ->check(CLI::PositiveNumber);
  detect->add_option("--size", a.size, "diameter or side of the target [m]")->check(CLI::PositiveNumber);
  detect
      ->add_option("--radius-min", a.radius_min_px,
                   "smallest outline: radius of the circle with its area [px]")
      ->check(CLI::Range(4.0, 1e5))
      ->capture_default_str();
  detect->add_option("--radius-max", a.radius_max_px, "largest outline [px]")->check(CLI::Range(4.0, 1e5));
  detect->add_option("--confidence-min", a.confidence_min, "reject detections below it")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  detect->add_option("--hough-blur", a.hough.blur_sigma_px, "method hough: Gaussian blur [px]")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  detect->add_option("--hough-canny", a.hough.canny_threshold, "method hough: threshold of the edge detector")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  detect->add_option("--hough-votes", a.hough.votes, "method hough: votes that a circle needs")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  detect->add_option("--marked", a.marked,
                     "folder for a copy of each image with the detected outline and corners");
  detect->add_flag("--json", a.json,
                   "a list of {file, found, u_px, v_px, radius_px, corners_px, cov, ms, ...}");
  detect->footer(
      "cov is of u, v and the radius [px^2].\n"
      "Examples:\n"
      "  fovea detect --target circle photo.png\n"
      "  fovea detect --target sphere --hue 0 pictures/ --json\n"
      "  fovea detect --target square --marked marked/ photo.png\n"
      "  fovea detect --target circle --method hough --hough-votes 40 photo.png\n"
      "Exit: 0 done (found or not), 2 wrong usage or input.");
  return detect;
}

int Detect(const DetectArguments& arguments) {
  cv::setNumThreads(1);
  const bool round = features::FindTraits(arguments.target)->body != features::TargetBody::kPlate;
  if (arguments.method == "hough" && !round) {
    throw config::InputError("--method hough: finds only spheres and circles");
  }
  std::optional<vision::Intrinsics> camera;
  if (!arguments.camera_file.empty()) {
    camera = ReadCameraFile(arguments.camera_file);
  }
  const std::vector<std::filesystem::path> image_files = ImageFiles(arguments.images);
  if (!arguments.marked.empty()) {
    CheckMarkedFiles(arguments.marked, image_files);
    std::error_code error;
    std::filesystem::create_directories(arguments.marked, error);
    if (error) {
      throw config::InputError(
          fmt::format("--marked {}: cannot make this folder: {}", arguments.marked, error.message()));
    }
  }
  nlohmann::json list = nlohmann::json::array();
  std::unique_ptr<vision::TargetDetector> detector;
  vision::DetectorConfig config;
  cv::Size size;
  for (const std::filesystem::path& path : image_files) {
    const cv::Mat image = ReadImage(path);
    if (!detector || image.size() != size) {
      size = image.size();
      config = ConfigFor(arguments, image, camera, path.string());
      detector = std::make_unique<vision::TargetDetector>(config);
      (void)detector->Detect(image);  // the first image of a size also allocates; it is not timed
    }
    detector->Forget();  // the images may be unrelated
    const auto start = std::chrono::steady_clock::now();
    const vision::Detection d = detector->Detect(image);
    const double ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    const std::string why = d.found ? "" : WhyNotFound(arguments, image, config);
    if (!arguments.marked.empty()) {
      WriteMarked(MarkedFile(arguments.marked, path), image, d);
    }
    if (arguments.json) {
      list.push_back(ToJson(path.string(), d, ms, why));
    } else if (d.found) {
      config::PrintFitted(
          fmt::format("{}: at ({:.3f}, {:.3f}) px +- {:.3f}, radius {:.3f} px +- {:.3f}, "
                      "confidence {:.2f}, {:.2f} ms",
                      config::Printable(path.string()), d.u_px, d.v_px,
                      std::sqrt(0.5 * (d.cov_uvr_px2(0, 0) + d.cov_uvr_px2(1, 1))), d.radius_px,
                      std::sqrt(d.cov_uvr_px2(2, 2)), d.confidence, ms));
    } else {
      config::PrintFitted(
          fmt::format("{}: not found: {}, {:.2f} ms", config::Printable(path.string()), why, ms));
    }
  }
  if (arguments.json) {
    // Replaces invalid UTF-8: a file's name may hold any bytes.
    fmt::print("{}\n", list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  }
  return config::kDone;
}

}  // namespace fovea
