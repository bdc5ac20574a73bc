#include "sim/app/pictures.hpp"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "fovea/features/sphere.hpp"

namespace fovea::sim {
namespace {

constexpr int kScale = 2;      // of the eye's pictures
constexpr int kLegendPx = 84;  // height of the strip below them
constexpr int kSubPixelBits = 4;

// Blue, green, red; told apart by brightness too.
const cv::Scalar kDetectionColour(255, 220, 60);
const cv::Scalar kGoalColour(60, 215, 255);
const cv::Scalar kTruthColour(255, 255, 255);

std::string ToPng(const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 4})) {
    throw std::runtime_error("a picture cannot be encoded as PNG");
  }
  return {bytes.begin(), bytes.end()};
}

// A point in the enlarged picture, in OpenCV's fixed-point pixels. Pixel centres stay pixel centres.
cv::Point Enlarged(double u, double v) {
  const double one = 1 << kSubPixelBits;
  return {static_cast<int>(std::lround((kScale * (u + 0.5) - 0.5) * one)),
          static_cast<int>(std::lround((kScale * (v + 0.5) - 0.5) * one))};
}

std::vector<cv::Point> Outline(const vision::Intrinsics& in, const model::Vec3& m) {
  constexpr int kPoints = 180;
  std::vector<cv::Point> points;
  const double u = in.U(m);
  const double v = in.V(m);
  // The radius of a small cone about the axis to start from: tan(theta) f.
  double distance = in.f_u_px * std::sqrt(std::max(m.squaredNorm() - 1.0, 1e-6)) / std::max(m.z(), 0.1);
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2.0 * CV_PI * i / kPoints;
    const double du = std::cos(angle);
    const double dv = std::sin(angle);
    distance = vision::OutlineDistance(in, m, u, v, du, dv, distance);
    points.push_back(Enlarged(u + distance * du, v + distance * dv));
  }
  return points;
}

void DrawOutline(cv::Mat& image, const std::vector<cv::Point>& points, const cv::Scalar& colour,
                 int thickness, bool dashed) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (dashed && i % 6 >= 3) {
      continue;
    }
    cv::line(image, points[i], points[(i + 1) % points.size()], colour, thickness, cv::LINE_AA,
             kSubPixelBits);
  }
}

void DrawCross(cv::Mat& image, double u, double v, double arm_px, const cv::Scalar& colour) {
  cv::line(image, Enlarged(u - arm_px, v), Enlarged(u + arm_px, v), colour, 1, cv::LINE_AA, kSubPixelBits);
  cv::line(image, Enlarged(u, v - arm_px), Enlarged(u, v + arm_px), colour, 1, cv::LINE_AA, kSubPixelBits);
}

void Write(cv::Mat& image, const std::string& text, int x, int y, const cv::Scalar& colour) {
  cv::putText(image, text, {x, y}, cv::FONT_HERSHEY_DUPLEX, 0.7, colour, 1, cv::LINE_AA);
}

KeptFrame Copy(const hal::Frame& frame, const vision::BallDetection& detection) {
  KeptFrame kept;
  kept.stamp_ns = frame.stamp_ns;
  kept.sequence = frame.sequence;
  kept.detection = detection;
  return kept;
}

void CopyPixels(const hal::Frame& frame, cv::Mat& bgr) {
  const cv::Mat view(frame.height_px, frame.width_px, CV_8UC3, const_cast<std::uint8_t*>(frame.pixels.data()),
                     static_cast<std::size_t>(frame.stride_bytes));
  view.copyTo(bgr);
}

}  // namespace

void FrameKeeper::Keep(const hal::Frame& frame, const vision::BallDetection& detection) {
  cv::Mat reused = std::move(last_.bgr);
  last_ = Copy(frame, detection);
  last_.bgr = std::move(reused);
  CopyPixels(frame, last_.bgr);
  if (frames_ == 0) {
    first_ = last_;
    first_.bgr = last_.bgr.clone();
  }
  ++frames_;
  detected_ += detection.found ? 1U : 0U;
}

std::string DrawEyePicture(const KeptFrame& frame, const vision::Intrinsics& in, double radius,
                           const Eigen::Vector3d& p_CO_C, const Eigen::Vector3d& p_CO_C_star) {
  cv::Mat picture;
  cv::resize(frame.bgr, picture, cv::Size(), kScale, kScale, cv::INTER_CUBIC);
  if (p_CO_C.z() > 1.1 * radius) {
    DrawOutline(picture, Outline(in, features::ConeFromSphere(p_CO_C / radius)), kTruthColour, 1, true);
  }
  DrawOutline(picture, Outline(in, features::ConeFromSphere(p_CO_C_star / radius)), kGoalColour, 2, true);
  DrawCross(picture, in.U(p_CO_C_star), in.V(p_CO_C_star), 9.0, kGoalColour);
  if (frame.detection.found) {
    DrawOutline(picture, Outline(in, frame.detection.outline.m), kDetectionColour, 2, false);
    DrawCross(picture, in.U(frame.detection.s), in.V(frame.detection.s), 5.0, kDetectionColour);
  }

  cv::Mat page(picture.rows + kLegendPx, picture.cols, CV_8UC3, cv::Scalar(38, 34, 30));
  picture.copyTo(page.rowRange(0, picture.rows));
  const double error_px = std::hypot(in.U(p_CO_C) - in.U(p_CO_C_star), in.V(p_CO_C) - in.V(p_CO_C_star));
  const int top = picture.rows + 34;
  const int bottom = picture.rows + 66;
  const int middle = page.cols / 2;
  Write(page,
        fmt::format("t = {:.3f} s   image error {:.1f} px", static_cast<double>(frame.stamp_ns) * 1e-9,
                    error_px),
        20, top, kTruthColour);
  Write(page, "dashed: true outline", 20, bottom, kTruthColour);
  Write(page, "dashed, with cross: goal", middle, bottom, kGoalColour);
  Write(page,
        frame.detection.found ? fmt::format("detection, confidence {:.2f}, edge {:.2f} px rms",
                                            frame.detection.confidence, frame.detection.outline.rms_px)
                              : std::string("no detection"),
        middle, top, kDetectionColour);
  return ToPng(page);
}

std::string DrawBenchPicture(const RenderScene& scene, const Exposure& exposure,
                             const std::vector<Eigen::Vector3d>& camera_path,
                             const std::vector<Eigen::Vector3d>& target_path) {
  constexpr int kWidth = 1280;
  constexpr int kHeight = 800;
  constexpr int kSuperSampling = 2;
  const Pinhole pinhole = MakePinhole(kSuperSampling * kWidth, kSuperSampling * kHeight, 0.80);
  // Someone stands at the bench's front corner and looks at what happens over the mat.
  const Eigen::Vector3d eye(1.72, -1.28, 1.02);
  const Eigen::Vector3d look_at(0.30, 0.02, 0.33);
  Eigen::Isometry3d X_BV = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d z = (look_at - eye).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  X_BV.linear().col(0) = x;
  X_BV.linear().col(1) = z.cross(x);
  X_BV.linear().col(2) = z;
  X_BV.translation() = eye;

  RenderScene bright = scene;
  bright.light = 1.0;  // the eye may be dark, the reader is not
  SceneRenderer renderer(bright, pinhole, {4, 2048, 16, 2.5F});
  cv::Mat rgba(pinhole.height_px, pinhole.width_px, CV_8UC4);
  renderer.Draw(exposure, X_BV, {rgba.data, rgba.total() * 4});
  cv::Mat bgr;
  cv::cvtColor(rgba, bgr, cv::COLOR_RGBA2BGR);

  const auto draw_path = [&](const std::vector<Eigen::Vector3d>& path, const cv::Scalar& colour) {
    const double one = 1 << kSubPixelBits;
    std::vector<cv::Point> points;
    for (const Eigen::Vector3d& p_B : path) {
      const Eigen::Vector3d p = X_BV.inverse() * p_B;
      points.emplace_back(static_cast<int>((pinhole.f_px * p.x() / p.z() + pinhole.c_u_px) * one),
                          static_cast<int>((pinhole.f_px * p.y() / p.z() + pinhole.c_v_px) * one));
    }
    for (std::size_t i = 1; i < points.size(); ++i) {
      cv::line(bgr, points[i - 1], points[i], colour, 4, cv::LINE_AA, kSubPixelBits);
    }
  };
  draw_path(target_path, kGoalColour);
  draw_path(camera_path, kDetectionColour);
  cv::resize(bgr, bgr, {kWidth, kHeight}, 0, 0, cv::INTER_AREA);
  return ToPng(bgr);
}

}  // namespace fovea::sim
