// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/live/services.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "firmware/host/live/json_reader.hpp"

namespace fovea::live {
namespace {

using nlohmann::json;

constexpr const char* kVector = R"({"type":"array","items":{"type":"number"},"minItems":3,"maxItems":3})";

// A JSON schema of an object with these properties, all of them required unless `optional` names one.
std::string ObjectSchema(const std::string& properties, const std::string& required) {
  return R"({"type":"object","properties":{)" + properties + R"(},"required":[)" + required + "]}";
}

std::size_t FaultOf(const json& object, const Catalogue& catalogue) {
  const std::string name = TextOf(object, "name");
  const auto fault = std::find_if(catalogue.faults.begin(), catalogue.faults.end(),
                                  [&name](const FaultKind& kind) { return kind.name == name; });
  if (fault == catalogue.faults.end()) {
    throw Refusal("there is no fault " + Quoted(name));
  }
  return static_cast<std::size_t>(fault - catalogue.faults.begin());
}

double SizeOf(const json& value, const FaultSetting& setting) {
  const double size = NumberIn(value, setting.name, setting.min, setting.max);
  if (setting.whole && size != std::floor(size)) {
    const auto shown = [](double bound) { return std::to_string(static_cast<std::int64_t>(bound)); };
    throw Refusal(setting.name + " must be a whole number from " + shown(setting.min) + " to " +
                  shown(setting.max) + ", got " + Quoted(value.dump(-1, ' ', true)));
  }
  return size;
}

StartFault ReadStartFault(const json& object, const Catalogue& catalogue) {
  RefuseUnknownFields(object, {"name", "settings"});
  StartFault start{FaultOf(object, catalogue), {}};
  if (!object.contains("settings")) {
    return start;
  }
  const json& settings = object["settings"];
  if (!settings.is_object() || settings.size() > kMostEntries) {
    throw Refusal("settings must be an object");
  }
  const std::vector<FaultSetting>& known = catalogue.faults[start.fault].settings;
  for (const auto& [name, value] : settings.items()) {
    const auto setting =
        std::find_if(known.begin(), known.end(), [&](const FaultSetting& each) { return each.name == name; });
    if (setting == known.end()) {
      throw Refusal("the fault has no setting " + Quoted(name));
    }
    start.sizes[name] = SizeOf(value, *setting);
  }
  return start;
}

Pause ReadPause(const json& object) {
  RefuseUnknownFields(object, {"paused"});
  const json& paused = FieldOf(object, "paused");
  if (!paused.is_boolean()) {
    throw Refusal("paused must be true or false");
  }
  return {paused.get<bool>()};
}

Step ReadStep(const json& object) {
  RefuseUnknownFields(object, {"ticks"});
  const double ticks = NumberIn(FieldOf(object, "ticks"), "ticks", 1, kMostSteps);
  if (ticks != std::floor(ticks)) {
    throw Refusal("ticks must be a whole number");
  }
  return {static_cast<int>(ticks)};
}

Speed ReadSpeed(const json& object) {
  RefuseUnknownFields(object, {"factor"});
  const double factor = NumberIn(FieldOf(object, "factor"), "factor", 0.0, 1.0);
  if (factor != 0.0 && factor < kLeastFactor) {
    throw Refusal("factor must be 0 (as fast as it goes), or from 0.1 to 1");
  }
  return {factor};
}

Pull ReadPull(const json& object) {
  RefuseUnknownFields(object, {"link", "p_link", "to_B"});
  return {TextOf(object, "link"), VectorOf<3>(object, "p_link", kMostMetres),
          VectorOf<3>(object, "to_B", kMostMetres)};
}

Throw ReadThrow(const json& object) {
  RefuseUnknownFields(object, {"v_BO", "omega_B"});
  return {VectorOf<3>(object, "v_BO", kMostSpeed), VectorOf<3>(object, "omega_B", kMostTurnSpeed)};
}

HoldTarget ReadPose(const json& object) {
  constexpr double kMostError = 0.01;  // of the quaternion's length
  RefuseUnknownFields(object, {"p_BO", "q_BO"});
  HoldTarget hold{VectorOf<3>(object, "p_BO", kMostMetres), VectorOf<4>(object, "q_BO", 1.0 + kMostError)};
  double squares = 0.0;
  for (const double part : hold.q_BO) {
    squares += part * part;
  }
  const double length = std::sqrt(squares);
  if (std::abs(length - 1.0) > kMostError) {
    throw Refusal("q_BO must be a quaternion w, x, y, z of length 1");
  }
  for (double& part : hold.q_BO) {
    part /= length;
  }
  return hold;
}

template <typename Plain>
Plain ReadPlain(const json& object) {
  RefuseUnknownFields(object, {});
  return {};
}

json ReadPayload(std::string_view payload) { return payload.empty() ? json::object() : ReadObject(payload); }

}  // namespace

const char* Name(Service service) {
  constexpr std::array<const char*, kNumServices> kNames{
      "/servo/hold",  "/servo/track",  "/servo/recover", "/run/pause",   "/run/step",   "/run/speed",
      "/run/reset",   "/run/save",     "/run/end",       "/fault/start", "/fault/stop", "/arm/pull",
      "/arm/release", "/target/throw", "/control/take",  "/control/give"};
  return kNames[static_cast<std::size_t>(service)];
}

ServiceSchemas SchemasOf(Service service) {
  const std::string none = ObjectSchema("", "");
  const std::string vector = kVector;
  switch (service) {
    case Service::kPause: return {ObjectSchema(R"("paused":{"type":"boolean"})", R"("paused")"), none};
    case Service::kStep:
      return {ObjectSchema(R"("ticks":{"type":"integer","minimum":1,"maximum":1000})", R"("ticks")"), none};
    case Service::kSpeed:
      return {ObjectSchema(R"("factor":{"type":"number","minimum":0,"maximum":1})", R"("factor")"), none};
    case Service::kSave:
      return {none, ObjectSchema(R"("name":{"type":"string"},"toml":{"type":"string"})", R"("name","toml")")};
    case Service::kStartFault:
      return {ObjectSchema(R"("name":{"type":"string"},"settings":{"type":"object"})", R"("name")"), none};
    case Service::kStopFault: return {ObjectSchema(R"("name":{"type":"string"})", R"("name")"), none};
    case Service::kPull:
      return {ObjectSchema(R"("link":{"type":"string"},"p_link":)" + vector + R"(,"to_B":)" + vector,
                           R"("link","p_link","to_B")"),
              none};
    case Service::kThrow:
      return {ObjectSchema(R"("v_BO":)" + vector + R"(,"omega_B":)" + vector, R"("v_BO","omega_B")"), none};
    case Service::kTakeControl:
      return {ObjectSchema(R"("name":{"type":"string"})", ""),
              ObjectSchema(R"("granted":{"type":"boolean"},"controller":{"type":"string"})",
                           R"("granted","controller")")};
    default: return {none, none};
  }
}

Request ReadRequest(Service service, std::string_view payload, const Catalogue& catalogue) {
  const json object = ReadPayload(payload);
  switch (service) {
    case Service::kHold: return ReadPlain<Hold>(object);
    case Service::kTrack: return ReadPlain<Track>(object);
    case Service::kRecover: return ReadPlain<Recover>(object);
    case Service::kPause: return ReadPause(object);
    case Service::kStep: return ReadStep(object);
    case Service::kSpeed: return ReadSpeed(object);
    case Service::kReset: return ReadPlain<Reset>(object);
    case Service::kSave: return ReadPlain<Save>(object);
    case Service::kEnd: return ReadPlain<End>(object);
    case Service::kStartFault: return ReadStartFault(object, catalogue);
    case Service::kStopFault:
      RefuseUnknownFields(object, {"name"});
      return StopFault{FaultOf(object, catalogue)};
    case Service::kPull: return ReadPull(object);
    case Service::kRelease: return ReadPlain<Release>(object);
    case Service::kThrow: return ReadThrow(object);
    case Service::kTakeControl:
    case Service::kGiveControl: break;
  }
  throw Refusal("control is no matter of the run");
}

std::string ReadControlName(std::string_view payload) {
  const json object = ReadPayload(payload);
  RefuseUnknownFields(object, {"name"});
  return Quoted(TextOrNone(object, "name"));
}

Request ReadTarget(std::string_view topic, std::string_view payload) {
  const json object = ReadPayload(payload);
  if (topic == kTargetReleaseTopic) {
    return ReadPlain<ReleaseTarget>(object);
  }
  return ReadPose(object);
}

}  // namespace fovea::live
