// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/live/client_message.hpp"

#include <cstring>

#include <utility>

#include "firmware/host/live/json_reader.hpp"

namespace fovea::live {
namespace {

using nlohmann::json;

std::vector<std::uint32_t> IdsOf(const json& object, const char* name) {
  std::vector<std::uint32_t> ids;
  for (const json& id : ListOf(object, name)) {
    ids.push_back(IdOf(id));
  }
  return ids;
}

std::vector<std::string> NamesOf(const json& object) {
  std::vector<std::string> names;
  for (const json& name : ListOf(object, "parameterNames")) {
    if (!name.is_string() || name.get_ref<const std::string&>().size() > kMostNameBytes) {
      throw Refusal("a parameter's name must be a short text");
    }
    names.push_back(name.get<std::string>());
  }
  return names;
}

Subscribe ReadSubscribe(const json& object) {
  Subscribe out;
  for (const json& entry : ListOf(object, "subscriptions")) {
    out.subscriptions.push_back({IdOf(FieldOf(entry, "id")), IdOf(FieldOf(entry, "channelId"))});
  }
  return out;
}

Advertise ReadAdvertise(const json& object) {
  Advertise out;
  for (const json& entry : ListOf(object, "channels")) {
    out.channels.push_back({IdOf(FieldOf(entry, "id")), TextOf(entry, "topic"), TextOf(entry, "encoding")});
  }
  return out;
}

SetParameters ReadSetParameters(const json& object) {
  SetParameters out;
  for (const json& entry : ListOf(object, "parameters")) {
    NewValue parameter{TextOf(entry, "name"), std::nullopt};
    if (const auto value = entry.find("value"); value != entry.end() && value->is_number()) {
      parameter.value = value->get<double>();
    }
    out.parameters.push_back(std::move(parameter));
  }
  out.id = TextOrNone(object, "id");
  return out;
}

// Reads little-endian numbers from the front of a binary message.
class Front {
 public:
  explicit Front(std::string_view bytes) : rest_(bytes) {}

  std::string_view Bytes(std::size_t count) {
    if (count > rest_.size()) {
      throw Refusal("the binary message is too short");
    }
    const std::string_view bytes = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return bytes;
  }
  std::uint32_t Word() {
    std::uint32_t word = 0;
    const std::string_view bytes = Bytes(4);
    for (std::size_t i = 0; i < 4; ++i) {
      word |= std::uint32_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
    }
    return word;
  }
  std::string_view Rest() { return rest_; }

 private:
  std::string_view rest_;
};

}  // namespace

ClientMessage ParseText(std::string_view bytes) {
  const json object = ReadObject(bytes);
  const std::string op = TextOf(object, "op");
  if (op == "subscribe") {
    return ReadSubscribe(object);
  }
  if (op == "unsubscribe") {
    return Unsubscribe{IdsOf(object, "subscriptionIds")};
  }
  if (op == "advertise") {
    return ReadAdvertise(object);
  }
  if (op == "unadvertise") {
    return Unadvertise{IdsOf(object, "channelIds")};
  }
  if (op == "getParameters") {
    return GetParameters{NamesOf(object), TextOrNone(object, "id")};
  }
  if (op == "setParameters") {
    return ReadSetParameters(object);
  }
  if (op == "subscribeParameterUpdates") {
    return SubscribeParameters{NamesOf(object), true};
  }
  if (op == "unsubscribeParameterUpdates") {
    return SubscribeParameters{NamesOf(object), false};
  }
  return UnknownOperation{Quoted(op)};
}

ClientMessage ParseBinary(std::string_view bytes) {
  constexpr char kData = 1;
  constexpr char kService = 2;
  Front front(bytes);
  const char op = front.Bytes(1).front();
  if (op == kData) {
    const std::uint32_t channel = front.Word();
    return ClientData{channel, front.Rest()};
  }
  if (op == kService) {
    ServiceCall call;
    call.service = front.Word();
    call.call = front.Word();
    call.encoding = front.Bytes(front.Word());
    call.payload = front.Rest();
    return call;
  }
  return UnknownOperation{"number " + std::to_string(static_cast<unsigned char>(op))};
}

}  // namespace fovea::live
