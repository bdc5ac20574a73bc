// SPDX-License-Identifier: Apache-2.0
#include "sim/gige/camera.hpp"

#include <arv.h>

#include <chrono>
#include <cmath>
#include <stdexcept>

#include "fovea/franka/sockets.hpp"
#include "fovea/hal/types.hpp"
#include "sim/gige/pixels.hpp"

namespace fovea::sim {
namespace {

// Aravis serves its control port only between pictures. A wait for a picture must therefore be shorter than a
// client's timeout for an answer.
constexpr std::chrono::milliseconds kFillPatience{300};
constexpr std::chrono::seconds kLeavePatience{2};
constexpr std::uint32_t kLookPeriodUs = 1000;
constexpr std::size_t kMostSerial = 15;

// Aravis would share a port that is already in use; then both users miss packets.
void CheckPortIsFree(const GigeCameraConfig& config) {
  constexpr std::uint16_t kControlPort = 3956;
  try {
    const franka::UdpSocket trial({franka::Resolve(config.address, 0).ip, kControlPort});
  } catch (const franka::NetworkError& error) {
    throw std::runtime_error("camera \"" + config.serial + "\": " + error.what() +
                             "; every GigE Vision camera needs this port");
  }
}

}  // namespace

struct GigeCamera::Aravis {
  ArvGvFakeCamera* server = nullptr;
  ArvFakeCamera* registers = nullptr;  // of `server`
  ~Aravis() {
    if (server != nullptr) {
      g_object_unref(server);  // ends its thread
    }
  }
  void Set(std::uint32_t address, double value) const {
    arv_fake_camera_write_register(registers, address, static_cast<guint32>(std::lround(value)));
  }
};

GigeCamera::GigeCamera(hal::Camera& eye, const GigeCameraConfig& config)
    : eye_(eye), config_(config), aravis_(std::make_unique<Aravis>()) {
  if (config.serial.empty() || config.serial.size() > kMostSerial) {
    throw std::runtime_error("camera \"" + config.serial + "\": a serial number has 1 to 15 characters");
  }
  CheckPortIsFree(config);
  aravis_->server = arv_gv_fake_camera_new(config.address.c_str(), config.serial.c_str());
  if (aravis_->server == nullptr || arv_gv_fake_camera_is_running(aravis_->server) == FALSE) {
    throw std::runtime_error("camera \"" + config.serial + "\": " + config.address +
                             " is not an address of this computer");
  }
  aravis_->registers = arv_gv_fake_camera_get_fake_camera(aravis_->server);
  constexpr double kUsPerS = 1e6;
  constexpr double kNsPerUs = 1e3;
  aravis_->Set(ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH, config.width_px);
  aravis_->Set(ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT, config.height_px);
  aravis_->Set(ARV_FAKE_CAMERA_REGISTER_WIDTH, config.width_px);
  aravis_->Set(ARV_FAKE_CAMERA_REGISTER_HEIGHT, config.height_px);
  aravis_->Set(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, ARV_PIXEL_FORMAT_RGB_8_PACKED);
  aravis_->Set(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US, kUsPerS / config.rate_hz);
  aravis_->Set(ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US, static_cast<double>(config.exposure_ns) / kNsPerUs);
  arv_fake_camera_set_fill_pattern(
      aravis_->registers,
      [](ArvBuffer* buffer, void* self, guint32 /*exposure*/, guint32 /*gain*/, ArvPixelFormat format) {
        static_cast<GigeCamera*>(self)->Fill(buffer, format);
      },
      this);
}

GigeCamera::~GigeCamera() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

bool GigeCamera::streaming() const {
  return arv_fake_camera_get_control_channel_privilege(aravis_->registers) != 0 &&
         arv_fake_camera_get_acquisition_status(aravis_->registers) != 0;
}

std::uint64_t GigeCamera::sent() const {
  const std::lock_guard lock(mutex_);
  return sent_;
}

bool GigeCamera::Expect(std::int64_t stamp_ns, std::int64_t late_ns) {
  const bool wanted = streaming();
  const std::lock_guard lock(mutex_);
  if (wanted) {
    expected_.push_back({stamp_ns, stamp_ns + config_.transport_ns + late_ns});
  } else {
    expected_.clear();
  }
  return wanted;
}

bool GigeCamera::IsDue() const { return !expected_.empty() && expected_.front().due_ns <= now_ns_; }

void GigeCamera::Advance(std::int64_t now_ns, bool wait) {
  std::unique_lock lock(mutex_);
  now_ns_ = now_ns;
  if (!IsDue()) {
    return;
  }
  changed_.notify_all();
  if (wait && streaming() &&
      !changed_.wait_for(lock, kLeavePatience, [this] { return closed_ || !IsDue(); })) {
    expected_.clear();
  }
}

void GigeCamera::Fill(void* buffer, std::uint32_t pixel_format) {
  // The world's time decides when a picture leaves, so Aravis polls for pictures as often as it can.
  aravis_->Set(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US, kLookPeriodUs);
  auto* const target = static_cast<ArvBuffer*>(buffer);
  std::unique_lock lock(mutex_);
  if (on_its_way_) {  // the last picture has left by now
    on_its_way_ = false;
    ++sent_;
    while (!expected_.empty() && expected_.front().stamp_ns <= frame_.stamp_ns) {
      expected_.pop_front();
    }
    changed_.notify_all();
  }
  const bool taken = TakeDue(lock);
  on_its_way_ = taken;
  lock.unlock();  // only this thread uses frame_, and the robot must not wait for its pixels
  // The buffer's own memory; no other thread uses it now. Its `received` size is not set yet.
  std::size_t received = 0;
  auto* const data = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(target, &received)));
  // Without a new picture, the last one is sent again with the same number and stamp. Before the first, a
  // black picture with number 0 is sent; GigE Vision reserves 0 for test packets.
  FillPixels(frame_, arv_buffer_get_image_width(target), arv_buffer_get_image_height(target), pixel_format,
             {data, arv_fake_camera_get_payload(aravis_->registers)});
  arv_buffer_set_timestamp(target, static_cast<guint64>(frame_.stamp_ns));
  constexpr std::uint64_t kNumbers = 65535;  // GigE Vision numbers frames from 1 to this
  arv_buffer_set_frame_id(target, frame_.pixels.empty() ? 0 : frame_.sequence % kNumbers + 1);
}

// Takes the next picture that is due into frame_. False if none comes in time.
bool GigeCamera::TakeDue(std::unique_lock<std::mutex>& lock) {
  const auto end = std::chrono::steady_clock::now() + kFillPatience;
  while (changed_.wait_until(lock, end, [this] { return closed_ || IsDue(); }) && !closed_) {
    const std::int64_t wanted_ns = expected_.front().stamp_ns;
    lock.unlock();
    hal::Frame frame;
    const hal::Status status =
        eye_.Acquire(frame, std::chrono::duration_cast<std::chrono::nanoseconds>(kFillPatience).count());
    lock.lock();
    if (!status.ok()) {
      return false;
    }
    frame_ = frame;  // its pixels stay valid until the next Acquire
    while (!expected_.empty() && expected_.front().stamp_ns < frame.stamp_ns) {
      expected_.pop_front();  // lost by eye_
    }
    if (frame.stamp_ns >= wanted_ns) {
      return true;
    }
  }
  return false;
}

}  // namespace fovea::sim
