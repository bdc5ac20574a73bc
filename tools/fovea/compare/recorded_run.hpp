// SPDX-License-Identifier: Apache-2.0
// What fovea compare reads of a log: only what a robot's log has too, never /truth.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "firmware/core/model/arm_model.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::compare {

struct RecordedRun {
  std::map<std::string, std::string> keys;  // of its configuration
  std::vector<std::string> joints;          // names, base to tip
  std::vector<bool> slides;                 // whether each joint is prismatic
  bool has_arm = false;                     // the servo's configuration is in the log
  model::ArmModel arm;                      // as the servo believed it, if has_arm
  std::int64_t start_ns = 0;                // stamp of the first state
  hal::JointArray q_first{};                // its joint positions
};

// Reads all of the log but its motion. config::InputError: it is cut off, is that of a theory run, or holds
// no states of an arm. std::runtime_error, naming the file: it cannot be read.
RecordedRun ReadRun(const std::filesystem::path& log);

// Calls `take` with each tick's record, in order.
void ReadMotion(const std::filesystem::path& log, const std::function<void(const hal::TickRecord&)>& take);

}  // namespace fovea::compare
