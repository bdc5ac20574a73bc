// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/cameras/camera_driver.hpp"
#include "firmware/targets/linux/hw_config.hpp"
#include "fovea/hal/types.hpp"
#include "fovea/v4l2/v4l2_camera.hpp"

namespace fovea::hw {
namespace {

v4l2::V4l2Config MakeV4l2Config(const HwConfig& config) {
  const auto& camera = config.camera;
  v4l2::V4l2Config out;
  out.path = camera.device.empty() ? out.path : camera.device;
  out.width_px = camera.calibration.intrinsics.width_px;
  out.height_px = camera.calibration.intrinsics.height_px;
  out.pixel_format = camera.pixel_format;
  out.rate_hz = camera.rate_hz;
  out.exposure_us = 1e3 * camera.exposure_ms;
  out.gain = static_cast<int>(camera.gain);
  out.transport_ns = static_cast<std::int64_t>(static_cast<double>(hal::kNsPerMs) * camera.transport_ms);
  return out;
}

class V4l2 final : public CameraDriver {
 public:
  explicit V4l2(const HwConfig& config) : camera_(MakeV4l2Config(config)) {}

  [[nodiscard]] hal::Camera& camera() override { return camera_; }
  [[nodiscard]] std::string name() const override { return camera_.name(); }
  [[nodiscard]] CameraCounters counters() const override {
    const v4l2::V4l2Counters& c = camera_.counters();
    return {c.incomplete, c.lost, c.overtaken, 0, c.disconnects, c.reconnects, 0, 0};
  }

 private:
  v4l2::V4l2Camera camera_;
};

}  // namespace

std::unique_ptr<CameraDriver> OpenV4l2(const HwConfig& config, std::int64_t /*start_ns*/) {
  return std::make_unique<V4l2>(config);
}

}  // namespace fovea::hw
