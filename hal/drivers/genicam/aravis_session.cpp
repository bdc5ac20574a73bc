// SPDX-License-Identifier: Apache-2.0
#include "aravis_session.hpp"

#include <array>
#include <cmath>

#include "fovea/camera/camera_error.hpp"

namespace fovea::genicam {
namespace {

using camera::CameraError;
using camera::RawFormat;

constexpr int kBuffers = 8;
constexpr unsigned kPacketTimeoutUs = 5'000;     // then missing packets are requested again
constexpr unsigned kFrameRetentionUs = 100'000;  // after this the frame is abandoned
constexpr int kSocketBufferBytes = 8 << 20;

struct FormatPair {
  ArvPixelFormat aravis;
  RawFormat raw;
};
constexpr std::array<FormatPair, 8> kFormats{{{ARV_PIXEL_FORMAT_MONO_8, RawFormat::kMono8},
                                              {ARV_PIXEL_FORMAT_BAYER_RG_8, RawFormat::kBayerRg8},
                                              {ARV_PIXEL_FORMAT_BAYER_GR_8, RawFormat::kBayerGr8},
                                              {ARV_PIXEL_FORMAT_BAYER_GB_8, RawFormat::kBayerGb8},
                                              {ARV_PIXEL_FORMAT_BAYER_BG_8, RawFormat::kBayerBg8},
                                              {ARV_PIXEL_FORMAT_YUV_422_YUYV_PACKED, RawFormat::kYuyv},
                                              {ARV_PIXEL_FORMAT_RGB_8_PACKED, RawFormat::kRgb8},
                                              {ARV_PIXEL_FORMAT_BGR_8_PACKED, RawFormat::kBgr8}}};

// Turns the error of an Aravis call into an exception: "camera DEVICE: WHAT: Aravis' message".
class Call {
 public:
  Call(const std::string& device, std::string what) : device_(device), what_(std::move(what)) {}
  ~Call() noexcept(false) {
    if (error_ != nullptr) {
      const std::string words = error_->message;
      g_error_free(error_);
      throw CameraError("camera " + device_ + ": " + what_ + ": " + words);
    }
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
  operator GError**() { return &error_; }  // NOLINT(google-explicit-constructor): as Aravis takes it

 private:
  const std::string& device_;
  const std::string what_;
  GError* error_ = nullptr;
};

void OnLost(ArvDevice* /*device*/, std::atomic<bool>* lost) { lost->store(true, std::memory_order_relaxed); }

}  // namespace

std::optional<RawFormat> FormatOf(ArvPixelFormat format) {
  for (const FormatPair& pair : kFormats) {
    if (pair.aravis == format) {
      return pair.raw;
    }
  }
  return std::nullopt;
}

GenicamCamera::Session::Session(const GenicamConfig& config)
    : device_(config.device.empty() ? "(the first)" : config.device) {
  camera_.reset(
      arv_camera_new(config.device.empty() ? nullptr : config.device.c_str(), Call(device_, "not found")));
  if (!camera_) {
    throw CameraError("camera " + device_ + ": not found");
  }
  is_gige_ = arv_camera_is_gv_device(camera_.get()) != FALSE;
  SetUp(config);
  Start(config);
}

GenicamCamera::Session::~Session() {
  clock_.reset();
  if (signal_ != 0) {
    g_signal_handler_disconnect(arv_camera_get_device(camera_.get()), signal_);
  }
  if (stream_) {
    arv_camera_stop_acquisition(camera_.get(), nullptr);
  }
}

void GenicamCamera::Session::SetUp(const GenicamConfig& config) {
  ArvCamera* camera = camera_.get();
  const auto text = [](const char* value) { return std::string(value == nullptr ? "" : value); };
  name_ = text(arv_camera_get_vendor_name(camera, Call(device_, "vendor name"))) + " " +
          text(arv_camera_get_model_name(camera, Call(device_, "model name"))) + " " +
          text(arv_camera_get_device_serial_number(camera, Call(device_, "serial number")));
  arv_camera_set_acquisition_mode(camera, ARV_ACQUISITION_MODE_CONTINUOUS,
                                  Call(device_, "continuous acquisition"));
  arv_camera_clear_triggers(camera, Call(device_, "triggers off"));
  if (!config.pixel_format.empty()) {
    arv_camera_set_pixel_format_from_string(camera, config.pixel_format.c_str(),
                                            Call(device_, "pixel format " + config.pixel_format));
  }
  if (const ArvPixelFormat format = arv_camera_get_pixel_format(camera, Call(device_, "pixel format"));
      !FormatOf(format)) {
    throw CameraError("camera " + device_ + ": pixel format " +
                      text(arv_camera_get_pixel_format_as_string(camera, Call(device_, "pixel format"))) +
                      " is not one of Mono8, Bayer..8, YUYV, RGB8, BGR8");
  }
  SetRegion(config);
  if (config.rate_hz > 0.0) {
    arv_camera_set_frame_rate(camera, config.rate_hz, Call(device_, "frame rate"));
  }
  SetExposure(config);
  if (config.gain >= 0.0) {
    if (arv_camera_is_gain_auto_available(camera, nullptr) != FALSE) {
      arv_camera_set_gain_auto(camera, ARV_AUTO_OFF, Call(device_, "manual gain"));
    }
    arv_camera_set_gain(camera, config.gain, Call(device_, "gain"));
  }
}

void GenicamCamera::Session::SetRegion(const GenicamConfig& config) {
  gint x = 0;
  gint y = 0;
  if (config.width_px > 0 && config.height_px > 0) {
    arv_camera_set_region(camera_.get(), 0, 0, config.width_px, config.height_px, Call(device_, "region"));
  }
  arv_camera_get_region(camera_.get(), &x, &y, &width_px_, &height_px_, Call(device_, "region"));
  if ((config.width_px > 0 && config.width_px != width_px_) ||
      (config.height_px > 0 && config.height_px != height_px_)) {
    throw CameraError("camera " + device_ + ": its pictures are " + std::to_string(width_px_) + " x " +
                      std::to_string(height_px_) + " px, not " + std::to_string(config.width_px) + " x " +
                      std::to_string(config.height_px));
  }
}

void GenicamCamera::Session::SetExposure(const GenicamConfig& config) {
  ArvCamera* camera = camera_.get();
  constexpr double kNsPerUs = 1e3;
  constexpr double kTolerance = 0.05;  // cameras round to their line time
  if (config.exposure_us > 0.0) {
    if (arv_camera_is_exposure_auto_available(camera, nullptr) != FALSE) {
      arv_camera_set_exposure_time_auto(camera, ARV_AUTO_OFF, Call(device_, "manual exposure"));
    }
    arv_camera_set_exposure_time(camera, config.exposure_us, Call(device_, "exposure time"));
  }
  const double exposure_us = arv_camera_get_exposure_time(camera, Call(device_, "reading the exposure time"));
  if (config.exposure_us > 0.0 &&
      std::fabs(exposure_us - config.exposure_us) > kTolerance * config.exposure_us) {
    double least = 0.0;
    double most = 0.0;
    arv_camera_get_exposure_time_bounds(camera, &least, &most, Call(device_, "exposure limits"));
    throw CameraError("camera " + device_ + ": it changed the exposure of " +
                      std::to_string(config.exposure_us) + " us to " + std::to_string(exposure_us) +
                      " us; its range is " + std::to_string(least) + " to " + std::to_string(most) + " us");
  }
  exposure_ns_ = std::llround(exposure_us * kNsPerUs);
}

void GenicamCamera::Session::Start(const GenicamConfig& config) {
  ArvCamera* camera = camera_.get();
  if (is_gige_) {
    // An ordinary socket: it needs no privilege, and a packet socket does not see loopback packets.
    arv_camera_gv_set_stream_options(camera, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
    if (config.packet_size > 0) {
      arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
      arv_camera_gv_set_packet_size(camera, config.packet_size, Call(device_, "packet size"));
    } else {
      arv_camera_gv_auto_packet_size(camera, Call(device_, "packet size"));
    }
  }
  stream_.reset(arv_camera_create_stream(camera, nullptr, nullptr, Call(device_, "stream")));
  if (!stream_) {
    throw CameraError("camera " + device_ + ": cannot open its stream; is another program using it?");
  }
  if (is_gige_) {
    g_object_set(stream_.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
                 kSocketBufferBytes, "packet-resend", ARV_GV_STREAM_PACKET_RESEND_ALWAYS, "packet-timeout",
                 kPacketTimeoutUs, "frame-retention", kFrameRetentionUs, nullptr);
  }
  const guint payload = arv_camera_get_payload(camera, Call(device_, "size of its pictures"));
  for (int i = 0; i < kBuffers; ++i) {
    arv_stream_push_buffer(stream_.get(), arv_buffer_new(payload, nullptr));
  }
  signal_ = g_signal_connect(arv_camera_get_device(camera), "control-lost", G_CALLBACK(OnLost), &lost_);
  arv_camera_start_acquisition(camera, Call(device_, "start"));
  if (!config.device_time) {
    clock_.emplace(arv_camera_get_device(camera));
  }
}

ArvBuffer* GenicamCamera::Session::Pop(std::int64_t timeout_ns) {
  constexpr std::int64_t kNsPerUs = 1000;
  return timeout_ns <= 0
             ? arv_stream_try_pop_buffer(stream_.get())
             : arv_stream_timeout_pop_buffer(stream_.get(), static_cast<guint64>(timeout_ns / kNsPerUs + 1));
}

void GenicamCamera::Session::AddPackets(GenicamCounters& counters) const {
  if (is_gige_) {
    guint64 resent = 0;
    guint64 missing = 0;
    arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_.get()), &resent, &missing);
    counters.resent_packets += resent;
    counters.missing_packets += missing;
  }
}

}  // namespace fovea::genicam
