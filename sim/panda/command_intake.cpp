// SPDX-License-Identifier: Apache-2.0
#include "sim/panda/command_intake.hpp"

namespace fovea::sim {

void CommandIntake::Put(const franka::RobotCommand& command) {
  const std::uint64_t floor = newest_ ? newest_->message_id : applied_;
  if (command.message_id <= floor) {
    ++refused_;
    return;
  }
  refused_ += newest_ ? 1U : 0U;  // the older one was overtaken
  newest_ = command;
}

std::optional<franka::RobotCommand> CommandIntake::Take(std::uint64_t state_id) {
  if (!newest_) {
    return std::nullopt;
  }
  const franka::RobotCommand command = *newest_;
  newest_.reset();
  if (command.message_id > state_id || command.message_id + late_ms_ < state_id) {
    ++refused_;
    return std::nullopt;
  }
  applied_ = command.message_id;
  return command;
}

}  // namespace fovea::sim
