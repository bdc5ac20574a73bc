// SPDX-License-Identifier: Apache-2.0
// Who may talk to the server: checks of a request's token, Host and Origin.
//
// Any web page that a browser shows may open a connection to 127.0.0.1. Host stops a page whose name resolves
// to this computer (DNS rebinding), Origin stops every other page, and the token stops other programs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fovea::live {

struct Access {
  std::string address;
  std::uint16_t port = 0;
  std::string token;
  std::vector<std::string> allowed_origins;
  std::vector<std::string> host_names;
};

// A request that is answered by a status and one line.
struct Denial {
  unsigned status = 0;  // of HTTP
  std::string text;
};

// 32 hexadecimal digits from the system's random numbers. std::runtime_error when it has none.
std::string RandomToken();
// Whether a person's own token can stand in an address: 8 to 128 letters, digits, '-' or '_'.
bool IsUsableToken(std::string_view token);

// The path of a request's target, without the query.
std::string_view PathOf(std::string_view target);

// `host`, `origin`: these headers; empty where the request has none. None: the request may go on.
std::optional<Denial> CheckHost(const Access& access, std::string_view host, std::string_view origin);
// `target`: path and query. Takes as long for a wrong token as for the right one.
std::optional<Denial> CheckToken(const Access& access, std::string_view target);

}  // namespace fovea::live
