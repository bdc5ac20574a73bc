// SPDX-License-Identifier: Apache-2.0
#include "fovea/genicam/genicam_camera.hpp"

#include <algorithm>
#include <chrono>

#include "aravis_session.hpp"
#include "fovea/camera/camera_error.hpp"
#include "fovea/camera/stamp.hpp"
#include "fovea/hal/types.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"

namespace fovea::genicam {
namespace {

constexpr std::chrono::milliseconds kLookPeriod{500};
constexpr std::uint64_t k16Bits = 65535;
constexpr std::int64_t kClockMarginNs = 5 * hal::kNsPerMs;  // error of a reading of the camera's clock
constexpr std::int64_t kOldestNs = hal::kNsPerSecond;       // longest transport time of a picture
constexpr std::int64_t kLostLookNs = 50 * hal::kNsPerMs;    // longest wait between checks of the connection

}  // namespace

GenicamCamera::GenicamCamera(const GenicamConfig& config)
    : config_(config), session_(std::make_shared<Session>(config)), mapper_(config.transport_ns) {
  name_ = session_->name();
  width_px_ = session_->width_px();
  height_px_ = session_->height_px();
  if (session_->counts_to_16_bits()) {
    numbers_ = camera::FrameCounter(1, k16Bits);
  }
  if (config.reconnect) {
    looking_ = std::thread([this] { Look(); });
  }
}

GenicamCamera::~GenicamCamera() {
  Close();
  if (looking_.joinable()) {
    looking_.join();
  }
}

void GenicamCamera::Close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

hal::Status GenicamCamera::DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept {
  try {
    std::shared_ptr<Session> session;
    bool closed = false;
    {
      std::unique_lock lock(mutex_);
      if (!session_ && config_.reconnect && !closed_) {
        changed_.wait_for(lock, std::chrono::nanoseconds(timeout_ns), [this] { return closed_ || session_; });
      }
      if (closed_ && !session_) {
        return hal::Status(hal::StatusCode::kClosed, "camera");
      }
      closed = closed_;
      session = session_;
      if (came_back_) {
        came_back_ = false;
        numbers_.Restart();
        mapper_.Restart();
      }
    }
    if (!session) {
      return config_.reconnect ? hal::Status(hal::StatusCode::kTimeout, "camera is disconnected")
                               : hal::Status(hal::StatusCode::kDisconnected, "camera");
    }
    const hal::Status status = Take(*session, frame, closed ? 0 : timeout_ns);
    return closed && !status.ok() ? hal::Status(hal::StatusCode::kClosed, "camera") : status;
  } catch (const std::exception&) {  // OpenCV cannot convert the picture, or no memory
    return hal::Status(hal::StatusCode::kDeviceFault, "camera picture");
  }
}

hal::Status GenicamCamera::Take(Session& session, hal::Frame& frame, std::int64_t timeout_ns) {
  const std::int64_t end_ns = linux_rt::MonotonicNs() + timeout_ns;
  ArvBuffer* newest = nullptr;
  std::int64_t arrival_ns = 0;
  do {
    ArvBuffer* buffer = session.Pop(std::min(end_ns - linux_rt::MonotonicNs(), kLostLookNs));
    while (buffer != nullptr) {
      if (arv_buffer_get_status(buffer) != ARV_BUFFER_STATUS_SUCCESS) {
        ++counters_.incomplete;
        session.GiveBack(buffer);
      } else if (IsNoPicture(session, buffer)) {
        session.GiveBack(buffer);
      } else {
        if (newest != nullptr) {
          ++counters_.overtaken;
          session.GiveBack(newest);
        }
        newest = buffer;
        arrival_ns = linux_rt::MonotonicNs();
      }
      buffer = session.Pop(0);
    }
  } while (newest == nullptr && linux_rt::MonotonicNs() < end_ns && !session.lost());
  if (newest == nullptr) {
    if (!session.lost()) {
      return hal::Status(hal::StatusCode::kTimeout, "camera");
    }
    const std::lock_guard lock(mutex_);
    ++counters_.disconnects;
    session.AddPackets(counters_);
    session_.reset();
    changed_.notify_all();
    return config_.reconnect ? hal::Status(hal::StatusCode::kTimeout, "camera is disconnected")
                             : hal::Status(hal::StatusCode::kDisconnected, "camera");
  }

  camera::RawPicture raw;
  const auto format = FormatOf(arv_buffer_get_image_pixel_format(newest));
  raw.width_px = arv_buffer_get_image_width(newest);
  raw.height_px = arv_buffer_get_image_height(newest);
  gint x_padding = 0;
  gint y_padding = 0;
  arv_buffer_get_image_padding(newest, &x_padding, &y_padding);
  std::size_t size = 0;
  const auto* bytes = static_cast<const std::uint8_t*>(arv_buffer_get_image_data(newest, &size));
  raw.bytes = {bytes, size};
  bool unpacked = false;
  if (format) {
    raw.format = *format;
    unpacked = camera::SetPadding(x_padding, raw) && camera::Unpack(raw, picture_);
  }
  const auto device_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(newest));
  last_device_ns_ = device_ns;
  const std::uint64_t number = arv_buffer_get_frame_id(newest);
  session.GiveBack(newest);
  if (config_.device_time && (device_ns < 0 || device_ns > camera::kMostStampNs)) {
    return hal::Status(hal::StatusCode::kDeviceFault, "camera stamp");
  }
  if (!unpacked || picture_.cols != width_px_ || picture_.rows != height_px_) {
    return hal::Status(hal::StatusCode::kDeviceFault, "camera picture");
  }
  if (number > k16Bits) {
    numbers_.Widen();
  }
  frame = camera::FrameOf(picture_);
  frame.exposure_ns = session.exposure_ns();
  frame.stamp_ns = StampOf(session, device_ns, arrival_ns);
  frame.sequence = numbers_.Count(number);
  counters_.lost = numbers_.lost();
  ++counters_.frames;
  return hal::Status::Ok();
}

// True for the last picture again, and for number 0, which GigE Vision reserves for tests.
bool GenicamCamera::IsNoPicture(const Session& session, ArvBuffer* buffer) const {
  return static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer)) == last_device_ns_ ||
         (session.counts_to_16_bits() && arv_buffer_get_frame_id(buffer) == 0);
}

// Mid-exposure, on the loop's clock.
std::int64_t GenicamCamera::StampOf(const Session& session, std::int64_t device_ns, std::int64_t arrival_ns) {
  const std::int64_t exposure_ns = session.exposure_ns();
  const std::int64_t to_middle_ns = config_.stamp_at == StampAt::kStart ? exposure_ns / 2
                                    : config_.stamp_at == StampAt::kEnd ? -exposure_ns / 2
                                                                        : 0;
  return (config_.device_time ? device_ns : HostTimeOf(session, device_ns, arrival_ns)) + to_middle_ns;
}

// By the camera's own clock if it can be read, else by the earliest arrivals. Strictly increasing.
std::int64_t GenicamCamera::HostTimeOf(const Session& session, std::int64_t device_ns,
                                       std::int64_t arrival_ns) {
  const std::int64_t by_arrivals_ns = mapper_.Map(device_ns, arrival_ns);
  const auto by_clock_ns = session.clock() != nullptr ? session.clock()->Map(device_ns) : std::nullopt;
  std::int64_t host_ns = by_arrivals_ns;
  if (by_clock_ns) {
    // If it is not, the clock that was read is not the one that stamps pictures.
    const bool plausible =
        *by_clock_ns < arrival_ns + kClockMarginNs && arrival_ns - *by_clock_ns < kOldestNs;
    counters_.clock_refused += plausible ? 0U : 1U;
    counters_.stamped_by_clock += plausible ? 1U : 0U;
    drift_ = plausible ? session.clock()->drift() : mapper_.drift();
    host_ns = plausible ? std::min(*by_clock_ns, arrival_ns) : by_arrivals_ns;
  } else {
    drift_ = mapper_.drift();
  }
  last_host_ns_ = std::max(host_ns, last_host_ns_ + 1);
  return last_host_ns_;
}

// Thread that opens a lost camera again.
void GenicamCamera::Look() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return closed_ || !session_; });
    if (closed_) {
      return;
    }
    lock.unlock();
    std::shared_ptr<Session> found;
    try {
      found = std::make_shared<Session>(config_);
    } catch (const camera::CameraError&) {  // not yet
    }
    lock.lock();
    if (found && found->width_px() == width_px_ && found->height_px() == height_px_) {
      session_ = std::move(found);
      came_back_ = true;
      ++reconnects_;
      changed_.notify_all();
    } else {
      changed_.wait_for(lock, kLookPeriod, [this] { return closed_; });
    }
  }
}

GenicamCounters GenicamCamera::counters() const {
  const std::lock_guard lock(mutex_);
  GenicamCounters counters = counters_;
  counters.reconnects = reconnects_;
  if (session_) {
    session_->AddPackets(counters);
  }
  return counters;
}

}  // namespace fovea::genicam
