// SPDX-License-Identifier: Apache-2.0
// The keys of the servo that may change in motion, as an operator's parameters.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/task/servo_loop.hpp"
#include "firmware/host/live/calls.hpp"
#include "firmware/host/live/catalogue.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::desk {

class Tuner {
 public:
  explicit Tuner(const config::ServoConfig& config);

  // In the order of the servo's list, with their present values; the default is the run's own value.
  [[nodiscard]] const std::vector<live::Parameter>& parameters() const { return parameters_; }
  // Asks the loop to change a parameter. The servo answers in a later record.
  [[nodiscard]] live::Answer Ask(std::size_t parameter, double value, task::ServoLoop& loop);
  // Takes the servo's answer, if there is one. Returns the parameter that it is about.
  std::optional<std::size_t> Note(const hal::TuningNote& note);

  // The parameters that were changed, with their present values, by key.
  [[nodiscard]] std::map<std::string, double> Changed() const;
  // What the servo refused last, in words; "" if it took the last request.
  [[nodiscard]] const std::string& notice() const { return notice_; }

 private:
  std::vector<live::Parameter> parameters_;
  std::vector<int> numbers_;  // in config::Tuning, of each
  std::string notice_;
};

}  // namespace fovea::desk
