// The camera of a configuration, behind the seam.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "firmware/targets/linux/hw_config.hpp"
#include "fovea/camera/recorded_camera.hpp"
#include "fovea/genicam/genicam_camera.hpp"
#include "fovea/v4l2/v4l2_camera.hpp"

namespace fovea::hw {

// What a driver counted, as far as it does.
struct CameraCounters {
  std::uint64_t incomplete = 0;  // frames that came damaged
  std::uint64_t lost = 0;        // that never came, by their numbers
  std::uint64_t overtaken = 0;   // whole, but a newer one was there already
  std::uint64_t missing_packets = 0;
  std::uint64_t disconnects = 0;
  std::uint64_t reconnects = 0;
  std::uint64_t stamped_by_clock = 0;  // frames with a stamp by the camera's own clock, not by their arrival
  std::uint64_t clock_refused = 0;     // whose stamp cannot be of the clock that was asked: by their arrival
};

class HwCamera {
 public:
  // Opens and starts it. `start_ns`: the loop's time, at which recorded pictures begin. CameraError.
  HwCamera(const HwConfig& config, std::int64_t start_ns);

  [[nodiscard]] hal::Camera& camera();
  // What it is, in words.
  [[nodiscard]] std::string name() const;
  [[nodiscard]] CameraCounters counters() const;

 private:
  std::unique_ptr<genicam::GenicamCamera> genicam_;
  std::unique_ptr<v4l2::V4l2Camera> v4l2_;
  std::unique_ptr<camera::RecordedCamera> recorded_;  // one of the three
  std::string path_;
};

}  // namespace fovea::hw
