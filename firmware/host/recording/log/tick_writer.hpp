// SPDX-License-Identifier: Apache-2.0
// Converts the servo's records to messages: the records, the measurements that they took, modes and faults as
// text, and the poses of all frames.
#pragma once

#include "firmware/host/recording/log/log_file.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "fovea/tick.pb.h"
#include "foxglove/geometry.pb.h"

namespace fovea::log {

class TickWriter {
 public:
  explicit TickWriter(const RunLogConfig& config) : config_(config) {}

  // Call with every record, in order.
  void Write(const hal::TickRecord& record, const ReplayData& data, LogFile& file);

 private:
  void WriteEvents(const hal::TickRecord& record, LogFile& file) const;
  void WriteTransforms(const hal::TickRecord& record, LogFile& file);

  const RunLogConfig& config_;
  Tick tick_;  // reused for each record
  Feature feature_;
  foxglove::FrameTransforms transforms_;
  hal::Mode mode_ = hal::Mode::kBoot;
  hal::HoldReason reason_ = hal::HoldReason::kNone;
  bool is_first_ = true;
  std::int64_t next_transforms_ns_ = 0;
};

}  // namespace fovea::log
