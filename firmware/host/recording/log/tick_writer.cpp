// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/tick_writer.hpp"

#include <fmt/format.h>

#include <optional>

#include "firmware/core/model/rotation.hpp"
#include "firmware/host/recording/log/stamp.hpp"
#include "firmware/host/recording/log/tick_message.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "firmware/host/recording/log/transform_message.hpp"
#include "foxglove/log.pb.h"

namespace fovea::log {
namespace {

constexpr std::int64_t kTransformPeriodNs = 20 * hal::kNsPerMs;  // 50 Hz: enough for a viewer

}  // namespace

void TickWriter::Write(const hal::TickRecord& record, const ReplayData& data, LogFile& file) {
  ToMessage(record, tick_);
  ToMessage(data, tick_);
  file.Write(kTickTopic, record.stamp_ns, tick_);
  if (record.has_feature) {
    ToMessage(record.feature, feature_);
    file.Write(kFeatureTopic, record.stamp_ns, feature_);
  }
  WriteEvents(record, file);
  mode_ = record.mode;
  reason_ = record.hold_reason;
  is_first_ = false;
  if (record.stamp_ns >= next_transforms_ns_ && record.arm.num_joints == config_.arm.num_joints) {
    next_transforms_ns_ = record.stamp_ns + kTransformPeriodNs;
    WriteTransforms(record, file);
  }
}

void TickWriter::WriteEvents(const hal::TickRecord& record, LogFile& file) const {
  if (tick_.has_tuning()) {
    foxglove::Log line;
    SetStamp(record.stamp_ns, *line.mutable_timestamp());
    line.set_name("servo");
    const bool taken = record.tuning.result == hal::TuningResult::kTaken;
    line.set_level(taken ? foxglove::Log::INFO : foxglove::Log::WARNING);
    line.set_message(InWords(tick_.tuning()));
    file.Write(kEventTopic, record.stamp_ns, line);
  }
  if (const std::string text = InWords(tick_.way()); !text.empty()) {
    foxglove::Log line;
    SetStamp(record.stamp_ns, *line.mutable_timestamp());
    line.set_name("servo");
    const bool alone = record.way.event == hal::PlanEvent::kLate;
    line.set_level(alone ? foxglove::Log::WARNING : foxglove::Log::INFO);
    line.set_message(text);
    file.Write(kEventTopic, record.stamp_ns, line);
  }
  if (!is_first_ && record.mode == mode_ && record.hold_reason == reason_) {
    return;
  }
  foxglove::Log line;
  SetStamp(record.stamp_ns, *line.mutable_timestamp());
  line.set_name("servo");
  if (record.mode == hal::Mode::kFault) {
    line.set_level(foxglove::Log::ERROR);
    std::string text = fmt::format("fault: {}", hal::Name(record.fault));
    if (record.fault_joint >= 0) {
      text += fmt::format(", joint {}", record.fault_joint + 1);
    }
    if (*hal::Key(record.fault) != '\0') {
      text += fmt::format("; see {}", hal::Key(record.fault));
    }
    line.set_message(text);
  } else {
    const bool reasoned = record.hold_reason != hal::HoldReason::kNone;
    line.set_level(foxglove::Log::INFO);
    line.set_message(fmt::format("mode: {}{}{}", hal::Name(record.mode), reasoned ? ", " : "",
                                 reasoned ? hal::Name(record.hold_reason) : ""));
  }
  file.Write(kEventTopic, record.stamp_ns, line);
}

// Computes the poses of the frames from the arm's encoders.
void TickWriter::WriteTransforms(const hal::TickRecord& record, LogFile& file) {
  model::VecN q(record.arm.num_joints);
  for (int i = 0; i < record.arm.num_joints; ++i) {
    q[i] = record.arm.q[static_cast<std::size_t>(i)];
  }
  if (!q.allFinite()) {
    return;
  }
  std::optional<model::Pose> X_BO;
  if (record.target_known) {
    X_BO = model::Pose{model::Mat3::Identity(), {record.p_BO[0], record.p_BO[1], record.p_BO[2]}};
    static_cast<void>(model::RotationOfQuaternion(record.q_BO, X_BO->R));  // on error: R stays the identity
  }
  SetTransforms(record.stamp_ns, config_.arm, config_.frames, q, X_BO, transforms_);
  file.Write(kTransformTopic, record.stamp_ns, transforms_);
}

}  // namespace fovea::log
