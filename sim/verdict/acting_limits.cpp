// SPDX-License-Identifier: Apache-2.0
#include "sim/verdict/acting_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace fovea::sim {
namespace {

constexpr double kNamedPercent = 5.0;

}  // namespace

void ActingLimits::Add(const hal::TickRecord& record) {
  if (record.mode != hal::Mode::kTrack && record.mode != hal::Mode::kCoast &&
      record.mode != hal::Mode::kMove) {
    return;
  }
  ++motion_ticks_;
  for (std::size_t i = 0; i < limit_ticks_.size(); ++i) {
    limit_ticks_[i] += (record.limits_active & hal::Bit(static_cast<hal::Limit>(i))) != 0 ? 1U : 0U;
  }
}

std::string ActingLimits::InWords() const {
  std::vector<std::pair<std::uint64_t, hal::Limit>> acted;
  for (std::size_t i = 0; i < limit_ticks_.size(); ++i) {
    if (limit_ticks_[i] > 0) {
      acted.emplace_back(limit_ticks_[i], static_cast<hal::Limit>(i));
    }
  }
  std::stable_sort(acted.begin(), acted.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string words;
  for (const auto& [ticks, limit] : acted) {
    const double percent = 100.0 * static_cast<double>(ticks) / static_cast<double>(motion_ticks_);
    if (percent >= kNamedPercent) {
      words += fmt::format("{} {} ({}) in {:.0f} %", words.empty() ? "; limited by" : ",", hal::Name(limit),
                           KeysOf(limit), percent);
    }
  }
  return words.empty() ? words : words + " of its motion";
}

std::string ActingLimits::KeysOfReach() const {
  return std::string("target.position, servo.goal, safety.workspace_radius") +
         (has_boxes_ ? ", safety.boxes" : "");
}

std::string ActingLimits::KeysOf(hal::Limit limit) const {
  const std::string key = hal::Key(limit);
  if (!has_boxes_) {
    return key;
  }
  return limit == hal::Limit::kObstacle      ? key + ", safety.boxes"
         : limit == hal::Limit::kFieldOfView ? key + ", safety.sight_clearance, safety.boxes"
                                             : key;
}

}  // namespace fovea::sim
