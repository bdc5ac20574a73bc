// SPDX-License-Identifier: Apache-2.0
// Reads JSON from a client: bounded in depth, every field asked for by name and kind.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "firmware/host/live/client_message.hpp"
#include "firmware/host/live/refusal.hpp"

namespace fovea::live {

// An object. Refusal: it is no valid JSON, nested too deeply, or no object.
inline nlohmann::json ReadObject(std::string_view text) {
  const auto bound = [](int depth, nlohmann::json::parse_event_t /*event*/, nlohmann::json& /*parsed*/) {
    if (depth > kMostDepth) {
      throw Refusal("the JSON is nested too deeply");
    }
    return true;
  };
  nlohmann::json object;
  try {
    object = nlohmann::json::parse(text, bound);
  } catch (const nlohmann::json::exception&) {
    throw Refusal("the message is no valid JSON");
  }
  if (!object.is_object()) {
    throw Refusal("the message is no JSON object");
  }
  return object;
}

inline void RefuseUnknownFields(const nlohmann::json& object, std::initializer_list<std::string_view> known) {
  for (const auto& [name, value] : object.items()) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw Refusal("the field " + Quoted(name) + " is unknown");
    }
  }
}

inline const nlohmann::json& FieldOf(const nlohmann::json& object, const char* name) {
  const auto field = object.is_object() ? object.find(name) : object.end();
  if (!object.is_object() || field == object.end()) {
    throw Refusal(std::string("the field ") + name + " is missing");
  }
  return *field;
}

inline std::string TextOf(const nlohmann::json& object, const char* name) {
  const nlohmann::json& field = FieldOf(object, name);
  if (!field.is_string() || field.get_ref<const std::string&>().size() > kMostNameBytes) {
    throw Refusal(std::string("the field ") + name + " must be a short text");
  }
  return field.get<std::string>();
}

// "" when the field is missing.
inline std::string TextOrNone(const nlohmann::json& object, const char* name) {
  return object.contains(name) ? TextOf(object, name) : std::string();
}

inline std::uint32_t IdOf(const nlohmann::json& value) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > UINT32_MAX) {
    throw Refusal("an id must be a whole number below 2^32");
  }
  return value.get<std::uint32_t>();
}

inline const nlohmann::json& ListOf(const nlohmann::json& object, const char* name) {
  const nlohmann::json& field = FieldOf(object, name);
  if (!field.is_array() || field.size() > kMostEntries) {
    throw Refusal(std::string("the field ") + name + " must be a list of at most " +
                  std::to_string(kMostEntries) + " entries");
  }
  return field;
}

// A finite number in the range.
inline double NumberIn(const nlohmann::json& value, const std::string& name, double min, double max) {
  const double number = value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (!(number >= min && number <= max)) {
    const auto shown = [](double bound) { return nlohmann::json(bound).dump(); };
    throw Refusal(name + " must be a number from " + shown(min) + " to " + shown(max) + ", got " +
                  Quoted(value.dump(-1, ' ', true)));
  }
  return number;
}

// `size` numbers within +-most.
template <std::size_t size>
std::array<double, size> VectorOf(const nlohmann::json& object, const char* name, double most) {
  const nlohmann::json& field = FieldOf(object, name);
  if (!field.is_array() || field.size() != size) {
    throw Refusal(std::string(name) + " must be a list of " + std::to_string(size) + " numbers");
  }
  std::array<double, size> vector{};
  for (std::size_t i = 0; i < size; ++i) {
    vector[i] = NumberIn(field[i], name, -most, most);
  }
  return vector;
}

}  // namespace fovea::live
