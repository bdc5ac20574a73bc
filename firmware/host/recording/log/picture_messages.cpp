// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/picture_messages.hpp"

#include <fmt/format.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "firmware/host/recording/log/stamp.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "foxglove/image.pb.h"

namespace fovea::log {
namespace {

void SetColour(const char* role, foxglove::Color& colour) {
  const std::string_view name(role);
  // Sky blue for the detection, yellow for the goal, white for the truth; they also differ in brightness.
  const bool detection = name == kDetectionRole;
  colour.set_r(detection ? 0.24 : 1.0);
  colour.set_g(detection ? 0.86 : name == kGoalRole ? 0.84 : 1.0);
  colour.set_b(detection ? 1.0 : name == kGoalRole ? 0.24 : 1.0);
  colour.set_a(1.0);
}

}  // namespace

cv::Mat PictureOf(const hal::Frame& frame) {
  const int type = frame.format == hal::PixelFormat::kMono8 ? CV_8UC1 : CV_8UC3;
  return {frame.height_px, frame.width_px, type, const_cast<std::uint8_t*>(frame.pixels.data()),
          static_cast<std::size_t>(frame.stride_bytes)};
}

foxglove::CompressedImage ImageMessage(const cv::Mat& picture, std::int64_t stamp_ns, int jpeg_quality) {
  std::vector<unsigned char> jpeg;
  if (!cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality})) {
    throw std::runtime_error("a picture cannot be encoded as JPEG");
  }
  foxglove::CompressedImage image;
  SetStamp(stamp_ns, *image.mutable_timestamp());
  image.set_frame_id(kCameraFrame);
  image.set_format("jpeg");
  image.set_data(jpeg.data(), jpeg.size());
  return image;
}

foxglove::CameraCalibration CalibrationMessage(std::int64_t time_ns, const vision::Intrinsics& in) {
  foxglove::CameraCalibration calibration;
  SetStamp(time_ns, *calibration.mutable_timestamp());
  calibration.set_frame_id(kCameraFrame);
  calibration.set_width(static_cast<std::uint32_t>(in.width_px));
  calibration.set_height(static_cast<std::uint32_t>(in.height_px));
  const double K[] = {in.f_u_px, 0.0, in.c_u_px, 0.0, in.f_v_px, in.c_v_px, 0.0, 0.0, 1.0};
  calibration.mutable_k()->Add(std::begin(K), std::end(K));
  if (!in.lens.IsZero()) {
    calibration.set_distortion_model("plumb_bob");
    const double D[] = {in.lens.k1, in.lens.k2, in.lens.p1, in.lens.p2, in.lens.k3};
    calibration.mutable_d()->Add(std::begin(D), std::end(D));
  }
  const double R[] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  calibration.mutable_r()->Add(std::begin(R), std::end(R));
  const double P[] = {in.f_u_px, 0.0, in.c_u_px, 0.0, 0.0, in.f_v_px, in.c_v_px, 0.0, 0.0, 0.0, 1.0, 0.0};
  calibration.mutable_p()->Add(std::begin(P), std::end(P));
  return calibration;
}

void AddOutline(const vision::Intrinsics& in, std::span<const vision::ImagePoint> points, const char* role,
                foxglove::ImageAnnotations& annotations) {
  if (points.empty()) {
    return;
  }
  foxglove::PointsAnnotation& outline = *annotations.add_points();
  outline.set_type(foxglove::PointsAnnotation::LINE_LOOP);
  outline.set_thickness(1.5);
  SetColour(role, *outline.mutable_outline_color());
  foxglove::KeyValuePair& entry = *outline.add_metadata();
  entry.set_key("role");
  entry.set_value(role);
  for (vision::ImagePoint p : points) {
    in.Distort(p.u_px, p.v_px);
    foxglove::Point2& point = *outline.add_points();
    point.set_x(p.u_px);
    point.set_y(p.v_px);
  }
}

void AddDetection(const vision::Intrinsics& in, const vision::Detection& detection,
                  foxglove::ImageAnnotations& annotations) {
  if (!detection.found) {
    return;
  }
  AddOutline(in, detection.Outline(), kDetectionRole, annotations);
  foxglove::TextAnnotation& text = *annotations.add_texts();
  text.mutable_position()->set_x(detection.u_px + detection.radius_px);
  text.mutable_position()->set_y(detection.v_px - detection.radius_px);
  text.set_text(fmt::format("{:.2f}", detection.confidence));
  text.set_font_size(12.0);
  SetColour(kDetectionRole, *text.mutable_text_color());
  text.mutable_background_color()->set_a(0.5);
}

}  // namespace fovea::log
