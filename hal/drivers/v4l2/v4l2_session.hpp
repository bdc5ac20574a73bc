// SPDX-License-Identifier: Apache-2.0
// One session of a video device: opened, set up, with its buffers mapped, streaming.
#pragma once

#include <linux/videodev2.h>

#include <array>
#include <cstdint>
#include <string>

#include "fovea/camera/raw_picture.hpp"
#include "fovea/v4l2/v4l2_camera.hpp"

namespace fovea::v4l2 {

class V4l2Camera::Session {
 public:
  // On CameraError, the device is closed again.
  Session(const V4l2Config& config, Device& device);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Takes the next filled buffer. Returns 0, else -errno (-EAGAIN: none).
  int Dequeue(v4l2_buffer& buffer);
  int Enqueue(v4l2_buffer& buffer);
  // The picture in a buffer that Dequeue gave.
  [[nodiscard]] camera::RawPicture PictureIn(const v4l2_buffer& buffer) const;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::int64_t exposure_ns() const { return exposure_ns_; }

 private:
  static constexpr std::uint32_t kBuffers = 4;
  struct Mapped {
    void* memory = nullptr;
    std::size_t size = 0;
  };

  void SetUp();
  void SetFormat();
  void SetRate();
  void SetControls();
  void MapBuffers();
  void Release();
  // CameraError if `result` is negative.
  void Check(int result, const std::string& what) const;
  void SetControl(std::uint32_t id, std::int32_t value, const std::string& what);
  [[noreturn]] void Refuse(const std::string& why) const;

  const V4l2Config& config_;
  Device& device_;
  std::string name_;
  camera::RawFormat format_ = camera::RawFormat::kMono8;
  int stride_bytes_ = 0;
  std::int64_t exposure_ns_ = 0;
  std::array<Mapped, kBuffers> mapped_{};
};

}  // namespace fovea::v4l2
