// SPDX-License-Identifier: Apache-2.0
#include "v4l2_session.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>

#include "fovea/camera/camera_error.hpp"

namespace fovea::v4l2 {
namespace {

using camera::RawFormat;

struct FormatPair {
  std::uint32_t fourcc;
  RawFormat raw;
};
constexpr std::array<FormatPair, 8> kFormats{{{V4L2_PIX_FMT_GREY, RawFormat::kMono8},
                                              {V4L2_PIX_FMT_SRGGB8, RawFormat::kBayerRg8},
                                              {V4L2_PIX_FMT_SGRBG8, RawFormat::kBayerGr8},
                                              {V4L2_PIX_FMT_SGBRG8, RawFormat::kBayerGb8},
                                              {V4L2_PIX_FMT_SBGGR8, RawFormat::kBayerBg8},
                                              {V4L2_PIX_FMT_YUYV, RawFormat::kYuyv},
                                              {V4L2_PIX_FMT_RGB24, RawFormat::kRgb8},
                                              {V4L2_PIX_FMT_BGR24, RawFormat::kBgr8}}};

std::string Letters(std::uint32_t fourcc) {
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    text += static_cast<char>((fourcc >> shift) & 0x7FU);
  }
  return text;
}

v4l2_buffer EmptyBuffer(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

}  // namespace

V4l2Camera::Session::Session(const V4l2Config& config, Device& device) : config_(config), device_(device) {
  Check(device_.Open(config.path), "cannot be opened");
  try {
    SetUp();
  } catch (...) {
    Release();
    throw;
  }
}

V4l2Camera::Session::~Session() { Release(); }

void V4l2Camera::Session::Release() {
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  device_.Control(VIDIOC_STREAMOFF, &type);
  for (Mapped& mapped : mapped_) {
    if (mapped.memory != nullptr) {
      device_.Unmap(mapped.memory, mapped.size);
      mapped.memory = nullptr;
    }
  }
  device_.Close();
}

void V4l2Camera::Session::Refuse(const std::string& why) const {
  throw camera::CameraError("camera " + config_.path + ": " + why);
}

void V4l2Camera::Session::Check(int result, const std::string& what) const {
  if (result < 0) {
    Refuse(what + ": " + std::strerror(-result));
  }
}

void V4l2Camera::Session::SetUp() {
  v4l2_capability capability{};
  Check(device_.Control(VIDIOC_QUERYCAP, &capability), "is not a video device");
  const std::uint32_t can = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps
                                                                                  : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) {
    Refuse("it does not capture video, or does not stream it");
  }
  const auto* card = reinterpret_cast<const char*>(capability.card);
  name_ = std::string(card, strnlen(card, sizeof(capability.card)));
  SetFormat();
  SetRate();
  SetControls();
  MapBuffers();
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  Check(device_.Control(VIDIOC_STREAMON, &type), "does not start");
}

void V4l2Camera::Session::SetFormat() {
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  Check(device_.Control(VIDIOC_G_FMT, &format), "does not report its format");
  v4l2_pix_format& pix = format.fmt.pix;
  pix.width = static_cast<std::uint32_t>(config_.width_px);
  pix.height = static_cast<std::uint32_t>(config_.height_px);
  pix.field = V4L2_FIELD_NONE;
  pix.bytesperline = 0;
  if (!config_.pixel_format.empty()) {
    const auto wanted = camera::FormatOf(config_.pixel_format);
    if (!wanted) {
      Refuse("pixel format " + config_.pixel_format + " is not one of Mono8, Bayer..8, YUYV, RGB8, BGR8");
    }
    for (const FormatPair& pair : kFormats) {
      pix.pixelformat = pair.raw == *wanted ? pair.fourcc : pix.pixelformat;
    }
  }
  const std::uint32_t asked = pix.pixelformat;
  Check(device_.Control(VIDIOC_S_FMT, &format), "refuses the format");
  if (pix.pixelformat != asked) {
    Refuse("gives " + Letters(pix.pixelformat) + " pictures, not " + Letters(asked));
  }
  if (pix.width != static_cast<std::uint32_t>(config_.width_px) ||
      pix.height != static_cast<std::uint32_t>(config_.height_px)) {
    Refuse("its pictures are " + std::to_string(pix.width) + " x " + std::to_string(pix.height) +
           " px, not " + std::to_string(config_.width_px) + " x " + std::to_string(config_.height_px));
  }
  bool known = false;
  for (const FormatPair& pair : kFormats) {
    if (pair.fourcc == pix.pixelformat) {
      format_ = pair.raw;
      known = true;
    }
  }
  if (!known) {
    Refuse("pixel format " + Letters(pix.pixelformat) + " is not one of Mono8, Bayer..8, YUYV, RGB8, BGR8");
  }
  const int row = config_.width_px * camera::RawBytesPerPixel(format_);
  stride_bytes_ = pix.bytesperline == 0 ? row : static_cast<int>(pix.bytesperline);
}

void V4l2Camera::Session::SetRate() {
  if (config_.rate_hz <= 0.0) {
    return;
  }
  constexpr double kPerUnit = 1000.0;  // rates are set in thousandths of a hertz
  v4l2_streamparm parm{};
  parm.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  parm.parm.capture.timeperframe = {static_cast<std::uint32_t>(kPerUnit),
                                    static_cast<std::uint32_t>(std::lround(kPerUnit * config_.rate_hz))};
  Check(device_.Control(VIDIOC_S_PARM, &parm), "refuses the frame rate");
  const v4l2_fract& got = parm.parm.capture.timeperframe;
  const double got_hz = got.numerator == 0 ? 0.0 : static_cast<double>(got.denominator) / got.numerator;
  constexpr double kTolerance = 0.02;
  if (std::fabs(got_hz - config_.rate_hz) > kTolerance * config_.rate_hz) {
    Refuse("it changed the frame rate from " + std::to_string(config_.rate_hz) + " to " +
           std::to_string(got_hz) + " Hz");
  }
}

void V4l2Camera::Session::SetControls() {
  constexpr double kUnitUs = 100.0;  // of V4L2_CID_EXPOSURE_ABSOLUTE
  if (config_.exposure_us > 0.0) {
    SetControl(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, "manual exposure");
    const auto units = static_cast<std::int32_t>(std::lround(config_.exposure_us / kUnitUs));
    SetControl(V4L2_CID_EXPOSURE_ABSOLUTE, units, "exposure time");
    exposure_ns_ = std::llround(1e3 * config_.exposure_us);
  }
  if (config_.gain >= 0) {
    SetControl(V4L2_CID_GAIN, config_.gain, "gain");
  }
}

void V4l2Camera::Session::SetControl(std::uint32_t id, std::int32_t value, const std::string& what) {
  v4l2_control control{id, value};
  Check(device_.Control(VIDIOC_S_CTRL, &control), "refuses " + what + " = " + std::to_string(value));
  if (control.value != value) {
    Refuse("it changed " + what + " = " + std::to_string(value) + " to " + std::to_string(control.value));
  }
}

void V4l2Camera::Session::MapBuffers() {
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  Check(device_.Control(VIDIOC_REQBUFS, &request), "gives no buffers; is another program using it?");
  if (request.count < 2) {
    Refuse("gives fewer than two buffers");
  }
  for (std::uint32_t i = 0; i < std::min(request.count, kBuffers); ++i) {
    v4l2_buffer buffer = EmptyBuffer(i);
    Check(device_.Control(VIDIOC_QUERYBUF, &buffer), "gives no buffers");
    void* memory = nullptr;
    Check(device_.Map(buffer.length, buffer.m.offset, memory), "cannot map its buffers");
    mapped_[i] = {memory, buffer.length};
    Check(Enqueue(buffer), "takes no buffers");
  }
}

int V4l2Camera::Session::Dequeue(v4l2_buffer& buffer) {
  buffer = EmptyBuffer(0);
  return device_.Control(VIDIOC_DQBUF, &buffer);
}

int V4l2Camera::Session::Enqueue(v4l2_buffer& buffer) { return device_.Control(VIDIOC_QBUF, &buffer); }

camera::RawPicture V4l2Camera::Session::PictureIn(const v4l2_buffer& buffer) const {
  camera::RawPicture raw;
  raw.format = format_;
  raw.width_px = config_.width_px;
  raw.height_px = config_.height_px;
  raw.stride_bytes = stride_bytes_;
  if (buffer.index < kBuffers && mapped_[buffer.index].memory != nullptr) {
    const Mapped& mapped = mapped_[buffer.index];
    raw.bytes = {static_cast<const std::uint8_t*>(mapped.memory),
                 std::min<std::size_t>(buffer.bytesused, mapped.size)};
  }
  return raw;
}

}  // namespace fovea::v4l2
