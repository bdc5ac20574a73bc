// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/contact/recording.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/estimate/push.hpp"
#include "firmware/host/recording/flight/log_ticks.hpp"
#include "firmware/host/recording/flight/messages.hpp"
#include "firmware/host/recording/log/tick_message.hpp"
#include "fovea/tick.pb.h"

namespace fovea::contact {
namespace {

constexpr double kMoves = 0.01;  // [rad/s, m/s]

WatchedTick Judge(const model::ArmModel& arm, double sudden_weight, const hal::TickRecord& record,
                  estimate::PushWatch& watch) {
  const int n = arm.num_joints;
  const model::VecN tau_ext = model::ToVector(record.tau_ext, n);
  estimate::WatchPush(tau_ext, watch);
  WatchedTick tick;
  tick.t_s = 1e-9 * static_cast<double>(record.stamp_ns);
  for (int i = 0; i < n; ++i) {
    const estimate::PushShares shares = estimate::SharesOf(arm, tau_ext, watch, i);
    tick.share[0] = std::max(tick.share[0], shares.total);
    tick.share[1] = std::max(tick.share[1], shares.sudden);
    tick.moves = tick.moves || std::fabs(record.arm.dq[static_cast<std::size_t>(i)]) > kMoves;
  }
  tick.share[2] = std::max(tick.share[0], sudden_weight * tick.share[1]);
  tick.q.assign(record.arm.q.begin(), record.arm.q.begin() + n);
  return tick;
}

}  // namespace

const char* Name(Detector detector) {
  constexpr const char* kNames[]{"total", "sudden", "both"};
  return kNames[static_cast<std::size_t>(detector)];
}

double SuddenWeight(const config::SafetyConfig& safety) {
  return safety.contact_torque_fraction / safety.contact_sudden_fraction;
}

Recording ReadRecording(const std::filesystem::path& log_or_folder, double sudden_weight) {
  Recording recording;
  std::optional<config::ServoConfig> config;
  estimate::PushWatch watch;
  flight::TickVisitor visitor;
  visitor.on_configuration = [&](const log::ServoConfiguration& message) {
    config = flight::FromMessage(message);
  };
  visitor.on_tick = [&](const log::Tick& message, const hal::FeatureMeasurement& feature) {
    if (!config || !recording.fault.empty()) {
      return;
    }
    const hal::TickRecord record = log::FromMessage(message, feature);
    // The tick of the fault was still checked.
    recording.ticks.push_back(Judge(config->arm, sudden_weight, record, watch));
    if (record.mode == hal::Mode::kFault) {
      recording.fault = hal::Name(record.fault);
      recording.fault_s = recording.ticks.back().t_s;
    }
  };
  flight::ReadTicks(flight::LogIn(log_or_folder), visitor);
  return recording;
}

}  // namespace fovea::contact
