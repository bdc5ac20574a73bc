// SPDX-License-Identifier: Apache-2.0
#include "fovea/camera/stamp_mapper.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "fovea/camera/stamp.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::camera {
namespace {

// A picture that arrives this much sooner than ever before means that the clock was set.
constexpr std::int64_t kMostEarlyNs = 20 * hal::kNsPerMs;
constexpr std::int64_t kMostLateNs = hal::kNsPerSecond;
// One picture may be this late. If all of a second are, the clock was set back.
constexpr std::int64_t kLateNs = 20 * hal::kNsPerMs;
constexpr std::size_t kLatePictures = 8;

}  // namespace

std::int64_t StampMapper::Map(std::int64_t device_ns, std::int64_t arrival_ns) {
  if (!IsStamp(device_ns)) {
    last_host_ns_ = std::max(arrival_ns - transport_ns_, last_host_ns_ + 1);
    return last_host_ns_;
  }
  const Point point{device_ns, arrival_ns - device_ns};
  LookForClockSetBack(point);
  best_.Add(point, line_, kMostEarlyNs, kMostLateNs);
  FitLine();
  const std::int64_t host_ns = device_ns + line_.At(device_ns) - transport_ns_;
  last_host_ns_ = std::max(std::min(host_ns, arrival_ns), last_host_ns_ + 1);
  return last_host_ns_;
}

void StampMapper::Restart() {
  best_.Forget();
  late_ = {};
  line_.drift = 0.0;
}

// Uses the line before this point. The least late of the late pictures gives the clock's new offset.
void StampMapper::LookForClockSetBack(const Point& point) {
  if (best_.all().empty() || point.excess_ns <= line_.At(point.device_ns) + kLateNs) {
    late_ = {};
    return;
  }
  if (late_.count == 0) {
    late_ = {0, point.device_ns, point};
  }
  ++late_.count;
  if (point.excess_ns < late_.least.excess_ns) {
    late_.least = point;
  }
  if (late_.count >= kLatePictures && point.device_ns - late_.since_ns >= hal::kNsPerSecond) {
    best_.StartAnew();
    best_.Add(late_.least, line_, kMostEarlyNs, kMostLateNs);
    line_ = {late_.least.device_ns, late_.least.excess_ns, 0.0};
  }
}

// Takes the edge of the lower hull at the middle of the known time: of all lines below the points, it has the
// least sum of distances to them.
void StampMapper::FitLine() {
  const std::span<const Point> points = best_.all();
  if (!best_.enough_for_drift()) {
    const Point& least = *std::min_element(points.begin(), points.end(), [](const Point& a, const Point& b) {
      return a.excess_ns < b.excess_ns;
    });
    line_ = {least.device_ns, least.excess_ns, 0.0};
    return;
  }
  const auto slope = [](const Point& a, const Point& b) {
    return static_cast<double>(b.excess_ns - a.excess_ns) / static_cast<double>(b.device_ns - a.device_ns);
  };
  const std::int64_t middle_ns =
      points.front().device_ns + (points.back().device_ns - points.front().device_ns) / 2;
  std::size_t corner = 0;
  while (true) {
    std::size_t next = points.size() - 1;
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = corner + 1; i < points.size(); ++i) {
      if (const double s = slope(points[corner], points[i]); s <= least) {
        least = s;
        next = i;
      }
    }
    if (points[next].device_ns >= middle_ns) {
      line_ = {points[corner].device_ns, points[corner].excess_ns, least};
      return;
    }
    corner = next;
  }
}

}  // namespace fovea::camera
