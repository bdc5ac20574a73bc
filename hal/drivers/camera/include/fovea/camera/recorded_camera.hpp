// A camera that plays what was recorded: the pictures of a folder, or a video.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "fovea/hal/camera.hpp"

namespace fovea::camera {

struct RecordedCameraConfig {
  std::filesystem::path
      path;               // a folder of .png, .jpg or .bmp in the order of their names, or a video's file
  double rate_hz = 30.0;  // of a folder; a video says it itself
  std::int64_t exposure_ns = 5'000'000;  // as it was [ns]
  // Frame k is true at start_ns + k / rate. With `wait` it is handed out when the host's clock is there;
  // without, at once.
  std::int64_t start_ns = 0;
  bool wait = true;
};

class RecordedCamera final : public hal::Camera {
 public:
  // CameraError: no such file or folder, nothing in it that can be read.
  explicit RecordedCamera(const RecordedCameraConfig& config);
  ~RecordedCamera();

  [[nodiscard]] int width_px() const;  // of the first picture
  [[nodiscard]] int height_px() const;

 private:
  struct Player;
  // kClosed after the last picture; kDeviceFault: one that cannot be read, or has another size.
  hal::Status DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept override;

  std::unique_ptr<Player> player_;
};

}  // namespace fovea::camera
