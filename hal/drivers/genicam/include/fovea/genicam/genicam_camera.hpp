// SPDX-License-Identifier: Apache-2.0
// A GigE Vision or USB3 Vision camera, by Aravis.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>
#include <thread>

#include "fovea/camera/frame_counter.hpp"
#include "fovea/camera/stamp_mapper.hpp"
#include "fovea/hal/camera.hpp"

struct _ArvBuffer;  // Aravis' own name

namespace fovea::genicam {

// When in the exposure the camera takes its stamp; makers differ.
enum class StampAt : std::uint8_t { kStart, kMiddle, kEnd };

struct GenicamConfig {
  std::string device;  // "vendor-model-serial", the serial number, or an address; empty: the first one found
  int width_px = 0;    // of a region in the sensor's top left corner; 0: as the camera is set
  int height_px = 0;
  std::string pixel_format;  // by its GenICam name; empty: as the camera is set
  double rate_hz = 0.0;      // 0: as the camera is set
  double exposure_us = 0.0;  // 0: as the camera is set
  double gain = -1.0;        // in the camera's unit; negative: as the camera is set
  int packet_size = 0;       // GigE Vision [bytes]; 0: the largest that the network carries
  StampAt stamp_at = StampAt::kStart;
  // The least time from stamp to arrival; used if the camera's own clock cannot be read.
  std::int64_t transport_ns = 0;
  // The camera's clock is the loop's (by PTP; or a simulated one in lockstep): stamps are used unchanged.
  bool device_time = false;
  bool reconnect = true;  // after a loss, search for the camera until it is back
};

struct GenicamCounters {
  std::uint64_t frames = 0;
  std::uint64_t incomplete = 0;  // frames with missing packets, or abandoned
  std::uint64_t lost = 0;        // frames that never arrived complete, by gaps in their numbers
  std::uint64_t overtaken = 0;   // complete, but a newer one had already arrived
  std::uint64_t resent_packets = 0;
  std::uint64_t missing_packets = 0;
  std::uint64_t disconnects = 0;
  std::uint64_t reconnects = 0;
  std::uint64_t stamped_by_clock = 0;  // frames stamped by the camera's own clock
  std::uint64_t clock_refused = 0;     // frames whose stamp cannot be from the clock that was read
};

class GenicamCamera final : public hal::Camera {
 public:
  // Opens, sets up and starts the camera. CameraError: not found, in use, or it refuses a setting.
  explicit GenicamCamera(const GenicamConfig& config);
  ~GenicamCamera();

  // From any thread: Acquire still delivers waiting frames, then returns kClosed.
  void Close();

  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  // From the acquiring thread, or after it has ended.
  [[nodiscard]] GenicamCounters counters() const;
  // Seconds that the host's clock gains on the camera's in a second; 0 until 8 s are known.
  [[nodiscard]] double clock_drift() const { return drift_; }

 private:
  class Session;

  // While the camera is lost: kTimeout with `reconnect`, else kDisconnected. Takes the newest of the waiting
  // frames and counts the others as overtaken.
  hal::Status DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept override;
  [[nodiscard]] hal::Status Take(Session& session, hal::Frame& frame, std::int64_t timeout_ns);
  [[nodiscard]] bool IsNoPicture(const Session& session, _ArvBuffer* buffer) const;
  [[nodiscard]] std::int64_t StampOf(const Session& session, std::int64_t device_ns, std::int64_t arrival_ns);
  [[nodiscard]] std::int64_t HostTimeOf(const Session& session, std::int64_t device_ns,
                                        std::int64_t arrival_ns);
  void Look();

  const GenicamConfig config_;
  std::shared_ptr<Session> session_;  // guarded by mutex_ once looking_ runs; null: camera lost
  std::string name_;
  int width_px_ = 0;
  int height_px_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool closed_ = false;
  bool came_back_ = false;
  std::atomic<std::uint64_t> reconnects_{0};

  // For the acquiring thread.
  cv::Mat picture_;
  std::int64_t last_device_ns_ = INT64_MIN;  // stamp of the last picture
  camera::FrameCounter numbers_;
  camera::StampMapper mapper_;
  std::int64_t last_host_ns_ = INT64_MIN;
  double drift_ = 0.0;
  GenicamCounters counters_;
  std::thread looking_;
};

}  // namespace fovea::genicam
