// SPDX-License-Identifier: Apache-2.0
#include "device_clock.hpp"

#include <array>
#include <chrono>

#include "fovea/camera/stamp.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"

namespace fovea::genicam {
namespace {

constexpr int kQuick = 8;  // readings at the beginning, for the first pictures
constexpr std::chrono::milliseconds kQuickPeriod{20};
constexpr std::chrono::milliseconds kPeriod{250};
constexpr int kMostFailures = 5;  // in a row; then it stops

}  // namespace

std::optional<DeviceClock::Features> DeviceClock::FeaturesOf(ArvDevice* device) {
  constexpr std::array<Features, 2> kKnown{{{"TimestampLatch", "TimestampLatchValue", false},
                                            {"GevTimestampControlLatch", "GevTimestampValue", true}}};
  for (const Features& features : kKnown) {
    if (arv_device_is_feature_available(device, features.latch, nullptr) != FALSE &&
        arv_device_is_feature_available(device, features.value, nullptr) != FALSE) {
      return features;
    }
  }
  return std::nullopt;
}

DeviceClock::DeviceClock(ArvDevice* device) : device_(device), features_(FeaturesOf(device)) {
  if (!features_) {
    return;
  }
  if (features_->in_ticks) {
    constexpr double kNsPerS = 1e9;
    const guint64 ticks_hz = ARV_IS_GV_DEVICE(device) != FALSE
                                 ? arv_gv_device_get_timestamp_tick_frequency(ARV_GV_DEVICE(device), nullptr)
                                 : 0;
    if (ticks_hz == 0) {
      return;
    }
    ns_per_tick_ = kNsPerS / static_cast<double>(ticks_hz);
  }
  thread_ = std::thread([this] { Run(); });
}

DeviceClock::~DeviceClock() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  closing_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void DeviceClock::Run() {
  int failures = 0;
  for (int k = 0; failures < kMostFailures; ++k) {
    failures = Ask() ? 0 : failures + 1;
    std::unique_lock lock(mutex_);
    if (closing_.wait_for(lock, k < kQuick ? kQuickPeriod : kPeriod, [this] { return closed_; })) {
      return;
    }
  }
}

// Takes one reading. False if the camera did not answer, or the value is not a stamp.
bool DeviceClock::Ask() {
  GError* error = nullptr;
  const std::int64_t before_ns = linux_rt::MonotonicNs();
  arv_device_execute_command(device_, features_->latch, &error);
  const std::int64_t after_ns = linux_rt::MonotonicNs();
  gint64 value = 0;
  if (error == nullptr) {
    value = arv_device_get_integer_feature_value(device_, features_->value, &error);
  }
  if (error != nullptr) {
    g_error_free(error);
    return false;
  }
  const auto device_ns = camera::StampOfTicks(value, ns_per_tick_);
  if (!device_ns) {
    return false;
  }
  const std::lock_guard lock(mutex_);
  mapper_.Add(before_ns, *device_ns, after_ns);
  return true;
}

std::optional<std::int64_t> DeviceClock::Map(std::int64_t device_ns) const {
  const std::lock_guard lock(mutex_);
  return mapper_.Map(device_ns);
}

double DeviceClock::drift() const {
  const std::lock_guard lock(mutex_);
  return mapper_.drift();
}

}  // namespace fovea::genicam
