// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/learner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fovea::beliefs {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

// The value to ask for, in the belief's unit. `present`: in force.
double Corrected(const Belief& belief, double present) {
  Belief rest = belief;
  rest.difference -= present;
  if (!rest.IsWrong()) {
    return present;
  }
  const double doubt = 3.0 * rest.sigma / rest.difference;
  return present + rest.difference * (1.0 - doubt * doubt);
}

}  // namespace

Learner::Learner(const config::ServoConfig& config, const Learns& learns) {
  config::EachTunable(config, [&](const config::Field& field, double value, double min, double max) {
    if (field.in_motion == config::kStampOffsetKey && learns.latency) {
      quantities_.push_back(
          {"latency", "latency", field.key, field.unit, field.in_motion, 1e-3, min, max, value, kNothing});
    } else if (field.in_motion == config::kLoadOffsetKey && learns.payload) {
      quantities_.push_back({"payload", "load", field.key, field.unit, field.in_motion, 1.0,
                             std::max(min, -config.load.mass), max, value, kNothing});
    }
  });
}

std::vector<config::Tuning> Learner::Decide(const Findings& findings) {
  std::vector<config::Tuning> requests;
  if (!may_learn_) {
    return requests;
  }
  for (Quantity& quantity : quantities_) {
    const auto belief = std::find_if(findings.beliefs.begin(), findings.beliefs.end(),
                                     [&](const Belief& b) { return b.name == quantity.belief; });
    if (belief == findings.beliefs.end()) {
      continue;
    }
    const double value =
        std::clamp(quantity.per_unit * Corrected(*belief, quantity.in_force / quantity.per_unit),
                   quantity.min, quantity.max);
    if (std::isfinite(value) && value != quantity.in_force) {
      quantity.asked = value;
      requests.push_back({quantity.number, value});
    }
  }
  return requests;
}

void Learner::Note(const hal::TickRecord& record) {
  const bool doubts = record.mode == hal::Mode::kHold && record.hold_reason == hal::HoldReason::kEyeDoubted;
  may_learn_ = record.mode != hal::Mode::kFault && !doubts && !record.command.engage_brakes;
  const hal::TuningNote& note = record.tuning;
  if (note.result != hal::TuningResult::kTaken) {
    return;
  }
  for (Quantity& quantity : quantities_) {
    if (quantity.number != note.key) {
      continue;
    }
    if (note.asked == quantity.asked) {
      const double t_s = hal::ToSeconds(record.stamp_ns);
      corrections_.push_back({t_s, quantity.name, quantity.key, quantity.unit, note.before, note.asked,
                              fmt::format("{}: {} = {:.4g} {} since {:.3f} s, {:.4g} before", quantity.name,
                                          quantity.key, note.asked, quantity.unit, t_s, note.before)});
      quantity.asked = kNothing;
    }
    quantity.in_force = note.asked;
  }
}

}  // namespace fovea::beliefs
