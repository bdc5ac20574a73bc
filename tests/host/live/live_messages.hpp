// SPDX-License-Identifier: Apache-2.0
// Messages of the Foxglove WebSocket protocol as a client writes and reads them, for tests: written from the
// protocol's description, apart from the server's code.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace fovea::test {

// A number as the protocol writes it: little-endian, as every computer that runs these tests.
template <typename Number>
std::string LittleEndian(Number value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

template <typename Number>
Number NumberAt(std::string_view bytes, std::size_t at) {
  Number value{};
  std::memcpy(&value, bytes.substr(at, sizeof value).data(), sizeof value);
  return value;
}

inline std::string BinaryServiceCall(std::uint32_t service, std::uint32_t call, const std::string& payload,
                                     const std::string& encoding = "json") {
  std::string bytes = "\x02";
  bytes += LittleEndian(service) + LittleEndian(call);
  bytes += LittleEndian(static_cast<std::uint32_t>(encoding.size())) + encoding + payload;
  return bytes;
}

// A text message as its JSON. A binary one as {"binary": operation, ...} with its fields.
inline nlohmann::json Readable(bool is_text, std::string_view bytes) {
  if (is_text) {
    return nlohmann::json::parse(bytes);
  }
  const int op = static_cast<unsigned char>(bytes.at(0));
  nlohmann::json out = {{"binary", op}};
  if (op == 1) {
    out["subscription"] = NumberAt<std::uint32_t>(bytes, 1);
    out["stamp"] = NumberAt<std::int64_t>(bytes, 5);
    out["payload"] = bytes.substr(13);
  } else if (op == 2) {
    out["stamp"] = NumberAt<std::int64_t>(bytes, 1);
  } else {
    out["service"] = NumberAt<std::uint32_t>(bytes, 1);
    out["call"] = NumberAt<std::uint32_t>(bytes, 5);
    const auto encoding = NumberAt<std::uint32_t>(bytes, 9);
    out["encoding"] = bytes.substr(13, encoding);
    out["payload"] = bytes.substr(13 + encoding);
  }
  return out;
}

}  // namespace fovea::test
