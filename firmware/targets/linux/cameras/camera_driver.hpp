// A camera that fovea-hw sees through, and the drivers that there are, by the name that camera.driver has for
// them: a closed list.
//
// Each driver is a file in this folder, above one in hal/drivers, and a line in camera_drivers.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "fovea/hal/camera.hpp"

namespace fovea::hw {

struct HwConfig;

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

class CameraDriver {
 public:
  CameraDriver() = default;
  CameraDriver(const CameraDriver&) = delete;
  CameraDriver& operator=(const CameraDriver&) = delete;
  virtual ~CameraDriver() = default;

  [[nodiscard]] virtual hal::Camera& camera() = 0;
  // What it is, in words.
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual CameraCounters counters() const = 0;
};

struct CameraDriverEntry {
  const char* name;
  const char* meaning;  // for the list of keys
  const char* device;   // what camera.device is to it
  // Opens and starts it. `start_ns`: the loop's time, at which recorded pictures begin. CameraError.
  std::unique_ptr<CameraDriver> (*open)(const HwConfig& config, std::int64_t start_ns);
};
std::span<const CameraDriverEntry> CameraDrivers();

// The camera of a configuration that has one. CameraError.
std::unique_ptr<CameraDriver> OpenCamera(const HwConfig& config, std::int64_t start_ns);

// The drivers' own.
std::unique_ptr<CameraDriver> OpenGenicam(const HwConfig& config, std::int64_t start_ns);
std::unique_ptr<CameraDriver> OpenV4l2(const HwConfig& config, std::int64_t start_ns);
std::unique_ptr<CameraDriver> OpenRecorded(const HwConfig& config, std::int64_t start_ns);

}  // namespace fovea::hw
