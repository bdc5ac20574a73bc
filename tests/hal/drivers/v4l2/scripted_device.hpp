// SPDX-License-Identifier: Apache-2.0
// A video device that a test controls: the kernel's side of Video4Linux2, in memory.
#pragma once

#include <linux/videodev2.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "fovea/v4l2/device.hpp"

namespace fovea::test {

// State that a test sets and reads. It outlives the driver, as a plugged-in camera does.
struct ScriptedCamera {
  bool plugged = true;
  bool unplug_when_empty = false;  // the next Dequeue without a picture finds it unplugged
  bool busy = false;
  bool takes_pictures = true;
  std::uint32_t width = 640;  // the largest size that it supports
  std::uint32_t height = 480;
  std::vector<std::uint32_t> formats{V4L2_PIX_FMT_GREY};
  double rate_hz_max = 120.0;
  std::map<std::uint32_t, std::int32_t> controls;  // set so far
  std::vector<std::uint32_t> refused_controls;
  std::uint32_t stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
  bool streaming = false;
  int mapped = 0;

  struct Picture {
    std::uint8_t gray = 0;
    std::int64_t stamp_us = 0;
    std::uint32_t sequence = 0;
    std::uint32_t flags = 0;
    std::uint32_t missing_bytes = 0;
  };
  // Fills the oldest free buffer; the picture is lost if there is none.
  bool Expose(const Picture& picture) {
    if (!streaming || free.empty()) {
      return false;
    }
    const std::uint32_t index = free.front();
    free.pop_front();
    std::fill(memory[index].begin(), memory[index].end(), picture.gray);
    filled.push_back({index, picture});
    return true;
  }

  v4l2_pix_format pix{};
  std::array<std::vector<std::uint8_t>, 4> memory;
  std::deque<std::uint32_t> free;
  std::deque<std::pair<std::uint32_t, Picture>> filled;
};

class ScriptedDevice final : public v4l2::Device {
 public:
  explicit ScriptedDevice(ScriptedCamera& camera) : camera_(camera) {}

  int Open(const std::string& /*path*/) override { return camera_.plugged ? 0 : -ENOENT; }
  void Close() override { camera_.streaming = false; }
  int Wait(std::int64_t /*timeout_ns*/) override { return camera_.filled.empty() ? 0 : 1; }
  int Map(std::size_t size, std::int64_t offset, void*& memory) override {
    auto& bytes = camera_.memory.at(static_cast<std::size_t>(offset));
    bytes.assign(size, 0);
    memory = bytes.data();
    ++camera_.mapped;
    return 0;
  }
  void Unmap(void* /*memory*/, std::size_t /*size*/) override { --camera_.mapped; }

  int Control(unsigned long request, void* argument) override {
    if (!camera_.plugged) {
      return -ENODEV;
    }
    switch (request) {
      case VIDIOC_QUERYCAP: return QueryCapability(*static_cast<v4l2_capability*>(argument));
      case VIDIOC_G_FMT: return GetFormat(*static_cast<v4l2_format*>(argument));
      case VIDIOC_S_FMT: return SetFormat(*static_cast<v4l2_format*>(argument));
      case VIDIOC_S_PARM: return SetRate(*static_cast<v4l2_streamparm*>(argument));
      case VIDIOC_S_CTRL: return SetControl(*static_cast<v4l2_control*>(argument));
      case VIDIOC_REQBUFS: return camera_.busy ? -EBUSY : 0;
      case VIDIOC_QUERYBUF: return QueryBuffer(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_QBUF: camera_.free.push_back(static_cast<v4l2_buffer*>(argument)->index); return 0;
      case VIDIOC_DQBUF: return Dequeue(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_STREAMON: camera_.streaming = true; return 0;
      case VIDIOC_STREAMOFF:
        camera_.streaming = false;
        camera_.free.clear();
        camera_.filled.clear();
        return 0;
      default: return -ENOTTY;
    }
  }

 private:
  int QueryCapability(v4l2_capability& c) const {
    std::memcpy(c.card, "Scripted", 9);
    c.capabilities =
        (camera_.takes_pictures ? V4L2_CAP_VIDEO_CAPTURE : V4L2_CAP_VIDEO_OUTPUT) | V4L2_CAP_STREAMING;
    return 0;
  }
  int GetFormat(v4l2_format& f) const {
    f.fmt.pix.pixelformat = camera_.formats.front();
    return 0;
  }
  // As kernel drivers do: replaces unsupported values by supported ones.
  int SetFormat(v4l2_format& f) {
    v4l2_pix_format& pix = f.fmt.pix;
    pix.width = std::min(pix.width, camera_.width);
    pix.height = std::min(pix.height, camera_.height);
    bool known = false;
    for (const std::uint32_t format : camera_.formats) {
      known = known || format == pix.pixelformat;
    }
    pix.pixelformat = known ? pix.pixelformat : camera_.formats.front();
    const std::uint32_t depth = pix.pixelformat == V4L2_PIX_FMT_YUYV    ? 2
                                : pix.pixelformat == V4L2_PIX_FMT_BGR24 ? 3
                                                                        : 1;
    pix.bytesperline = pix.width * depth + 16;
    pix.sizeimage = pix.bytesperline * pix.height;
    camera_.pix = pix;
    return 0;
  }
  int SetRate(v4l2_streamparm& parm) const {
    v4l2_fract& period = parm.parm.capture.timeperframe;
    if (period.denominator > camera_.rate_hz_max * period.numerator) {
      period = {1, static_cast<std::uint32_t>(camera_.rate_hz_max)};
    }
    return 0;
  }
  int SetControl(const v4l2_control& control) {
    for (const std::uint32_t id : camera_.refused_controls) {
      if (id == control.id) {
        return -EINVAL;
      }
    }
    camera_.controls[control.id] = control.value;
    return 0;
  }
  int QueryBuffer(v4l2_buffer& b) const {
    b.length = camera_.pix.sizeimage;
    b.m.offset = b.index;
    return 0;
  }
  int Dequeue(v4l2_buffer& b) {
    if (camera_.filled.empty()) {
      camera_.plugged = !camera_.unplug_when_empty;
      return camera_.plugged ? -EAGAIN : -ENODEV;
    }
    const auto [index, picture] = camera_.filled.front();
    camera_.filled.pop_front();
    b.index = index;
    b.bytesused = camera_.pix.sizeimage - picture.missing_bytes;
    b.sequence = picture.sequence;
    b.flags = camera_.stamp_flags | picture.flags;
    b.timestamp.tv_sec = picture.stamp_us / 1'000'000;
    b.timestamp.tv_usec = picture.stamp_us % 1'000'000;
    return 0;
  }

  ScriptedCamera& camera_;
};

}  // namespace fovea::test
