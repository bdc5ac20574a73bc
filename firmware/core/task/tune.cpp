// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/task/tune.hpp"

#include <cmath>
#include <cstddef>

#include "firmware/core/trajectory/smooth_step.hpp"

namespace fovea::task {
namespace {

using config::Field;
using hal::TuningResult;

template <class State>
auto& RampOf(const Field& field, State& state) noexcept {
  return state.ramps[static_cast<std::size_t>(field.in_motion)];
}

// The gain that `value` of the key `field` stands for: 0 in servo.lambda_near means servo.lambda. A ramp from
// or to this 0 uses that gain, because the gain near the goal would otherwise fall to 0.
double InForce(const config::LawConfig& law, const double& field, double value) noexcept {
  return &field == &law.lambda_near && value == 0.0 ? law.lambda : value;
}

double ValueOn(const TuningState::Ramp& ramp, const config::LawConfig& law, const double& field) noexcept {
  if (ramp.ticks >= kRampTicks) {
    return ramp.to;
  }
  const double from = InForce(law, field, ramp.from);
  const double to = InForce(law, field, ramp.to);
  return from + (to - from) * trajectory::SmoothStep(static_cast<double>(ramp.ticks) / kRampTicks);
}

// True if the checks across keys hold with the requested value, all the way. Each key moves between its
// present value and its goal, so it is enough that they hold with the present values and with the goals of
// the others.
bool FitsTheOthers(const config::Tuning& request, const config::ServoConfig& config,
                   const TuningState& state) noexcept {
  config::PredictConfig now = config.predict;
  config::PredictConfig end = config.predict;
  config::LoadConfig load = config.load;
  config::EachTunable(load, [&](const Field& field, double& value, double, double) {
    value = field.in_motion == request.key ? request.value : value;
  });
  config::EachTunable(now, [&](const Field& field, double& value, double, double) {
    value = field.in_motion == request.key ? request.value : value;
  });
  config::EachTunable(end, [&](const Field& field, double& value, double, double) {
    const TuningState::Ramp& ramp = RampOf(field, state);
    value = field.in_motion == request.key ? request.value : ramp.asked ? ramp.to : value;
  });
  return config::IsStaleBeforeLost(now) && config::IsStaleBeforeLost(end) && config::IsPossible(load);
}

hal::TuningNote Answer(const config::Tuning& request, const config::ServoConfig& config,
                       const TuningState& state) noexcept {
  hal::TuningNote note{TuningResult::kUnknownKey, request.key, 0.0, request.value};
  config::EachTunable(config, [&](const Field& field, const double& value, double min, double max) {
    if (field.in_motion != request.key) {
      return;
    }
    note.before = value;
    if (!std::isfinite(request.value)) {
      note.result = TuningResult::kNotFinite;
    } else if (request.value < min || request.value > max) {
      note.result = TuningResult::kOutOfRange;
    } else if (!FitsTheOthers(request, config, state)) {
      note.result = TuningResult::kInconsistent;
    } else {
      note.result = TuningResult::kTaken;
    }
  });
  return note;
}

}  // namespace

void Tune(const config::Tuning& request, config::ServoConfig& config, TuningState& state) noexcept {
  state.active = request.IsAsked();
  state.note = request.IsAsked() ? Answer(request, config, state) : hal::TuningNote{};
  if (state.note.result == TuningResult::kTaken) {
    TuningState::Ramp& ramp = state.ramps[static_cast<std::size_t>(request.key)];
    // A repeated request does not begin the ramp again.
    if (!ramp.asked || ramp.to != request.value) {
      ramp = {true, state.note.before, request.value, 0};
    }
  }
  config::EachTunable(config, [&](const Field& field, double& value, double, double) {
    TuningState::Ramp& ramp = RampOf(field, state);
    if (ramp.asked && ramp.ticks < kRampTicks) {
      ++ramp.ticks;
      value = ValueOn(ramp, config.law, value);
      state.active = true;
    }
  });
}

void ApplyTunings(const TuningState& state, config::ServoConfig& config) noexcept {
  config::EachTunable(config, [&](const Field& field, double& value, double, double) {
    if (const TuningState::Ramp& ramp = RampOf(field, state); ramp.asked) {
      value = ValueOn(ramp, config.law, value);
    }
  });
}

}  // namespace fovea::task
