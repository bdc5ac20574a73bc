// SPDX-License-Identifier: Apache-2.0
// Messages of the Foxglove WebSocket protocol to a client.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host/live/catalogue.hpp"
#include "firmware/host/live/outbox.hpp"
#include "firmware/host/live/state.hpp"

namespace fovea::live {

enum class StatusLevel { kInfo = 0, kWarning = 1, kError = 2 };

Outgoing ServerInfoMessage(const Catalogue& catalogue, const std::string& session);
// The channel with index i has the id i + 1.
Outgoing AdvertiseMessage(const std::vector<Channel>& channels);
// The service's id is 1 + its enumerator.
Outgoing AdvertiseServicesMessage(const std::vector<Service>& services);
// `id`: a later status with the same id takes its place; "" for none.
Outgoing StatusMessage(StatusLevel level, const std::string& text, const std::string& id = "");
Outgoing ParameterValuesMessage(const std::vector<const Parameter*>& parameters, const std::string& id);
Outgoing ServiceFailureMessage(std::uint32_t service, std::uint32_t call, const std::string& text);
Outgoing ServiceResponseMessage(std::uint32_t service, std::uint32_t call, std::string_view answer);
Outgoing TimeMessage(std::int64_t now_ns);
Outgoing DataMessage(std::uint32_t subscription, std::int64_t stamp_ns,
                     std::shared_ptr<const std::string> payload, Weight weight);

// Payload of /live/parameters.
std::string ParametersJson(const std::vector<Parameter>& parameters);

// What the server adds to a run's state, for one viewer.
struct ViewerState {
  std::string controller;  // "" for nobody
  bool is_controller = false;
  std::size_t viewers = 0;
  std::uint64_t dropped_pictures = 0;
  std::uint64_t dropped_plots = 0;
};
// Payload of /live/state: the part of all viewers, without the closing brace, and the part of one viewer.
std::string StateJson(const State& state, const Catalogue& catalogue);
std::string StateJsonEnd(const ViewerState& viewer);

}  // namespace fovea::live
