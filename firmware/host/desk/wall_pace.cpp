// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/desk/wall_pace.hpp"

#include <cmath>

namespace fovea::desk {
namespace {

constexpr std::int64_t kMeasuredNs = 500'000'000;  // wall time over which achieved() is measured
constexpr std::int64_t kSampleNs = 20'000'000;

}  // namespace

void WallPace::SetSpeed(double speed) {
  speed_ = speed;
  anchored_ = false;
}

void WallPace::Pause() {
  paused_ = true;
  steps_ = 0;
}

void WallPace::Resume() {
  paused_ = false;
  steps_ = 0;
  anchored_ = false;
}

std::int64_t WallPace::WaitNs(std::int64_t next_ns, std::int64_t wall_ns) {
  if (paused()) {
    anchored_ = false;
    recent_.clear();
    return kPaused;
  }
  if (speed_ == kFree) {
    return 0;
  }
  if (!anchored_) {
    anchored_ = true;
    anchor_ = {next_ns, wall_ns};
    return 0;
  }
  const double due = static_cast<double>(next_ns - anchor_.virtual_ns) / speed_;
  const std::int64_t wait_ns = anchor_.wall_ns + std::llround(due) - wall_ns;
  if (wait_ns < -kMostBehindNs) {
    anchor_ = {next_ns, wall_ns};
    return 0;
  }
  return wait_ns;
}

void WallPace::Begin(std::int64_t next_ns, std::int64_t wall_ns) {
  if (paused_ && steps_ > 0) {
    --steps_;
  }
  if (recent_.empty() || wall_ns - recent_.back().wall_ns >= kSampleNs) {
    recent_.push_back({next_ns, wall_ns});
  }
  while (recent_.size() > 2 && wall_ns - recent_[1].wall_ns > kMeasuredNs) {
    recent_.pop_front();
  }
}

double WallPace::achieved() const {
  if (paused() || recent_.size() < 2 || recent_.back().wall_ns <= recent_.front().wall_ns) {
    return 0.0;
  }
  return static_cast<double>(recent_.back().virtual_ns - recent_.front().virtual_ns) /
         static_cast<double>(recent_.back().wall_ns - recent_.front().wall_ns);
}

}  // namespace fovea::desk
