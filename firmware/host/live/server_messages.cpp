// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/live/server_messages.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "firmware/host/live/services.hpp"

namespace fovea::live {
namespace {

using nlohmann::ordered_json;

// Bytes of a text that are no UTF-8 are replaced: no name or notice can stop the server.
std::string Dump(const ordered_json& object) {
  return object.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

Outgoing TextMessage(const ordered_json& object) { return {true, Dump(object), nullptr, Weight::kEssential}; }

template <typename Number>
void Put(std::string& out, Number value) {
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    out.push_back(static_cast<char>((static_cast<std::uint64_t>(value) >> (8 * i)) & 0xFFU));
  }
}

bool Offers(const Catalogue& catalogue, Service service) {
  return std::find(catalogue.services.begin(), catalogue.services.end(), service) != catalogue.services.end();
}

ordered_json MayJson(const Catalogue& catalogue) {
  return {{"hold", Offers(catalogue, Service::kHold)},
          {"track", Offers(catalogue, Service::kTrack)},
          {"tune", catalogue.tune},
          {"target", catalogue.target},
          {"pull", Offers(catalogue, Service::kPull)},
          {"pause", Offers(catalogue, Service::kPause)},
          {"fault", Offers(catalogue, Service::kStartFault)},
          {"save", Offers(catalogue, Service::kSave)},
          {"step", Offers(catalogue, Service::kStep)},
          {"speed", Offers(catalogue, Service::kSpeed)},
          {"reset", Offers(catalogue, Service::kReset)},
          {"end", Offers(catalogue, Service::kEnd)},
          {"end_at_once", catalogue.anyone_may_end},
          {"recover", Offers(catalogue, Service::kRecover)},
          {"throw", Offers(catalogue, Service::kThrow)}};
}

ordered_json FaultsJson(const State& state, const Catalogue& catalogue) {
  ordered_json faults = ordered_json::array();
  for (std::size_t i = 0; i < catalogue.faults.size(); ++i) {
    const FaultKind& kind = catalogue.faults[i];
    const FaultState now = i < state.faults.size() ? state.faults[i] : FaultState{};
    ordered_json settings = ordered_json::array();
    for (std::size_t k = 0; k < kind.settings.size(); ++k) {
      const FaultSetting& setting = kind.settings[k];
      settings.push_back({{"name", setting.name},
                          {"words", setting.words},
                          {"unit", setting.unit},
                          {"min", setting.min},
                          {"max", setting.max},
                          {"whole", setting.whole},
                          {"value", k < now.values.size() ? now.values[k] : setting.value}});
    }
    faults.push_back(
        {{"name", kind.name}, {"words", kind.words}, {"active", now.active}, {"settings", settings}});
  }
  return faults;
}

ordered_json FindingsJson(const State& state) {
  ordered_json findings = ordered_json::array();
  for (const FindingState& finding : state.findings) {
    const auto number = [&](double value) {
      return finding.known ? ordered_json(value) : ordered_json(nullptr);
    };
    findings.push_back({{"name", finding.name},
                        {"key", finding.key},
                        {"unit", finding.unit},
                        {"configured", finding.configured ? ordered_json(*finding.configured) : nullptr},
                        {"known", finding.known},
                        {"difference", number(finding.difference)},
                        {"sigma", number(finding.sigma)}});
  }
  return findings;
}

}  // namespace

Outgoing ServerInfoMessage(const Catalogue& catalogue, const std::string& session) {
  ordered_json capabilities = {"time"};
  if (!catalogue.parameters.empty()) {
    capabilities.push_back("parameters");
    capabilities.push_back("parametersSubscribe");
  }
  if (!catalogue.services.empty()) {
    capabilities.push_back("services");
  }
  if (catalogue.target) {
    capabilities.push_back("clientPublish");
  }
  return TextMessage({{"op", "serverInfo"},
                      {"name", "fovea: " + catalogue.name},
                      {"capabilities", capabilities},
                      {"supportedEncodings", {"json"}},
                      {"metadata", ordered_json::object()},
                      {"sessionId", session}});
}

Outgoing AdvertiseMessage(const std::vector<Channel>& channels) {
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const Channel& channel = channels[i];
    list.push_back({{"id", i + 1},
                    {"topic", channel.topic},
                    {"encoding", channel.encoding},
                    {"schemaName", channel.schema_name},
                    {"schema", channel.schema},
                    {"schemaEncoding", channel.schema_encoding}});
  }
  return TextMessage({{"op", "advertise"}, {"channels", list}});
}

Outgoing AdvertiseServicesMessage(const std::vector<Service>& services) {
  ordered_json list = ordered_json::array();
  for (const Service service : services) {
    const ServiceSchemas schemas = SchemasOf(service);
    const std::string type = std::string("fovea") + Name(service);
    const auto side = [&type](const char* which, const std::string& schema) {
      return ordered_json{{"encoding", "json"},
                          {"schemaName", type + which},
                          {"schemaEncoding", "jsonschema"},
                          {"schema", schema}};
    };
    list.push_back({{"id", 1 + static_cast<int>(service)},
                    {"name", Name(service)},
                    {"type", type},
                    {"request", side("_request", schemas.request)},
                    {"response", side("_response", schemas.response)}});
  }
  return TextMessage({{"op", "advertiseServices"}, {"services", list}});
}

Outgoing StatusMessage(StatusLevel level, const std::string& text, const std::string& id) {
  ordered_json status = {{"op", "status"}, {"level", static_cast<int>(level)}, {"message", text}};
  if (!id.empty()) {
    status["id"] = id;
  }
  return TextMessage(status);
}

Outgoing ParameterValuesMessage(const std::vector<const Parameter*>& parameters, const std::string& id) {
  ordered_json list = ordered_json::array();
  for (const Parameter* parameter : parameters) {
    list.push_back({{"name", parameter->name}, {"value", parameter->value}, {"type", "float64"}});
  }
  ordered_json values = {{"op", "parameterValues"}, {"parameters", list}};
  if (!id.empty()) {
    values["id"] = id;
  }
  return TextMessage(values);
}

Outgoing ServiceFailureMessage(std::uint32_t service, std::uint32_t call, const std::string& text) {
  return TextMessage(
      {{"op", "serviceCallFailure"}, {"serviceId", service}, {"callId", call}, {"message", text}});
}

Outgoing ServiceResponseMessage(std::uint32_t service, std::uint32_t call, std::string_view object) {
  constexpr std::string_view kEncoding = "json";
  std::string head;
  Put(head, std::uint8_t{3});
  Put(head, service);
  Put(head, call);
  Put(head, static_cast<std::uint32_t>(kEncoding.size()));
  head += kEncoding;
  head += object;
  return {false, std::move(head), nullptr, Weight::kEssential};
}

Outgoing TimeMessage(std::int64_t now_ns) {
  std::string head;
  Put(head, std::uint8_t{2});
  Put(head, now_ns);
  return {false, std::move(head), nullptr, Weight::kEssential};
}

Outgoing DataMessage(std::uint32_t subscription, std::int64_t stamp_ns,
                     std::shared_ptr<const std::string> payload, Weight weight) {
  std::string head;
  Put(head, std::uint8_t{1});
  Put(head, subscription);
  Put(head, stamp_ns);
  return {false, std::move(head), std::move(payload), weight};
}

std::string ParametersJson(const std::vector<Parameter>& parameters) {
  ordered_json list = ordered_json::array();
  for (const Parameter& parameter : parameters) {
    list.push_back({{"name", parameter.name},
                    {"unit", parameter.unit},
                    {"meaning", parameter.meaning},
                    {"min", parameter.min},
                    {"max", parameter.max},
                    {"value", parameter.value},
                    {"default", parameter.default_value}});
  }
  return Dump(list);
}

std::string StateJson(const State& state, const Catalogue& catalogue) {
  ordered_json object = {{"stamp_s", state.stamp_s},
                         {"wall_s", state.wall_s},
                         {"mode", state.mode},
                         {"hold_reason", state.hold_reason},
                         {"hold_reason_words", state.hold_reason_words},
                         {"fault", state.fault},
                         {"fault_words", state.fault_words},
                         {"paused", state.paused},
                         {"speed", state.speed},
                         {"real_time_factor", state.real_time_factor},
                         {"ends", state.ends},
                         {"may", MayJson(catalogue)},
                         {"faults", FaultsJson(state, catalogue)},
                         {"target", nullptr},
                         {"pull", nullptr},
                         {"tick_us", nullptr},
                         {"findings", FindingsJson(state)},
                         {"notice", state.notice}};
  if (state.target) {
    object["target"] = {
        {"p_BO", state.target->p_BO}, {"q_BO", state.target->q_BO}, {"held", state.target->held}};
  }
  if (state.pull) {
    object["pull"] = {{"link", state.pull->link}, {"to_B", state.pull->to_B}};
  }
  if (state.tick) {
    object["tick_us"] = {{"median", 1e-3 * static_cast<double>(state.tick->median_ns)},
                         {"max", 1e-3 * static_cast<double>(state.tick->max_ns)}};
  }
  std::string text = Dump(object);
  text.pop_back();
  return text;
}

std::string StateJsonEnd(const ViewerState& viewer) {
  ordered_json object = {
      {"controller", nullptr},
      {"you", viewer.is_controller},
      {"viewers", viewer.viewers},
      {"dropped", {{"pictures", viewer.dropped_pictures}, {"plots", viewer.dropped_plots}}}};
  if (!viewer.controller.empty()) {
    object["controller"] = viewer.controller;
  }
  std::string text = Dump(object);
  text.front() = ',';  // continues the object of StateJson
  return text;
}

}  // namespace fovea::live
