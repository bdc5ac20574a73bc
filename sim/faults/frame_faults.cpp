// SPDX-License-Identifier: Apache-2.0
#include "sim/faults/frame_faults.hpp"

#include <algorithm>
#include <iterator>

#include "sim/faults/chance.hpp"

namespace fovea::sim {
namespace {

constexpr std::int64_t kKeptNs = 60'000'000'000;  // age of the scenes that a replay may show, at least

}  // namespace

// Within the replay's window: the newest scene that is at least `delay_ns` old. Otherwise `exposure` itself.
// The past is always kept: a replay may be switched on at any time, with any delay.
const Exposure& FrameSpoiler::SceneFor(const Exposure& exposure) {
  const auto& replay = faults_.replay;
  past_.push_back(exposure);
  const std::int64_t kept_ns = std::max(replay.delay_ns, kKeptNs);
  while (past_.size() > 1 && past_[1].stamp_ns <= exposure.stamp_ns - kept_ns) {
    past_.pop_front();
  }
  if (!replay.window.Contains(exposure.stamp_ns)) {
    return exposure;
  }
  const auto newer = std::upper_bound(
      past_.begin(), past_.end(), exposure.stamp_ns - replay.delay_ns,
      [](std::int64_t stamp_ns, const Exposure& scene) { return stamp_ns < scene.stamp_ns; });
  return newer == past_.begin() ? past_.front() : *std::prev(newer);
}

void FrameSpoiler::SetFaults(const FrameFaults& faults) {
  const std::uint64_t seed = faults_.seed;
  faults_ = faults;
  faults_.seed = seed;
}

std::optional<Exposure> FrameSpoiler::Spoil(const Exposure& exposure) {
  Exposure taken = SceneFor(exposure);
  if (faults_.loss.window.Contains(exposure.stamp_ns) &&
      Chance(faults_.seed, exposure.sequence) < faults_.loss.share) {
    return std::nullopt;
  }
  if (faults_.freeze.Contains(exposure.stamp_ns)) {
    if (!frozen_) {
      frozen_ = taken;
      frozen_->sequence = exposure.sequence;
      frozen_->stamp_ns = exposure.stamp_ns;
    }
    taken = *frozen_;
    if (faults_.freeze_pixels) {
      taken.pixels_of = PixelSource{frozen_->sequence, frozen_->stamp_ns};
    }
  } else {
    frozen_.reset();
  }
  taken.sequence = exposure.sequence;
  taken.stamp_ns = exposure.stamp_ns;
  taken.stamp_error_ns = faults_.stamp.window.Contains(exposure.stamp_ns) ? faults_.stamp.by_ns : 0;
  return taken;
}

std::int64_t FrameSpoiler::DelayNs(std::int64_t stamp_ns) const {
  return faults_.late.window.Contains(stamp_ns) ? faults_.late.by_ns : 0;
}

}  // namespace fovea::sim
