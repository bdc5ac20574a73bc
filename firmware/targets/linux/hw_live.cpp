// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/hw_live.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "firmware/host/desk/found.hpp"
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
      {kSpeedScale, "", "share of the speed: bounds servo.lambda and servo.lambda_near; the limits stay",
       std::min(kLeastSpeedScale, speed_scale), speed_scale, speed_scale, speed_scale});
  offer.tune = control;
  offer.services = {Service::kHold, Service::kEnd};
  offer.anyone_may_end = true;
  if (control) {
    offer.services.push_back(Service::kTrack);
    offer.services.push_back(Service::kRecover);
  }
  return offer;
}

}  // namespace

HwLive::HwLive(HwLiveOptions options, const std::string& name, const config::ServoConfig& servo,
               bool has_camera, double speed_scale)
    : servo_(servo),
      speed_scale_(speed_scale),
      parameters_(desk::Tuner(servo).parameters()),
      scale_(speed_scale) {
  for (const live::Parameter& parameter : parameters_) {
    wished_.push_back(parameter.value);
  }
  asked_ = wished_;
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

void HwLive::Attend(const beliefs::Findings* findings) {
  server_->TakeCalls([this](const live::Call& call) { return Do(call); });
  live::State state;
  state.stamp_s = static_cast<double>(now_ns_ - begin_ns_) * 1e-9;
  if (desk_) {
    desk_->Fill(state);
  }
  if (const auto ticks = parts_ ? parts_->shell.NewTickDurations() : std::nullopt) {
    state.tick = {ticks->median_ns, ticks->max_ns};
  }
  state.ends = parts_ && (parts_->control.ended || parts_->control.done);
  run::RunBook* const book = parts_ ? parts_->shell.book() : nullptr;
  if (book != nullptr && book->log().failed()) {
    state.notice = "The log cannot be written, e.g. because the disk is full: it ends here.";
  }
  desk::Fill(findings, state);
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
  const std::int64_t until_ns = parts_->control.leave_until_ns;  // 0: the permission never ends
  if (until_ns != 0 && parts_->clock.NowNs() >= until_ns) {
    return {"the operator at the program is silent, so the arm is held; type a line there", "{}"};
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
  EndRun(parts_->allow_motion, false, parts_->control);
  return Say(Word::kEnd);
}

live::Answer HwLive::Take(const live::SetParameter& request) {
  if (request.parameter == parameters_.size()) {
    SetSpeedScale(request.value);
    return {};
  }
  const live::Parameter& key = parameters_.at(request.parameter);
  if (const double most = MostOf(key); request.value > most) {
    return {fmt::format("{} = {:g} is not allowed: at {} = {:g} at most {:g}", key.name, request.value,
                        kSpeedScale, scale_, most),
            "{}"};
  }
  wished_[request.parameter] = asked_[request.parameter] = request.value;
  return desk_->Take(request);
}

// The largest value of a gain: that of the configuration, times the share of the speed that is left. At the
// configuration's own scale there is no bound but the key's range.
double HwLive::MostOf(const live::Parameter& key) const {
  const bool is_scaled = key.name == "servo.lambda" || key.name == "servo.lambda_near";
  return is_scaled && scale_ < speed_scale_ ? key.default_value * scale_ / speed_scale_ : key.max;
}

// Lowers the gains that robot.speed_scale scales at the start, where they are larger than it allows. A larger
// scale gives back what was asked for. The tick's record has the changes.
void HwLive::SetSpeedScale(double scale) {
  scale_ = scale;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const double value = std::min(wished_[i], MostOf(parameters_[i]));
    if (value != std::exchange(asked_[i], value)) {
      static_cast<void>(desk_->Take(live::SetParameter{i, value}));
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
