// SPDX-License-Identifier: Apache-2.0
// The viewers' side of the hub: their messages, checked.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "firmware/host/live/hub.hpp"
#include "firmware/host/live/refusal.hpp"
#include "firmware/host/live/services.hpp"

namespace fovea::live {
namespace {

constexpr std::size_t kMostSubscriptions = 256;
constexpr std::size_t kMostChannels = 16;  // of a viewer's own

bool HasId(const std::vector<std::uint32_t>& ids, std::uint32_t id) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

}  // namespace

std::optional<Closing> Hub::Receive(std::uint64_t number, bool is_text, std::string_view bytes,
                                    Clock::time_point now) {
  const auto found = viewers_.find(number);
  if (found == viewers_.end()) {
    return std::nullopt;
  }
  now_ = now;
  Viewer& viewer = found->second;
  if (!viewer.messages.Take(now)) {
    return Closing{kAgainstTheRules,
                   fmt::format("more than {:.0f} messages a second", limits_.messages_per_s)};
  }
  control_.Hear(number, now);
  try {
    const ClientMessage message = is_text ? ParseText(bytes) : ParseBinary(bytes);
    std::visit([&](const auto& each) { Handle(viewer, each); }, message);
  } catch (const Refusal& refusal) {
    Complain(viewer, refusal.what());
  }
  return std::nullopt;
}

void Hub::Complain(Viewer& viewer, const std::string& text, StatusLevel level) {
  if (viewer.statuses.Take(now_)) {
    Send(viewer, StatusMessage(level, text));
  }
}

void Hub::Handle(Viewer& viewer, const Subscribe& message) {
  for (const Subscription& wanted : message.subscriptions) {
    const bool is_known = wanted.channel >= 1 && wanted.channel <= catalogue_.channels.size();
    const bool is_used = std::any_of(viewer.subscriptions.begin(), viewer.subscriptions.end(),
                                     [&](const Subscription& s) { return s.id == wanted.id; });
    if (!is_known || is_used || viewer.subscriptions.size() >= kMostSubscriptions) {
      Complain(viewer, !is_known ? fmt::format("there is no channel {}", wanted.channel)
                       : is_used ? fmt::format("the subscription {} exists already", wanted.id)
                                 : std::string("too many subscriptions"));
      continue;
    }
    const Subscription subscription{wanted.id, wanted.channel - 1};
    viewer.subscriptions.push_back(subscription);
    ++subscribers_[subscription.channel];
    if (subscription.channel == StateChannel()) {
      SendState(viewer, StateJson(state_, catalogue_));
    } else if (const Message& last = channels_[subscription.channel].latched; last.payload) {
      Deliver(viewer, subscription, last);
    }
  }
}

void Hub::Handle(Viewer& viewer, const Unsubscribe& message) {
  std::erase_if(viewer.subscriptions, [&](const Subscription& subscription) {
    const bool ends = HasId(message.subscriptions, subscription.id);
    subscribers_[subscription.channel] -= ends ? 1U : 0U;
    return ends;
  });
}

void Hub::Handle(Viewer& viewer, const Advertise& message) {
  for (const ClientChannel& channel : message.channels) {
    const bool is_topic = channel.topic == kTargetPoseTopic || channel.topic == kTargetReleaseTopic;
    if (!catalogue_.target || !is_topic) {
      Complain(viewer, fmt::format("{}: this run takes no messages on it", Quoted(channel.topic)));
    } else if (channel.encoding != "json") {
      Complain(viewer, fmt::format("{}: only messages in JSON are taken", channel.topic));
    } else if (viewer.channels.size() >= kMostChannels) {
      Complain(viewer, "too many channels");
    } else {
      viewer.channels.push_back(channel);
    }
  }
}

void Hub::Handle(Viewer& viewer, const Unadvertise& message) {
  std::erase_if(viewer.channels,
                [&](const ClientChannel& channel) { return HasId(message.channels, channel.id); });
}

std::size_t Hub::IndexOfParameter(const std::string& name) const {
  const auto& all = catalogue_.parameters;
  return static_cast<std::size_t>(
      std::find_if(all.begin(), all.end(), [&](const Parameter& p) { return p.name == name; }) - all.begin());
}

std::vector<const Parameter*> Hub::Values(const std::vector<std::size_t>& parameters) const {
  std::vector<const Parameter*> values;
  for (const std::size_t parameter : parameters) {
    values.push_back(&catalogue_.parameters[parameter]);
  }
  return values;
}

void Hub::Handle(Viewer& viewer, const GetParameters& message) {
  std::vector<std::size_t> wanted;
  for (std::size_t i = 0; message.names.empty() && i < catalogue_.parameters.size(); ++i) {
    wanted.push_back(i);
  }
  for (const std::string& name : message.names) {
    if (const std::size_t parameter = IndexOfParameter(name); parameter < catalogue_.parameters.size()) {
      wanted.push_back(parameter);
    }
  }
  Send(viewer, ParameterValuesMessage(Values(wanted), message.id));
}

void Hub::Handle(Viewer& viewer, const SubscribeParameters& message) {
  if (message.names.empty()) {
    viewer.watched.assign(viewer.watched.size(), message.on);
  }
  for (const std::string& name : message.names) {
    if (const std::size_t parameter = IndexOfParameter(name); parameter < catalogue_.parameters.size()) {
      viewer.watched[parameter] = message.on;
    }
  }
}

void Hub::CheckNewValue(Viewer& viewer, const NewValue& value, std::size_t index) {
  const Parameter& parameter = catalogue_.parameters[index];
  if (!catalogue_.tune) {
    throw Refusal(fmt::format("{}: this run's parameters can only be read", parameter.name));
  }
  if (!value.value || !(*value.value >= parameter.min && *value.value <= parameter.max)) {
    throw Refusal(fmt::format("{} must be a number from {:g} to {:g}{}{}, got {}", parameter.name,
                              parameter.min, parameter.max, parameter.unit.empty() ? "" : " ", parameter.unit,
                              value.value ? fmt::format("{:g}", *value.value) : "no number"));
  }
  RequireControl(viewer);
}

void Hub::Handle(Viewer& viewer, const SetParameters& message) {
  const std::uint64_t number = ++last_group_;
  ParameterGroup& group = groups_[number];
  group.viewer = viewer.number;
  group.id = message.id;
  group.left = 1;  // this function itself
  for (const NewValue& value : message.parameters) {
    const std::size_t parameter = IndexOfParameter(value.name);
    if (parameter == catalogue_.parameters.size()) {
      Complain(viewer, fmt::format("there is no parameter {} that may change in motion", Quoted(value.name)));
      continue;
    }
    group.parameters.push_back(parameter);
    try {
      CheckNewValue(viewer, value, parameter);
      Forward(viewer, {ReturnAddress::Kind::kParameter, viewer.number, 0, 0, number},
              live::SetParameter{parameter, *value.value});
      ++group.left;
    } catch (const Refusal& refusal) {
      Complain(viewer, refusal.what());
    }
  }
  FinishParameter(number);
}

void Hub::Handle(Viewer& viewer, const ClientData& message) {
  const auto channel = std::find_if(viewer.channels.begin(), viewer.channels.end(),
                                    [&](const ClientChannel& c) { return c.id == message.channel; });
  if (channel == viewer.channels.end()) {
    throw Refusal(fmt::format("there is no channel {} of this viewer", message.channel));
  }
  Request request = ReadTarget(channel->topic, message.payload);
  RequireControl(viewer);
  Forward(viewer, {ReturnAddress::Kind::kNobody, viewer.number}, std::move(request));
}

void Hub::Handle(Viewer& viewer, const ServiceCall& message) {
  const auto service = static_cast<Service>(message.service - 1);  // 0 wraps round and is not found
  try {
    if (std::find(catalogue_.services.begin(), catalogue_.services.end(), service) ==
        catalogue_.services.end()) {
      throw Refusal("this run offers no such service");
    }
    if (message.encoding != "json") {
      throw Refusal("only requests in JSON are taken");
    }
    CallService(viewer, service, message);
  } catch (const Refusal& refusal) {
    Send(viewer, ServiceFailureMessage(message.service, message.call, refusal.what()));
  }
}

void Hub::CallService(Viewer& viewer, Service service, const ServiceCall& message) {
  if (service == Service::kTakeControl) {
    Send(viewer, ServiceResponseMessage(message.service, message.call, TakeControl(viewer, message.payload)));
    return;
  }
  if (service == Service::kGiveControl) {
    EndControl(viewer);
    Send(viewer, ServiceResponseMessage(message.service, message.call, "{}"));
    return;
  }
  Request request = ReadRequest(service, message.payload, catalogue_);
  if (NeedsControl(service, catalogue_)) {
    RequireControl(viewer);
  }
  Forward(viewer, {ReturnAddress::Kind::kService, viewer.number, message.service, message.call, 0},
          std::move(request));
}

std::string Hub::TakeControl(Viewer& viewer, std::string_view payload) {
  const std::string name = ReadControlName(payload);
  const bool granted = control_.Take(viewer.number, name.empty() ? viewer.name : name, now_);
  if (granted) {
    viewer.name = control_.name();
    SendStates();
  }
  return nlohmann::ordered_json{{"granted", granted}, {"controller", control_.name()}}.dump();
}

void Hub::RequireControl(Viewer& viewer) {
  if (control_.Has(viewer.number)) {
    return;
  }
  if (!control_.Take(viewer.number, viewer.name, now_)) {
    throw Refusal(fmt::format("{} has control of the run", control_.name()));
  }
  SendStates();
}

void Hub::Forward(Viewer& viewer, ReturnAddress from, Request request) {
  if (!calls_.Add({from, {viewer.name, std::move(request)}})) {
    throw Refusal("the run is busy: too many requests wait");
  }
}

void Hub::Handle(Viewer& viewer, const UnknownOperation& message) {
  Complain(viewer, fmt::format("the operation {} is not offered here", message.name), StatusLevel::kWarning);
}

}  // namespace fovea::live
