// SPDX-License-Identifier: Apache-2.0
// One session of a camera through Aravis: opened, set up and streaming until it is lost or closed.
#pragma once

#include <arv.h>

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "device_clock.hpp"
#include "fovea/camera/raw_picture.hpp"
#include "fovea/genicam/genicam_camera.hpp"

namespace fovea::genicam {

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};
template <typename T>
using Owned = std::unique_ptr<T, Unref>;

// The raw format of an Aravis format; empty for formats that are not supported.
std::optional<camera::RawFormat> FormatOf(ArvPixelFormat format);

class GenicamCamera::Session {
 public:
  // CameraError.
  explicit Session(const GenicamConfig& config);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // The next buffer, complete or not; null after the timeout. The caller must give it back.
  ArvBuffer* Pop(std::int64_t timeout_ns);
  void GiveBack(ArvBuffer* buffer) { arv_stream_push_buffer(stream_.get(), buffer); }

  [[nodiscard]] bool lost() const { return lost_.load(std::memory_order_relaxed); }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }
  [[nodiscard]] std::int64_t exposure_ns() const { return exposure_ns_; }
  // Whether frame numbers have 16 bits, until one is larger.
  [[nodiscard]] bool counts_to_16_bits() const { return is_gige_; }
  // The camera's own clock; null if its stamps are used unchanged.
  [[nodiscard]] const DeviceClock* clock() const { return clock_ ? &*clock_ : nullptr; }
  // Adds the resent and missing packets of a GigE Vision camera.
  void AddPackets(GenicamCounters& counters) const;

 private:
  void SetUp(const GenicamConfig& config);
  void SetRegion(const GenicamConfig& config);
  void SetExposure(const GenicamConfig& config);
  void Start(const GenicamConfig& config);

  std::string device_;
  std::string name_;
  Owned<ArvCamera> camera_;
  Owned<ArvStream> stream_;
  gulong signal_ = 0;
  bool is_gige_ = false;
  int width_px_ = 0;
  int height_px_ = 0;
  std::int64_t exposure_ns_ = 0;
  std::atomic<bool> lost_{false};
  std::optional<DeviceClock> clock_;  // last: its thread uses the camera
};

}  // namespace fovea::genicam
