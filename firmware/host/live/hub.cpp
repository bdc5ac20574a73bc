// SPDX-License-Identifier: Apache-2.0
// The run's side of the hub: what it publishes and answers, and what happens by the clock.
#include "firmware/host/live/hub.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "firmware/host/live/access.hpp"

namespace fovea::live {
namespace {

constexpr auto kStatePeriod = std::chrono::milliseconds(100);
constexpr auto kHeldFor = std::chrono::milliseconds(20);
constexpr auto kDropsPeriod = std::chrono::seconds(2);
constexpr double kStatusesPerSecond = 5.0;
constexpr double kStatusesBurst = 20.0;

// Without what changes all the time.
State Events(State state) {
  state.stamp_s = state.wall_s = state.real_time_factor = 0.0;
  state.tick.reset();
  if (state.target) {
    state.target = TargetState{{}, {}, state.target->held};
  }
  if (state.pull) {
    state.pull->to_B = {};
  }
  return state;
}

Catalogue Completed(Catalogue catalogue) {
  const auto add = [&catalogue](const char* topic, const char* name, const char* schema) {
    catalogue.channels.push_back({topic, name, schema, Weight::kEssential, true, 0.0, "json", "jsonschema"});
  };
  add("/live/state", "fovea.live.State", R"({"type":"object"})");
  add("/live/parameters", "fovea.live.Parameters", R"({"type":"array","items":{"type":"object"}})");
  if (!catalogue.services.empty() || catalogue.tune || catalogue.target) {
    catalogue.services.push_back(Service::kTakeControl);
    catalogue.services.push_back(Service::kGiveControl);
  }
  return catalogue;
}

}  // namespace

Hub::Viewer::Viewer(std::uint64_t viewer, const Limits& limits)
    : number(viewer),
      name(fmt::format("viewer {}", viewer)),
      outbox(limits),
      messages(limits.messages_per_s, limits.messages_burst),
      statuses(kStatusesPerSecond, kStatusesBurst) {}

Hub::Hub(const Limits& limits, Catalogue catalogue, CallQueue& calls)
    : limits_(limits),
      calls_(calls),
      catalogue_(Completed(std::move(catalogue))),
      session_(RandomToken()),
      control_(limits.control),
      channels_(catalogue_.channels.size()),
      subscribers_(new std::atomic<std::uint32_t>[catalogue_.channels.size()]()) {
  channels_[ParametersChannel()].latched.payload =
      std::make_shared<const std::string>(ParametersJson(catalogue_.parameters));
}

std::uint64_t Hub::Join() {
  const std::uint64_t number = ++last_viewer_;
  Viewer& viewer = viewers_.try_emplace(number, number, limits_).first->second;
  viewer.watched.resize(catalogue_.parameters.size());
  num_viewers_ = viewers_.size();
  Send(viewer, ServerInfoMessage(catalogue_, session_));
  Send(viewer, AdvertiseMessage(catalogue_.channels));
  if (!catalogue_.services.empty()) {
    Send(viewer, AdvertiseServicesMessage(catalogue_.services));
  }
  SendStates();
  return number;
}

void Hub::Leave(std::uint64_t number) {
  const auto found = viewers_.find(number);
  if (found == viewers_.end()) {
    return;
  }
  EndControl(found->second);
  for (const Subscription& subscription : found->second.subscriptions) {
    --subscribers_[subscription.channel];
  }
  CountDrops(found->second);
  viewers_.erase(found);
  num_viewers_ = viewers_.size();
  SendStates();
}

std::optional<Outgoing> Hub::Next(std::uint64_t viewer) {
  const auto found = viewers_.find(viewer);
  return found == viewers_.end() ? std::nullopt : found->second.outbox.Take();
}

std::vector<std::uint64_t> Hub::TakeHopeless() {
  std::vector<std::uint64_t> hopeless;
  for (auto& [number, viewer] : viewers_) {
    if (viewer.is_hopeless) {
      hopeless.push_back(number);
    }
  }
  return hopeless;
}

void Hub::Send(Viewer& viewer, Outgoing message) {
  viewer.is_hopeless = !viewer.outbox.Add(std::move(message)) || viewer.is_hopeless;
}

void Hub::Deliver(Viewer& viewer, const Subscription& subscription, const Message& message) {
  Send(viewer, DataMessage(subscription.id, message.stamp_ns, message.payload,
                           catalogue_.channels[subscription.channel].weight));
}

void Hub::Distribute(std::size_t channel, std::int64_t stamp_ns, std::string payload, Clock::time_point now) {
  const Message message{stamp_ns, std::make_shared<const std::string>(std::move(payload))};
  const Channel& kind = catalogue_.channels[channel];
  ChannelState& state = channels_[channel];
  if (kind.latched) {
    state.latched = message;
  }
  if (kind.most_hz > 0.0 && now - state.sent < std::chrono::duration<double>(1.0 / kind.most_hz)) {
    state.held = message;
    state.held_since = now;
    return;
  }
  DeliverToAll(channel, message, now);
}

void Hub::DeliverToAll(std::size_t channel, const Message& message, Clock::time_point now) {
  channels_[channel].sent = now;
  channels_[channel].held = {};
  for (auto& [number, viewer] : viewers_) {
    for (const Subscription& subscription : viewer.subscriptions) {
      if (subscription.channel == channel) {
        Deliver(viewer, subscription, message);
      }
    }
  }
}

// What was held back, where nothing newer came: the last tick of a run that pauses.
void Hub::SendHeld(Clock::time_point now) {
  for (std::size_t channel = 0; channel < channels_.size(); ++channel) {
    if (const ChannelState& state = channels_[channel];
        state.held.payload && now - state.held_since >= kHeldFor) {
      DeliverToAll(channel, Message(state.held), now);
    }
  }
}

void Hub::SetState(const State& state) {
  const bool has_event = !has_state_ || Events(state) != Events(state_);
  const std::optional<TickTimesState> unsent = state_.tick;
  state_ = state;
  if (unsent) {  // the longest tick reaches the viewers, although not every state does
    state_.tick = state.tick ? state.tick : unsent;
    state_.tick->max_ns = std::max(state_.tick->max_ns, unsent->max_ns);
  }
  has_state_ = true;
  if (has_event) {
    SendStates();
  }
}

void Hub::SendStates() {
  state_sent_ = now_;
  if (!has_state_ || !IsWanted(StateChannel())) {
    return;
  }
  const std::string common = StateJson(state_, catalogue_);
  for (auto& [number, viewer] : viewers_) {
    SendState(viewer, common);
  }
  state_.tick.reset();
}

void Hub::SendState(Viewer& viewer, const std::string& common) {
  const auto subscription =
      std::find_if(viewer.subscriptions.begin(), viewer.subscriptions.end(),
                   [this](const Subscription& s) { return s.channel == StateChannel(); });
  if (!has_state_ || subscription == viewer.subscriptions.end()) {
    return;
  }
  const ViewerState end{control_.name(), control_.Has(viewer.number), viewers_.size(),
                        viewer.outbox.dropped_pictures(), viewer.outbox.dropped_plots()};
  const auto payload = std::make_shared<const std::string>(common + StateJsonEnd(end));
  Deliver(viewer, *subscription, {now_ns_, payload});
}

void Hub::SetParameter(std::size_t index, double value) {
  Parameter& parameter = catalogue_.parameters[index];
  parameter.value = value;
  parameters_changed_ = true;
  for (auto& [number, viewer] : viewers_) {
    if (viewer.watched[index]) {
      Send(viewer, ParameterValuesMessage({&parameter}, ""));
    }
  }
}

void Hub::SendParameters() {
  if (std::exchange(parameters_changed_, false)) {
    Distribute(ParametersChannel(), now_ns_, ParametersJson(catalogue_.parameters), now_);
  }
}

void Hub::SendAnswers() {
  for (const AnsweredCall& answered : calls_.TakeAnswers()) {
    const ReturnAddress& from = answered.from;
    const std::string& error = answered.answer.error;
    if (const auto* set = std::get_if<live::SetParameter>(&answered.request);
        set != nullptr && error.empty()) {
      SetParameter(set->parameter, set->value);
    }
    const auto found = viewers_.find(from.viewer);
    Viewer* const viewer = found == viewers_.end() ? nullptr : &found->second;
    if (viewer != nullptr && from.kind == ReturnAddress::Kind::kService) {
      Send(*viewer, error.empty() ? ServiceResponseMessage(from.service, from.call, answered.answer.json)
                                  : ServiceFailureMessage(from.service, from.call, error));
    } else if (viewer != nullptr && !error.empty()) {
      Complain(*viewer, error);
    }
    if (from.kind == ReturnAddress::Kind::kParameter) {
      FinishParameter(from.group);
    }
  }
}

void Hub::FinishParameter(std::uint64_t group) {
  const auto found = groups_.find(group);
  if (found == groups_.end() || --found->second.left > 0) {
    return;
  }
  if (const auto viewer = viewers_.find(found->second.viewer); viewer != viewers_.end()) {
    Send(viewer->second, ParameterValuesMessage(Values(found->second.parameters), found->second.id));
  }
  groups_.erase(found);
}

void Hub::Tell(StatusLevel level, const std::string& text) {
  for (auto& [number, viewer] : viewers_) {
    Send(viewer, StatusMessage(level, text));
  }
}

void Hub::EndControl(Viewer& viewer) {
  if (control_.End(viewer.number)) {
    // One that waits already says the same.
    static_cast<void>(
        calls_.Add({{ReturnAddress::Kind::kNobody, viewer.number}, {viewer.name, ControlEnded{}}}));
    SendStates();
  }
}

void Hub::Pulse(std::int64_t now_ns, Clock::time_point now) {
  now_ns_ = now_ns;
  now_ = now;
  if (control_.IsSilent(now)) {
    Viewer& viewer = viewers_.at(control_.holder());
    Send(viewer,
         StatusMessage(StatusLevel::kWarning, "control ended: this viewer said nothing for too long"));
    EndControl(viewer);
  }
  const bool tells_drops = now - drops_told_ >= kDropsPeriod;
  for (auto& [number, viewer] : viewers_) {
    if (viewer.outbox.empty()) {  // a viewer that lags needs no old times
      Send(viewer, TimeMessage(now_ns));
    }
    if (tells_drops) {
      CountDrops(viewer);
    }
  }
  if (tells_drops) {
    drops_told_ = now;
  }
  if (now - state_sent_ >= kStatePeriod) {
    SendStates();
  }
  SendParameters();
  SendHeld(now);
}

void Hub::CountDrops(Viewer& viewer) {
  const std::uint64_t pictures = viewer.outbox.dropped_pictures() - viewer.counted_pictures;
  const std::uint64_t plots = viewer.outbox.dropped_plots() - viewer.counted_plots;
  if (pictures + plots == 0) {
    return;
  }
  viewer.counted_pictures += pictures;
  viewer.counted_plots += plots;
  dropped_pictures_ += pictures;
  dropped_plots_ += plots;
  Send(viewer,
       StatusMessage(StatusLevel::kWarning,
                     fmt::format("this viewer reads too slowly: {} pictures and {} plot points were left "
                                 "out so far",
                                 viewer.counted_pictures, viewer.counted_plots),
                     "dropped"));
}

}  // namespace fovea::live
