// SPDX-License-Identifier: Apache-2.0
// The camera's side of the seam: pixels and the time at which they were true.
#pragma once

#include <cstdint>
#include <span>

#include "fovea/hal/status.hpp"

namespace fovea::hal {

enum class PixelFormat : std::uint8_t {
  kMono8,  // 1 byte per pixel
  kBgr8,   // 3 bytes per pixel: blue, green, red
};

// Bytes per pixel.
constexpr int BytesPerPixel(PixelFormat format) noexcept { return format == PixelFormat::kMono8 ? 1 : 3; }

// A rectangle of a picture's pixels.
struct PixelArea {
  std::int32_t left_px = 0;
  std::int32_t top_px = 0;
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
};

// Makes pixels of a frame when somebody looks at them: converting or drawing those that nobody looks at is
// wasted. A tracker looks at a tenth of its picture.
class PixelMaker {
 public:
  PixelMaker(const PixelMaker&) = delete;
  PixelMaker& operator=(const PixelMaker&) = delete;

  // Makes the pixels of `areas`, each inside the picture, beside those made before: as if all had been made
  // at once. On the thread that acquired the frame, until the next Acquire. If it fails, the next Acquire
  // reports a device fault.
  virtual void Make(std::span<const PixelArea> areas) noexcept = 0;

 protected:
  PixelMaker() noexcept = default;
  ~PixelMaker() = default;
};

// One picture. The pixels belong to the camera and stay as they are until the next Acquire.
struct Frame {
  std::int64_t stamp_ns = 0;     // mid-exposure, monotonic, in the loop's Clock
  std::int64_t exposure_ns = 0;  // exposure time
  std::uint64_t sequence = 0;    // counts the camera's exposures from its start; a gap is a lost frame
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::int32_t stride_bytes = 0;  // from one row to the next
  PixelFormat format = PixelFormat::kBgr8;
  std::span<const std::uint8_t> pixels;  // [height_px * stride_bytes], top row first
  PixelMaker* maker = nullptr;           // makes the pixels; null: all are there
};

// A camera on a network, on USB, or in a simulator. One thread uses it, never the servo's.
class Camera {
 public:
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  // Waits for the next frame, at most `timeout_ns` [ns, >= 0] on the host's clock. Frames come in order,
  // each once. On any answer but kOk, `frame` is left as it was.
  // kTimeout: none came. kClosed: the camera was closed. kDisconnected, kDeviceFault: see StatusCode.
  // kInvalidArgument: negative timeout. kDeviceFault also stands for a frame whose geometry is impossible.
  [[nodiscard]] Status Acquire(Frame& frame, std::int64_t timeout_ns) noexcept;

 protected:
  Camera() noexcept = default;
  ~Camera() = default;

 private:
  virtual Status DoAcquire(Frame& frame, std::int64_t timeout_ns) noexcept = 0;
};

}  // namespace fovea::hal
