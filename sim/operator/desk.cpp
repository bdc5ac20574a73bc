// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/desk.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "firmware/host/config/input_error.hpp"
#include "sim/operator/saved_scenario.hpp"

namespace fovea::sim {

OperatorDesk::OperatorDesk(const DeskParts& parts, double speed)
    : parts_(parts),
      pace_(speed),
      hands_(parts.about, parts.world, parts.reports.touch),
      faults_(parts.about),
      servo_(parts.about.servo, parts.loop, parts.reports) {}

live::Catalogue OperatorDesk::Offer(const RunDescription& about) {
  using live::Service;
  live::Catalogue offer;
  offer.name = about.scenario.name;
  offer.parameters = desk::Tuner(about.servo).parameters();
  offer.tune = true;
  offer.faults = FaultDesk(about).Kinds();
  offer.services = {Service::kHold,   Service::kTrack,      Service::kRecover,   Service::kPause,
                    Service::kStep,   Service::kSpeed,      Service::kReset,     Service::kSave,
                    Service::kEnd,    Service::kStartFault, Service::kStopFault, Service::kPull,
                    Service::kRelease};
  offer.target = about.scene.has_eye;
  if (offer.target) {
    offer.services.push_back(Service::kThrow);
  }
  return offer;
}

live::Answer OperatorDesk::Do(const live::Call& call) {
  if (end_ != LiveEnd::kNone && !std::holds_alternative<live::End>(call.request)) {
    return {"the run is ending", "{}"};
  }
  try {
    return std::visit([this](const auto& request) { return Take(request); }, call.request);
  } catch (const config::InputError& error) {
    return {error.what(), "{}"};
  }
}

live::Answer OperatorDesk::Take(const live::Pause& request) {
  if (request.paused) {
    pace_.Pause();
  } else {
    pace_.Resume();
  }
  return {};
}

live::Answer OperatorDesk::Take(const live::Step& request) {
  if (!pace_.paused()) {
    return {"the run is not paused", "{}"};
  }
  pace_.Step(request.ticks);
  return {};
}

live::Answer OperatorDesk::Take(const live::Speed& request) {
  pace_.SetSpeed(request.factor);
  return {};
}

live::Answer OperatorDesk::Take(const live::Reset& /*request*/) {
  end_ = LiveEnd::kReset;
  return {};
}

live::Answer OperatorDesk::Take(const live::End& /*request*/) {
  end_ = LiveEnd::kEnd;
  return {};
}

live::Answer OperatorDesk::Take(const live::Save& /*request*/) {
  PresentState present;
  present.truth = parts_.world.truth();
  const Eigen::Isometry3d X_BO = hands_.Look(pace_.paused()).X_BO;
  present.truth.p_BO = X_BO.translation();
  present.truth.R_BO = X_BO.linear();
  present.target_touched = hands_.target_touched();
  present.tuned = servo_.tuner().Changed();
  present.faults = faults_.faults();
  const std::string name = std::filesystem::path(parts_.about.scenario.name).filename().string();
  const nlohmann::json answer{{"name", fmt::format("{}-at-{:.3f}s.toml", name, now_s())},
                              {"toml", SaveScenario(parts_.about, present)}};
  return {"", answer.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace)};
}

live::Answer OperatorDesk::Take(const live::StartFault& request) {
  const std::string text = faults_.Start(request, now_ns());
  PassFaults();
  parts_.reports.touch("fault", text);
  return {};
}

live::Answer OperatorDesk::Take(const live::StopFault& request) {
  const std::string text = faults_.Stop(request, now_ns());
  PassFaults();
  parts_.reports.touch("fault", text);
  return {};
}

void OperatorDesk::PassFaults() {
  const FaultSettings& faults = faults_.faults();
  parts_.world.SetFaults(faults.bench);
  parts_.arm.SetFaults(faults.arm);
  parts_.clock.SetFault(faults.stall);
  parts_.vision.SetFaults(faults);
  parts_.planner.SetFaults(faults.planner);
}

void OperatorDesk::Note(const hal::TickRecord& record) { servo_.Note(record); }

live::State OperatorDesk::State() const {
  live::State state;
  state.stamp_s = now_s();
  servo_.Fill(state);
  state.paused = pace_.paused();
  state.speed = pace_.speed();
  state.real_time_factor = pace_.achieved();
  state.ends = end_ == LiveEnd::kEnd;
  faults_.Fill(now_ns(), state);
  Fill(parts_.about, hands_.Look(pace_.paused()), state);
  return state;
}

}  // namespace fovea::sim
