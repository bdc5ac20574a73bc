#include "firmware/targets/linux/hw_camera.hpp"

#include <fmt/format.h>

namespace fovea::hw {
namespace {

constexpr double kNsPerMs = 1e6;
constexpr double kUsPerMs = 1e3;
constexpr double kRecordedRateHz = 30.0;  // of a folder, where nothing else is said
constexpr double kRecordedExposureMs = 5.0;

genicam::GenicamConfig MakeGenicamConfig(const HwConfig& config) {
  const auto& camera = config.camera;
  genicam::GenicamConfig out;
  out.device = camera.device;
  out.width_px = camera.calibration.intrinsics.width_px;
  out.height_px = camera.calibration.intrinsics.height_px;
  out.pixel_format = camera.pixel_format;
  out.rate_hz = camera.rate_hz;
  out.exposure_us = kUsPerMs * camera.exposure_ms;
  out.gain = camera.gain;
  out.packet_size = camera.packet_size;
  out.stamp_at = camera.stamp_at == "start"    ? genicam::StampAt::kStart
                 : camera.stamp_at == "middle" ? genicam::StampAt::kMiddle
                                               : genicam::StampAt::kEnd;
  out.transport_ns = static_cast<std::int64_t>(kNsPerMs * camera.transport_ms);
  out.device_time = camera.time == "device";
  return out;
}

v4l2::V4l2Config MakeV4l2Config(const HwConfig& config) {
  const auto& camera = config.camera;
  v4l2::V4l2Config out;
  out.path = camera.device.empty() ? out.path : camera.device;
  out.width_px = camera.calibration.intrinsics.width_px;
  out.height_px = camera.calibration.intrinsics.height_px;
  out.pixel_format = camera.pixel_format;
  out.rate_hz = camera.rate_hz;
  out.exposure_us = kUsPerMs * camera.exposure_ms;
  out.gain = static_cast<int>(camera.gain);
  out.transport_ns = static_cast<std::int64_t>(kNsPerMs * camera.transport_ms);
  return out;
}

camera::RecordedCameraConfig MakeRecordedConfig(const HwConfig& config, std::int64_t start_ns) {
  const auto& camera = config.camera;
  camera::RecordedCameraConfig out;
  out.path = camera.device;
  out.rate_hz = camera.rate_hz > 0.0 ? camera.rate_hz : kRecordedRateHz;
  out.exposure_ns = static_cast<std::int64_t>(
      kNsPerMs * (camera.exposure_ms > 0.0 ? camera.exposure_ms : kRecordedExposureMs));
  out.start_ns = start_ns;
  return out;
}

}  // namespace

HwCamera::HwCamera(const HwConfig& config, std::int64_t start_ns) : path_(config.camera.device) {
  if (config.camera.driver == "genicam") {
    genicam_ = std::make_unique<genicam::GenicamCamera>(MakeGenicamConfig(config));
  } else if (config.camera.driver == "v4l2") {
    v4l2_ = std::make_unique<v4l2::V4l2Camera>(MakeV4l2Config(config));
  } else {
    recorded_ = std::make_unique<camera::RecordedCamera>(MakeRecordedConfig(config, start_ns));
  }
}

hal::Camera& HwCamera::camera() {
  if (genicam_) {
    return *genicam_;
  }
  return v4l2_ ? static_cast<hal::Camera&>(*v4l2_) : static_cast<hal::Camera&>(*recorded_);
}

std::string HwCamera::name() const {
  if (genicam_) {
    return genicam_->name();
  }
  return v4l2_ ? v4l2_->name() : fmt::format("pictures from {}", path_);
}

CameraCounters HwCamera::counters() const {
  CameraCounters out;
  if (genicam_) {
    const genicam::GenicamCounters c = genicam_->counters();
    out = {c.incomplete,  c.lost,       c.overtaken,        c.missing_packets,
           c.disconnects, c.reconnects, c.stamped_by_clock, c.clock_refused};
  } else if (v4l2_) {
    const v4l2::V4l2Counters& c = v4l2_->counters();
    out = {c.incomplete, c.lost, c.overtaken, 0, c.disconnects, c.reconnects, 0, 0};
  }
  return out;
}

}  // namespace fovea::hw
