// SPDX-License-Identifier: Apache-2.0
// The camera of fovea-hw, and the camera drivers by their names in camera.driver: a closed list.
//
// Each driver is a file in this folder, on top of one in hal/drivers, and a line in camera_drivers.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "fovea/hal/camera.hpp"

namespace fovea::hw {

struct HwConfig;

// Counters of a driver; 0 where it does not count.
struct CameraCounters {
  std::uint64_t incomplete = 0;  // frames that arrived damaged
  std::uint64_t lost = 0;        // frames that never arrived, by gaps in their numbers
  std::uint64_t overtaken = 0;   // whole frames that a newer one had replaced already
  std::uint64_t missing_packets = 0;
  std::uint64_t disconnects = 0;
  std::uint64_t reconnects = 0;
  std::uint64_t stamped_by_clock = 0;  // frames with a stamp by the camera's own clock, not by their arrival
  std::uint64_t clock_refused = 0;     // frames whose stamp does not fit that clock: stamped by their arrival
};

class CameraDriver {
 public:
  CameraDriver() = default;
  CameraDriver(const CameraDriver&) = delete;
  CameraDriver& operator=(const CameraDriver&) = delete;
  virtual ~CameraDriver() = default;

  [[nodiscard]] virtual hal::Camera& camera() = 0;
  // A description of the camera as text.
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual CameraCounters counters() const = 0;
};

struct CameraDriverEntry {
  const char* name;
  const char* meaning;  // for the list of keys
  const char* device;   // what camera.device means for this driver
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
