// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/desk/tuner.hpp"

#include <fmt/format.h>

#include "firmware/core/config/tuning.hpp"

namespace fovea::desk {

Tuner::Tuner(const config::ServoConfig& config) {
  config::EachTunable(config, [this](const config::Field& field, double value, double min, double max) {
    numbers_.push_back(field.in_motion);
    parameters_.push_back({field.key, field.unit, field.meaning, min, max, value, value});
  });
}

live::Answer Tuner::Ask(std::size_t parameter, double value, task::ServoLoop& loop) {
  static_cast<void>(loop.Ask(config::Tuning{numbers_.at(parameter), value}));
  return {};
}

std::optional<std::size_t> Tuner::Note(const hal::TuningNote& note) {
  if (note.result == hal::TuningResult::kNone) {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    if (numbers_[i] != note.key) {
      continue;
    }
    live::Parameter& parameter = parameters_[i];
    const bool is_taken = note.result == hal::TuningResult::kTaken;
    notice_ = is_taken ? ""
                       : fmt::format("{} = {:g} was refused: {}", parameter.name, note.asked,
                                     hal::Words(note.result));
    parameter.value = is_taken ? note.asked : parameter.value;
    return i;
  }
  return std::nullopt;
}

std::map<std::string, double> Tuner::Changed() const {
  std::map<std::string, double> changed;
  for (const live::Parameter& parameter : parameters_) {
    if (parameter.value != parameter.default_value) {
      changed[parameter.name] = parameter.value;
    }
  }
  return changed;
}

}  // namespace fovea::desk
