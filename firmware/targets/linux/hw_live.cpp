// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/hw_live.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"

namespace fovea::hw {
namespace {

constexpr const char* kSpeedScale = "robot.speed_scale";
constexpr double kLeastSpeedScale = 0.01;

live::Catalogue OfferOf(const std::string& name, std::vector<live::Parameter> parameters, double speed_scale,
                        bool has_camera, bool control) {
  using live::Service;
  live::Catalogue offer;
  offer.name = name;
  offer.channels = live::LogChannels({.camera = has_camera});
  offer.parameters = std::move(parameters);
  offer.parameters.push_back(
      {kSpeedScale, "", "scales servo.lambda and servo.lambda_near of the configuration; the limits stay",
       std::min(kLeastSpeedScale, speed_scale), speed_scale, speed_scale, speed_scale});
  offer.tune = control;
  offer.services = {Service::kHold, Service::kEnd};
  if (control) {
    offer.services.push_back(Service::kTrack);
    offer.services.push_back(Service::kRecover);
  }
  return offer;
}

}  // namespace

HwLive::HwLive(HwLiveOptions options, const std::string& name, const config::ServoConfig& servo,
               bool has_camera, double speed_scale)
    : servo_(servo), speed_scale_(speed_scale), parameters_(desk::Tuner(servo).parameters()) {
  const live::Catalogue offer = OfferOf(name, parameters_, speed_scale, has_camera, options.control);
  server_ = std::make_unique<live::Server>(std::move(options.server), offer);
  feed_ = std::make_unique<live::LiveFeed>(*server_, offer.channels);
}

void HwLive::Begin(run::RunShell& shell, RunControl& control, bool allow_motion, const hal::Clock& clock,
                   std::function<void(const Heard& heard)> heard) {
  parts_.emplace(Parts{shell, control, allow_motion, clock, std::move(heard)});
  desk::DeskReports reports;
  reports.touch = [this](const std::string& what, const std::string& text) { Touch(what, text); };
  reports.parameter = [this](std::size_t parameter, double value) {
    server_->SetParameter(parameter, value);
  };
  desk_.emplace(servo_, *control.loop.load(), std::move(reports));
}

void HwLive::Note(const hal::TickRecord& record) {
  begin_ns_ = begin_ns_ == 0 ? record.stamp_ns : begin_ns_;
  now_ns_ = record.stamp_ns;
  if (desk_) {
    desk_->Note(record);
  }
}

void HwLive::Attend() {
  server_->TakeCalls([this](const live::Call& call) { return Do(call); });
  live::State state;
  state.stamp_s = static_cast<double>(now_ns_ - begin_ns_) * 1e-9;
  if (desk_) {
    desk_->Fill(state);
  }
  if (const auto ticks = parts_ ? parts_->shell.NewTickDurations() : std::nullopt) {
    state.tick = {ticks->median_ns, ticks->max_ns};
  }
  state.ends = parts_ && parts_->control.ended;
  server_->SetState(state);
}

live::Answer HwLive::Do(const live::Call& call) {
  if (!desk_) {
    return {"there is no connection to the robot yet", "{}"};
  }
  return std::visit([this](const auto& request) { return Take(request); }, call.request);
}

// The catalogue does not offer these; the end of a viewer's control needs nothing.
template <class Request>
live::Answer HwLive::Take(const Request& /*request*/) {
  return {};
}

live::Answer HwLive::Take(const live::Hold& request) {
  static_cast<void>(desk_->Take(request));
  return Say(Word::kHold);
}

live::Answer HwLive::Take(const live::Track& request) {
  if (!parts_->control.serves) {
    return {"motion is not enabled; type \"enable\" at the program", "{}"};
  }
  static_cast<void>(desk_->Take(request));
  return Say(Word::kTrack);
}

live::Answer HwLive::Take(const live::Recover& /*request*/) {
  if (ArmDriver* arm = parts_->control.arm) {
    arm->AskRecovery();
  }
  Touch("recover", "recover the robot");
  return Say(Word::kRecover);
}

live::Answer HwLive::Take(const live::End& /*request*/) {
  Touch("end", "end the run");
  EndRun(parts_->allow_motion, parts_->control);
  return Say(Word::kEnd);
}

live::Answer HwLive::Take(const live::SetParameter& request) {
  if (request.parameter == parameters_.size()) {
    SetSpeedScale(request.value);
    return {};
  }
  return desk_->Take(request);
}

// The gains that robot.speed_scale scales at the start. The tick's record has their changes.
void HwLive::SetSpeedScale(double scale) {
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const live::Parameter& gain = parameters_[i];
    if (gain.name == "servo.lambda" || gain.name == "servo.lambda_near") {
      static_cast<void>(desk_->Take(live::SetParameter{i, gain.value * scale / speed_scale_}));
    }
  }
  server_->SetParameter(parameters_.size(), scale);
  Touch("speed", fmt::format("{} = {:g}", kSpeedScale, scale));
}

live::Answer HwLive::Say(Word word) {
  parts_->heard({parts_->clock.NowNs(), word, {}});
  return {};
}

void HwLive::Touch(const std::string& what, const std::string& text) {
  if (run::RunBook* book = parts_->shell.book()) {
    log::Touch touch;
    touch.set_stamp_ns(now_ns_);
    touch.set_what(what);
    touch.set_text(text);
    book->log().Add(log::kOperatorTopic, now_ns_, touch);
  }
}

}  // namespace fovea::hw
