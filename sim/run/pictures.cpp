// SPDX-License-Identifier: Apache-2.0
#include "sim/run/pictures.hpp"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "firmware/host/film/overlay.hpp"
#include "firmware/host/film/target_curve.hpp"
#include "sim/run/bench_view.hpp"

namespace fovea::sim {
namespace {

constexpr int kScale = 2;          // magnification of the camera's pictures
constexpr int kPageLegendPx = 84;  // height of the strip below them
std::string ToPng(const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1})) {
    throw std::runtime_error("a picture cannot be encoded as PNG");
  }
  return {bytes.begin(), bytes.end()};
}

void CopyPixels(const hal::Frame& frame, cv::Mat& bgr) {
  if (frame.maker != nullptr) {
    const hal::PixelArea whole{0, 0, frame.width_px, frame.height_px};
    frame.maker->Make({&whole, 1});
  }
  const cv::Mat view(frame.height_px, frame.width_px, CV_8UC3, const_cast<std::uint8_t*>(frame.pixels.data()),
                     static_cast<std::size_t>(frame.stride_bytes));
  view.copyTo(bgr);
}

}  // namespace

void FrameKeeper::Keep(const hal::Frame& frame, const vision::Detection& detection, const model::Pose& X_CO) {
  last_.stamp_ns = frame.stamp_ns;
  last_.detection = detection;
  last_.X_CO = X_CO;
  in_parts_ = frame;
  if (frames_ == 0) {
    first_ = last_;
    CopyPixels(frame, first_.bgr);
  }
  if (frame.maker == nullptr) {
    CopyPixels(frame, last_.bgr);
  }
  ++frames_;
  detected_ += detection.found ? 1U : 0U;
}

const KeptFrame& FrameKeeper::last() {
  if (in_parts_.maker != nullptr) {
    CopyPixels(in_parts_, last_.bgr);
  }
  return last_;
}

std::string DrawEyePicture(const KeptFrame& frame, const vision::Intrinsics& in,
                           const features::TargetFeature& target) {
  const Eigen::Vector3d& p_CO_C_star = target.p_CO_C_star;
  const Eigen::Vector3d& p_CO_C = frame.X_CO.p;
  cv::Mat picture;
  cv::resize(frame.bgr, picture, cv::Size(), kScale, kScale, cv::INTER_CUBIC);
  film::Overlay overlay(picture, in, kScale);
  overlay.Outline(film::TargetCurve(in, target, frame.X_CO), film::kTruthColour, 1, true);
  overlay.Goal(film::GoalCurve(in, target), p_CO_C_star);
  overlay.Detection(frame.detection);

  cv::Mat page(picture.rows + kPageLegendPx, picture.cols, CV_8UC3, film::kLegendColour);
  picture.copyTo(page.rowRange(0, picture.rows));
  const double error_px = std::hypot(in.U(p_CO_C) - in.U(p_CO_C_star), in.V(p_CO_C) - in.V(p_CO_C_star));
  const int top = picture.rows + 34;
  const int bottom = picture.rows + 66;
  const int middle = page.cols / 2;
  const auto write = [&page](const std::string& text, int x, int y, const cv::Scalar& colour) {
    film::DrawText(page, text, x, y, 0.7, colour);
  };
  write(fmt::format("t = {:.3f} s   centre error {:.1f} px", static_cast<double>(frame.stamp_ns) * 1e-9,
                    error_px),
        20, top, film::kTruthColour);
  write("dashed: true outline", 20, bottom, film::kTruthColour);
  write("dashed, with cross: goal", middle, bottom, film::kGoalColour);
  write(frame.detection.found ? fmt::format("detection, confidence {:.2f}, edge {:.2f} px rms",
                                            frame.detection.confidence, frame.detection.rms_px)
                              : std::string("no detection"),
        middle, top, film::kDetectionColour);
  return ToPng(page);
}

std::string DrawFrame(const KeptFrame& frame) { return ToPng(frame.bgr); }

std::string DrawBenchPicture(const RenderScene& scene, const Exposure& exposure,
                             const std::vector<Eigen::Vector3d>& camera_path,
                             const std::vector<Eigen::Vector3d>& target_path) {
  constexpr int kWidth = 1280;
  constexpr int kHeight = 800;
  constexpr int kSuperSampling = 2;
  const BenchView view =
      MakeBenchView(exposure, MakeBenchPinhole(kSuperSampling * kWidth, kSuperSampling * kHeight));
  RenderScene bright = scene;
  bright.light = 1.0;  // full light, even if the camera's picture is dark
  SceneRenderer renderer(bright, view.pinhole, {0, 2048, 16, 2.5F});
  cv::Mat rgba(view.pinhole.height_px, view.pinhole.width_px, CV_8UC4);
  renderer.Draw(exposure, view.X_BV, {rgba.data, rgba.total() * 4});
  cv::Mat bgr;
  cv::cvtColor(rgba, bgr, cv::COLOR_RGBA2BGR);

  DrawPath(bgr, view, target_path, film::kGoalColour, 2 * kSuperSampling);
  DrawPath(bgr, view, camera_path, film::kDetectionColour, 2 * kSuperSampling);
  cv::resize(bgr, bgr, {kWidth, kHeight}, 0, 0, cv::INTER_AREA);
  return ToPng(bgr);
}

}  // namespace fovea::sim
