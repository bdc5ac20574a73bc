// SPDX-License-Identifier: Apache-2.0
#include "fovea/camera/latch_mapper.hpp"

#include <algorithm>
#include <cmath>

#include "fovea/camera/stamp.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::camera {
namespace {

constexpr std::int64_t kWorstTripNs = 5 * hal::kNsPerMs;
constexpr std::int64_t kMostOffNs = 20 * hal::kNsPerMs;      // a reading is off by half its trip at most
constexpr std::int64_t kBelievedNs = 2 * hal::kNsPerSecond;  // after a reading: 0.1 ms of error at 50 ppm
constexpr std::int64_t kBelievedWithDriftNs = 10 * hal::kNsPerSecond;
constexpr double kSurelyNs = 1e4;  // a round trip shorter than this [ns] gets no more weight

}  // namespace

void LatchMapper::Add(std::int64_t before_ns, std::int64_t device_ns, std::int64_t after_ns) {
  const std::int64_t trip_ns = after_ns - before_ns;
  if (trip_ns < 0 || trip_ns > kWorstTripNs || !IsStamp(device_ns)) {
    return;
  }
  if (IsTooLate(device_ns)) {
    best_.Forget();
  }
  best_.Add({device_ns, before_ns + trip_ns / 2 - device_ns, trip_ns}, line_, kMostOffNs, kMostOffNs);
  ++readings_;
  FitLine();
}

// Weighted least squares about the points' mean. Differences are exact, because they are taken in integers.
void LatchMapper::FitLine() {
  const Reading& newest = best_.all().back();
  const auto weight = [](const Reading& r) {
    const double trip = std::max(static_cast<double>(r.trip_ns), kSurelyNs);
    return 1.0 / (trip * trip);
  };
  double sum = 0.0;
  double x_mean = 0.0;
  double y_mean = 0.0;
  for (const Reading& r : best_.all()) {
    const double w = weight(r);
    sum += w;
    x_mean += w * static_cast<double>(r.device_ns - newest.device_ns);
    y_mean += w * static_cast<double>(r.excess_ns - newest.excess_ns);
  }
  x_mean /= sum;
  y_mean /= sum;
  double xx = 0.0;
  double xy = 0.0;
  for (const Reading& r : best_.all()) {
    const double w = weight(r);
    const double x = static_cast<double>(r.device_ns - newest.device_ns) - x_mean;
    const double y = static_cast<double>(r.excess_ns - newest.excess_ns) - y_mean;
    xx += w * x * x;
    xy += w * x * y;
  }
  line_ = {newest.device_ns + std::llround(x_mean), newest.excess_ns + std::llround(y_mean),
           best_.enough_for_drift() ? xy / xx : 0.0};
}

bool LatchMapper::IsTooLate(std::int64_t device_ns) const {
  return device_ns - best_.last_device_ns() > (best_.enough_for_drift() ? kBelievedWithDriftNs : kBelievedNs);
}

std::optional<std::int64_t> LatchMapper::Map(std::int64_t device_ns) const {
  if (best_.all().empty() || !IsStamp(device_ns) || IsTooLate(device_ns)) {
    return std::nullopt;
  }
  return device_ns + line_.At(device_ns);
}

}  // namespace fovea::camera
