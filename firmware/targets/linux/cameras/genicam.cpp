// SPDX-License-Identifier: Apache-2.0
#include "fovea/genicam/genicam_camera.hpp"

#include "firmware/targets/linux/cameras/camera_driver.hpp"
#include "firmware/targets/linux/hw_config.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::hw {
namespace {

genicam::GenicamConfig MakeGenicamConfig(const HwConfig& config) {
  const auto& camera = config.camera;
  genicam::GenicamConfig out;
  out.device = camera.device;
  out.width_px = camera.calibration.intrinsics.width_px;
  out.height_px = camera.calibration.intrinsics.height_px;
  out.pixel_format = camera.pixel_format;
  out.rate_hz = camera.rate_hz;
  out.exposure_us = 1e3 * camera.exposure_ms;
  out.gain = camera.gain;
  out.packet_size = camera.packet_size;
  out.stamp_at = camera.stamp_at == "start"    ? genicam::StampAt::kStart
                 : camera.stamp_at == "middle" ? genicam::StampAt::kMiddle
                                               : genicam::StampAt::kEnd;
  out.transport_ns = static_cast<std::int64_t>(static_cast<double>(hal::kNsPerMs) * camera.transport_ms);
  out.device_time = camera.time == "device";
  return out;
}

class Genicam final : public CameraDriver {
 public:
  explicit Genicam(const HwConfig& config) : camera_(MakeGenicamConfig(config)) {}

  [[nodiscard]] hal::Camera& camera() override { return camera_; }
  [[nodiscard]] std::string name() const override { return camera_.name(); }
  [[nodiscard]] CameraCounters counters() const override {
    const genicam::GenicamCounters c = camera_.counters();
    return {c.incomplete,  c.lost,       c.overtaken,        c.missing_packets,
            c.disconnects, c.reconnects, c.stamped_by_clock, c.clock_refused};
  }

 private:
  genicam::GenicamCamera camera_;
};

}  // namespace

std::unique_ptr<CameraDriver> OpenGenicam(const HwConfig& config, std::int64_t /*start_ns*/) {
  return std::make_unique<Genicam>(config);
}

}  // namespace fovea::hw
