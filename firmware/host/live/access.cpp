// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/live/access.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

namespace fovea::live {
namespace {

bool AreEqual(std::string_view a, std::string_view b) {
  unsigned differing = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const char other = b.empty() ? '\0' : b[i % b.size()];
    differing |= static_cast<unsigned>(a[i] ^ other);
  }
  return differing == 0;
}

std::string_view TokenOf(std::string_view target) {
  const std::size_t query = target.find('?');
  std::string_view rest = query == std::string_view::npos ? std::string_view{} : target.substr(query + 1);
  constexpr std::string_view kName = "token=";
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    if (rest.substr(0, end).starts_with(kName)) {
      return rest.substr(0, end).substr(kName.size());
    }
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return {};
}

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

// A literal address cannot be rebound.
bool IsLiteralAddress(std::string_view name) {
  return !name.empty() && (name.front() == '[' || name.find_first_not_of("0123456789.") == name.npos);
}

bool IsOwnName(const Access& access, std::string_view name) {
  const bool is_version_6 = access.address.find(':') != std::string::npos;
  const std::string address = is_version_6 ? "[" + access.address + "]" : access.address;
  const bool is_any = access.address == "0.0.0.0" || access.address == "::";
  return name == "localhost" || name == address || (is_any && IsLiteralAddress(name)) ||
         std::any_of(access.host_names.begin(), access.host_names.end(),
                     [name](const std::string& own) { return Lower(own) == name; });
}

// Splits "name:port"; without a port it is that of HTTP.
bool IsOwnHost(const Access& access, std::string_view host) {
  const std::size_t colon = host.rfind(':');
  const std::size_t bracket = host.rfind(']');
  const bool has_port = colon != host.npos && (bracket == host.npos || colon > bracket);
  const std::string_view port = has_port ? host.substr(colon + 1) : "80";
  return port == std::to_string(access.port) && IsOwnName(access, has_port ? host.substr(0, colon) : host);
}

}  // namespace

std::string RandomToken() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the system gives no random numbers for the live page's token");
  }
  std::string token;
  for (const unsigned char byte : bytes) {
    token += fmt::format("{:02x}", byte);
  }
  return token;
}

bool IsUsableToken(std::string_view token) {
  return token.size() >= 8 && token.size() <= 128 &&
         std::all_of(token.begin(), token.end(), [](unsigned char c) {
           return c < 0x80 && (std::isalnum(c) != 0 || c == '-' || c == '_');
         });
}

std::string_view PathOf(std::string_view target) { return target.substr(0, target.find('?')); }

std::optional<Denial> CheckHost(const Access& access, std::string_view host, std::string_view origin) {
  if (!IsOwnHost(access, Lower(host))) {
    return Denial{403,
                  fmt::format("This server is called {0}:{1} or localhost:{1}: open the address that the "
                              "program printed.",
                              access.address, access.port)};
  }
  constexpr std::string_view kScheme = "http://";
  const std::string from = Lower(origin);
  const bool is_own = from.starts_with(kScheme) && IsOwnHost(access, std::string_view(from).substr(7));
  const bool is_allowed = std::any_of(access.allowed_origins.begin(), access.allowed_origins.end(),
                                      [&from](const std::string& allowed) { return Lower(allowed) == from; });
  if (!origin.empty() && !is_own && !is_allowed) {
    return Denial{403, "Pages of other servers may not connect to this one."};
  }
  return std::nullopt;
}

std::optional<Denial> CheckToken(const Access& access, std::string_view target) {
  if (!AreEqual(TokenOf(target), access.token)) {
    return Denial{401, "The address lacks the token of this run: open the address that the program printed."};
  }
  return std::nullopt;
}

}  // namespace fovea::live
