// SPDX-License-Identifier: Apache-2.0
// The requests that every servo takes, simulated or on hardware: hold, track, recover, change a gain.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/task/servo_loop.hpp"
#include "firmware/host/desk/tuner.hpp"
#include "firmware/host/live/calls.hpp"
#include "firmware/host/live/catalogue.hpp"
#include "firmware/host/live/state.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::desk {

// What a desk tells its program.
struct DeskReports {
  // A request acts now: its name, and a sentence for a person. For the log. Not for parameters: the tick has
  // their changes.
  std::function<void(const std::string& what, const std::string& text)> touch;
  // The servo has answered a request for a parameter: its value is this now. For the server.
  std::function<void(std::size_t parameter, double value)> parameter;
};

// All functions from one thread: the one that takes the records.
class ServoDesk {
 public:
  // Borrows `loop`.
  ServoDesk(const config::ServoConfig& config, task::ServoLoop& loop, DeskReports reports);

  [[nodiscard]] live::Answer Take(const live::Hold& request);
  [[nodiscard]] live::Answer Take(const live::Track& request);
  [[nodiscard]] live::Answer Take(const live::Recover& request);
  [[nodiscard]] live::Answer Take(const live::SetParameter& request);

  // Call with each record of the servo.
  void Note(const hal::TickRecord& record);
  // Sets mode, reason, fault and notice.
  void Fill(live::State& state) const;
  [[nodiscard]] const Tuner& tuner() const { return tuner_; }

 private:
  task::ServoLoop& loop_;
  const DeskReports reports_;
  Tuner tuner_;
  hal::Mode mode_ = hal::Mode::kBoot;
  hal::HoldReason hold_reason_ = hal::HoldReason::kNone;
  hal::Fault fault_ = hal::Fault::kNone;
};

}  // namespace fovea::desk
