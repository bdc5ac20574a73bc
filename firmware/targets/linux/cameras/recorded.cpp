// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "firmware/targets/linux/cameras/camera_driver.hpp"
#include "firmware/targets/linux/hw_config.hpp"
#include "fovea/hal/types.hpp"
#include "fovea/recorded/recorded_camera.hpp"

namespace fovea::hw {
namespace {

constexpr double kRecordedRateHz = 30.0;  // of a folder, if camera.rate_hz is 0
constexpr double kRecordedExposureMs = 5.0;

recorded::RecordedCameraConfig MakeRecordedConfig(const HwConfig& config, std::int64_t start_ns) {
  const auto& camera = config.camera;
  recorded::RecordedCameraConfig out;
  out.path = camera.device;
  out.rate_hz = camera.rate_hz > 0.0 ? camera.rate_hz : kRecordedRateHz;
  out.exposure_ns =
      static_cast<std::int64_t>(static_cast<double>(hal::kNsPerMs) *
                                (camera.exposure_ms > 0.0 ? camera.exposure_ms : kRecordedExposureMs));
  out.start_ns = start_ns;
  return out;
}

class Recorded final : public CameraDriver {
 public:
  Recorded(const HwConfig& config, std::int64_t start_ns)
      : path_(config.camera.device), camera_(MakeRecordedConfig(config, start_ns)) {}

  [[nodiscard]] hal::Camera& camera() override { return camera_; }
  [[nodiscard]] std::string name() const override { return fmt::format("pictures from {}", path_); }
  [[nodiscard]] CameraCounters counters() const override { return {}; }

 private:
  const std::string path_;
  recorded::RecordedCamera camera_;
};

}  // namespace

std::unique_ptr<CameraDriver> OpenRecorded(const HwConfig& config, std::int64_t start_ns) {
  return std::make_unique<Recorded>(config, start_ns);
}

}  // namespace fovea::hw
