// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "firmware/targets/linux/cameras/camera_driver.hpp"
#include "firmware/targets/linux/hw_config.hpp"

namespace fovea::hw {
namespace {

constexpr std::array kDrivers{
    CameraDriverEntry{"genicam", "GigE Vision or USB3 Vision",
                      "serial number, name or address, \"\" for the first one found", OpenGenicam},
    CameraDriverEntry{"v4l2", "Video4Linux2", "the device's path, \"\" for /dev/video0", OpenV4l2},
    CameraDriverEntry{"recorded", "a folder of pictures, or a video", "the path", OpenRecorded},
};

}  // namespace

std::span<const CameraDriverEntry> CameraDrivers() { return kDrivers; }

std::unique_ptr<CameraDriver> OpenCamera(const HwConfig& config, std::int64_t start_ns) {
  const auto* driver =
      std::find_if(kDrivers.begin(), kDrivers.end(),
                   [&config](const CameraDriverEntry& entry) { return config.camera.driver == entry.name; });
  return driver->open(config, start_ns);
}

}  // namespace fovea::hw
