// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/joint_track.hpp"

#include <algorithm>
#include <iterator>

namespace fovea::beliefs {
namespace {

constexpr std::int64_t kHalfNs = 5'000'000;  // of the time over which the velocity is a mean

}  // namespace

void JointTrack::Add(std::int64_t stamp_ns, const model::VecN& q) {
  if (!readings_.empty() && stamp_ns <= readings_.back().stamp_ns) {
    return;
  }
  readings_.push_back({stamp_ns, q});
  while (readings_.front().stamp_ns < stamp_ns - kKeptNs) {
    readings_.pop_front();
  }
}

model::VecN JointTrack::Interpolated(std::int64_t stamp_ns) const {
  const auto after =
      std::lower_bound(readings_.begin(), readings_.end(), stamp_ns,
                       [](const Reading& reading, std::int64_t stamp) { return reading.stamp_ns < stamp; });
  if (after == readings_.begin()) {
    return after->q;
  }
  const auto before = std::prev(after);
  const double share = static_cast<double>(stamp_ns - before->stamp_ns) /
                       static_cast<double>(after->stamp_ns - before->stamp_ns);
  return before->q + share * (after->q - before->q);
}

bool JointTrack::At(std::int64_t stamp_ns, JointMotion& motion) const {
  if (readings_.empty() || stamp_ns - kHalfNs < readings_.front().stamp_ns ||
      stamp_ns + kHalfNs > readings_.back().stamp_ns) {
    return false;
  }
  motion.q = Interpolated(stamp_ns);
  motion.dq =
      (Interpolated(stamp_ns + kHalfNs) - Interpolated(stamp_ns - kHalfNs)) / hal::ToSeconds(2 * kHalfNs);
  return true;
}

}  // namespace fovea::beliefs
