// SPDX-License-Identifier: Apache-2.0
// Selects the command to apply: the newest one, if it is newer than the last applied and not too late.
#pragma once

#include <cstdint>
#include <optional>

#include "fovea/franka/states.hpp"

namespace fovea::sim {

class CommandIntake {
 public:
  // A command may be `late_ms` [>= 0] states behind.
  explicit CommandIntake(int late_ms) : late_ms_(static_cast<std::uint64_t>(late_ms)) {}

  // A motion begins: discards all earlier commands.
  void Begin(std::uint64_t state_id) {
    applied_ = state_id;
    newest_.reset();
  }
  void Put(const franka::RobotCommand& command);
  // The command to apply after the state `state_id` was sent. Refuses commands that answer a later state.
  [[nodiscard]] std::optional<franka::RobotCommand> Take(std::uint64_t state_id);

  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  std::uint64_t late_ms_;
  std::uint64_t applied_ = 0;  // message id of the last applied command
  std::optional<franka::RobotCommand> newest_;
  std::uint64_t refused_ = 0;  // too late, or overtaken
};

}  // namespace fovea::sim
