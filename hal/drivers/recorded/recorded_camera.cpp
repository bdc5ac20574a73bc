// SPDX-License-Identifier: Apache-2.0
#include "fovea/recorded/recorded_camera.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

#include "fovea/camera/camera_error.hpp"
#include "fovea/camera/raw_picture.hpp"
#include "fovea/hal/types.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"

namespace fovea::recorded {
namespace {

namespace fs = std::filesystem;

bool IsPicture(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".bmp";
}

std::vector<fs::path> PicturesIn(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && IsPicture(entry.path())) {
      paths.push_back(entry.path());
    }
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace

struct RecordedCamera::Player {
  RecordedCameraConfig config;
  std::vector<fs::path> pictures;  // of a folder
  cv::VideoCapture video;
  double rate_hz = 0.0;
  std::uint64_t next = 0;
  cv::Mat coming;  // the next picture; empty after the last
  cv::Mat given;
  cv::Size size;
  bool broken = false;

  // Reads the next picture.
  void Read() {
    coming.release();
    if (video.isOpened()) {
      video.read(coming);
      return;
    }
    if (next < pictures.size()) {
      coming = cv::imread(pictures[next].string(), cv::IMREAD_ANYCOLOR);
      broken = coming.empty();
    }
  }
  [[nodiscard]] std::int64_t StampNs() const {
    return config.start_ns +
           std::llround(static_cast<double>(next) * static_cast<double>(hal::kNsPerSecond) / rate_hz);
  }
};

RecordedCamera::RecordedCamera(const RecordedCameraConfig& config) : player_(std::make_unique<Player>()) {
  const std::string name = config.path.string();
  player_->config = config;
  player_->rate_hz = config.rate_hz;
  if (fs::is_directory(config.path)) {
    player_->pictures = PicturesIn(config.path);
    if (player_->pictures.empty()) {
      throw camera::CameraError("camera " + name + ": there is no .png, .jpg or .bmp in the folder");
    }
  } else if (!fs::is_regular_file(config.path)) {
    throw camera::CameraError("camera " + name + ": no such folder or file");
  } else if (!player_->video.open(name, cv::CAP_FFMPEG)) {  // some other backends search for devices first
    throw camera::CameraError("camera " + name + ": not a video that can be read");
  } else if (const double rate_hz = player_->video.get(cv::CAP_PROP_FPS); rate_hz > 0.0) {
    player_->rate_hz = rate_hz;
  }
  player_->Read();
  if (player_->coming.empty()) {
    throw camera::CameraError("camera " + (player_->pictures.empty() ? name : player_->pictures[0].string()) +
                              ": the first picture cannot be read");
  }
  player_->size = player_->coming.size();
}

RecordedCamera::~RecordedCamera() = default;

int RecordedCamera::width_px() const { return player_->size.width; }
int RecordedCamera::height_px() const { return player_->size.height; }

hal::Status RecordedCamera::DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept {
  Player& p = *player_;
  try {
    if (p.broken || (!p.coming.empty() && p.coming.size() != p.size)) {
      return hal::Status(hal::StatusCode::kDeviceFault, "recorded picture");
    }
    if (p.coming.empty()) {
      return hal::Status(hal::StatusCode::kClosed, "recorded pictures");
    }
    const std::int64_t stamp_ns = p.StampNs();
    if (p.config.wait) {
      const std::int64_t latest_ns = linux_rt::MonotonicNs() + timeout_ns;
      linux_rt::SleepUntilNs(std::min(stamp_ns, latest_ns));
      if (stamp_ns > latest_ns) {
        return hal::Status(hal::StatusCode::kTimeout, "recorded picture");
      }
    }
    std::swap(p.given, p.coming);
    frame = camera::FrameOf(p.given);
    frame.stamp_ns = stamp_ns;
    frame.exposure_ns = p.config.exposure_ns;
    frame.sequence = p.next++;
    p.Read();
    return hal::Status::Ok();
  } catch (const std::exception&) {  // from a decoder
    p.broken = true;
    return hal::Status(hal::StatusCode::kDeviceFault, "recorded picture");
  }
}

}  // namespace fovea::recorded
