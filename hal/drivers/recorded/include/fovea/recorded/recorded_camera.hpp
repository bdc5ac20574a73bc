// SPDX-License-Identifier: Apache-2.0
// A camera that plays recorded pictures: those of a folder, or a video.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "fovea/hal/camera.hpp"

namespace fovea::recorded {

struct RecordedCameraConfig {
  std::filesystem::path path;  // a folder of .png, .jpg or .bmp, played in order of their names, or a video
  double rate_hz = 30.0;       // of a folder; a video file has its own
  std::int64_t exposure_ns = 5'000'000;  // of the recording [ns]
  // Frame k has the stamp start_ns + k / rate. With `wait` it is delivered at that time of the host's clock;
  // without, at once.
  std::int64_t start_ns = 0;
  bool wait = true;
};

class RecordedCamera final : public hal::Camera {
 public:
  // CameraError: no such file or folder, or no readable picture in it.
  explicit RecordedCamera(const RecordedCameraConfig& config);
  ~RecordedCamera();

  [[nodiscard]] int width_px() const;  // of the first picture
  [[nodiscard]] int height_px() const;

 private:
  struct Player;
  // kClosed after the last picture; kDeviceFault for a picture that cannot be read or has another size.
  hal::Status DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept override;

  std::unique_ptr<Player> player_;
};

}  // namespace fovea::recorded
