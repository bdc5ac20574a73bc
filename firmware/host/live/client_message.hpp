// SPDX-License-Identifier: Apache-2.0
// Messages of the Foxglove WebSocket protocol from a client, parsed. Nothing in them is trusted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace fovea::live {

inline constexpr std::size_t kMostEntries = 256;    // of a list in a message
inline constexpr std::size_t kMostNameBytes = 256;  // of a name in a message
inline constexpr int kMostDepth = 8;                // of nested JSON

struct Subscription {
  std::uint32_t id = 0;
  std::uint32_t channel = 0;
};
struct ClientChannel {
  std::uint32_t id = 0;
  std::string topic;
  std::string encoding;
};
struct NewValue {
  std::string name;
  std::optional<double> value;  // none: it is no number
};

struct Subscribe {
  std::vector<Subscription> subscriptions;
};
struct Unsubscribe {
  std::vector<std::uint32_t> subscriptions;
};
struct Advertise {
  std::vector<ClientChannel> channels;
};
struct Unadvertise {
  std::vector<std::uint32_t> channels;
};
struct GetParameters {
  std::vector<std::string> names;  // empty: all
  std::string id;                  // "" when the client gave none
};
struct SetParameters {
  std::vector<NewValue> parameters;
  std::string id;
};
struct SubscribeParameters {
  std::vector<std::string> names;  // empty: all
  bool on = true;                  // false: ends the subscription
};
// A message on one of the client's own channels.
struct ClientData {
  std::uint32_t channel = 0;
  std::string_view payload;
};
struct ServiceCall {
  std::uint32_t service = 0;
  std::uint32_t call = 0;
  std::string_view encoding;
  std::string_view payload;
};
// An operation that the server does not offer.
struct UnknownOperation {
  std::string name;
};

using ClientMessage =
    std::variant<Subscribe, Unsubscribe, Advertise, Unadvertise, GetParameters, SetParameters,
                 SubscribeParameters, ClientData, ServiceCall, UnknownOperation>;

// Views in the result point into `bytes`. Refusal: the message is malformed.
ClientMessage ParseText(std::string_view bytes);
ClientMessage ParseBinary(std::string_view bytes);

}  // namespace fovea::live
